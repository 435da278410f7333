//! Events: steps that end where a quantity of the contact crosses a value.

use crate::contact::StepReport;
use crate::error::Result;
use crate::run::Contact;
use crate::run::event::{Crossing, Event};
use crate::run::follow::Run;
use crate::run::passage::{Passage, Span};
use crate::run::progress::SAME_TIME;

/// Looks within a step for the time of an event: bisection alone needs 20 to 1e-6 of the step.
const MOST_LOOKS: u32 = 60;
/// Attempts to end a step at the first event in it.
const MOST_ATTEMPTS: u32 = 8;
/// Halvings of a part of a step between two turns of its load.
const HALVINGS: u32 = 6;

/// How far the quantities of all events are beyond their values, at a time within a step.
#[derive(Clone)]
struct Look {
    time: f64,
    beyond: Vec<f64>,
}

impl Look {
    fn of<C: Contact>(events: &[Event<C>], contact: &C) -> Result<Look> {
        let beyond = events.iter().map(|event| event.beyond(contact)).collect::<Result<_>>()?;
        Ok(Look { time: contact.time(), beyond })
    }
}

impl<'a, C: Contact> Run<'a, C> {
    /// Makes a step end where a quantity of the contact crosses a value: where the force falls to 0, the area grows
    /// to a value, the approach passes one, or any function of the contact does. Leave the loop there, or go on to
    /// the next crossing:
    /// [`Run::events`] has the events in the order of these calls.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let states = ElasticStates::sphere(10.0e-3)?;
    /// let mut contact = StatesContact::new(&states, &Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?))?;
    /// let drive = Sinusoid::about(Load::approach(0.0), 20.0e-6, 0.2)?;
    /// let run = contact.follow(&drive, Stepping::adaptive(1.0e-4), 20.0);
    /// let run = run.stop_when(|contact| contact.force(), Crossing::Up(0.0))?;
    /// let mut run = run.stop_when(|contact| contact.force(), Crossing::Down(0.0))?;
    /// while run.next_step()?.is_some() {
    ///     if run.events()[1].is_met() {
    ///         println!("parted at {} s", run.contact().time());
    ///     }
    /// }
    /// let [touch, part] = run.events() else { unreachable!() };
    /// assert!(part.times().len() >= 3 && touch.times().len() >= 3);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// A quantity that lies beyond the value, from the start or after a crossing, has to come back first, by more than
    /// a millionth of its maximum distance from the value so far, to the value itself, or to 0. The time of a crossing
    /// is found to a millionth of a step. Each step is looked at where its load turns, as 64 parts of it show, and in
    /// the middle between. Where a quantity comes as near to its value as it bends, or a quarter of its change, the
    /// part is halved again, six times at most. So two crossings are missed where both lie within a 64th of a part
    /// between two turns, or where the load turns twice within a 64th of the step. In space each look costs a contact
    /// problem and a copy of the contact, a crossing about ten. Where [ranks](crate::parallel) share out the contact
    /// the quantity must be the same on all of them.
    ///
    /// # Errors
    /// If the value is not finite. [`Run::next_step`] fails, and takes no step, where the quantity is not a number.
    pub fn stop_when(
        mut self,
        quantity: impl Fn(&C) -> f64 + Send + Sync + 'static,
        crossing: Crossing,
    ) -> Result<Run<'a, C>> {
        self.events.push(Event::new(quantity, crossing)?);
        Ok(self)
    }

    /// The events of [`Run::stop_when`], in the order of its calls.
    pub fn events(&self) -> &[Event<C>] {
        &self.events
    }

    /// Takes a step that ends at the first event in it.
    pub(super) fn take_until_event(&mut self) -> Result<Option<StepReport>> {
        let saved = (C::clone(&self.contact), self.progress.clone(), self.control.clone());
        let mut target: Option<(usize, f64)> = None;
        for attempt in 0.. {
            self.events.iter_mut().for_each(Event::begin);
            let Some(report) = self.take_step()? else { break };
            let arrived = target.filter(|(_, time)| *time == report.time);
            let searches = arrived.is_none() && attempt < MOST_ATTEMPTS;
            let mut events = std::mem::take(&mut self.events);
            let first = self.first_event(&mut events, &saved.0, searches);
            self.events = events;
            if let Ok(None) = first {
                arrived.iter().for_each(|(event, _)| self.events[*event].meet());
                self.events.iter_mut().for_each(|event| event.settle(report.time));
                return Ok(Some(report));
            }
            (*self.contact, self.progress, self.control) = saved.clone();
            target = first?;
            self.stops.add(target.iter().map(|(_, time)| *time).collect::<Vec<_>>().into(), self.progress.start)?;
        }
        Ok(None)
    }

    /// Follows all events through the last step. Returns the first of them and its time, if it is before the end of
    /// the step and to be searched for.
    fn first_event(&self, events: &mut [Event<C>], start: &C, searches: bool) -> Result<Option<(usize, f64)>> {
        let (from, to) = (start.time(), self.contact.time());
        let same = SAME_TIME * (to - from);
        let looks = self.looks(events, start)?;
        let mut first: Option<(usize, f64)> = None;
        for (k, event) in events.iter_mut().enumerate() {
            let beyond: Vec<f64> = looks.iter().map(|look| look.beyond[k]).collect();
            let Some(after) = event.follow(&beyond).filter(|_| searches) else { continue };
            let ends = [after - 1, after].map(|look| (looks[look].time, beyond[look]));
            let time = crossing_within(ends, same, |time| event.beyond(&self.sample_within_step(time)?.0))?;
            if time <= to - same && first.is_none_or(|(_, earlier)| time < earlier) {
                first = Some((k, time));
            }
        }
        Ok(first)
    }

    /// Looks within the last step, from its start to its end.
    fn looks(&self, events: &[Event<C>], start: &C) -> Result<Vec<Look>> {
        let (mut looks, end) = (vec![Look::of(events, start)?], Look::of(events, self.contact())?);
        for turn in self.turns(start.time(), end.time)? {
            let turn = Look::of(events, &self.sample_within_step(turn)?.0)?;
            self.look_until(events, &mut looks, turn, 0)?;
        }
        self.look_until(events, &mut looks, end, 0)?;
        Ok(looks)
    }

    /// Times within a step at which a load turns, ascending.
    fn turns(&self, now: f64, end: f64) -> Result<Vec<f64>> {
        let (mut turns, bends, mut passage) = (Vec::new(), self.control.bends(), Passage::default());
        for (body, history) in self.histories.each().enumerate() {
            let bends = bends.get(body).copied().unwrap_or_default();
            passage.look(Span { now, end }, history.at(now).main(), bends, |time| Ok(history.before(time).main()))?;
            turns.extend(passage.turns().map(|turn| turn.0));
        }
        for along in self.contact().lateral() {
            passage.look(Span { now, end }, along.at(now).main(), &[], |time| Ok(along.before(time).main()))?;
            turns.extend(passage.turns().map(|turn| turn.0));
        }
        turns.sort_by(f64::total_cmp);
        turns.dedup();
        Ok(turns)
    }

    /// Adds looks after the last one: in the middle before `end`, more where a quantity may cross its value twice,
    /// and `end`.
    fn look_until(&self, events: &[Event<C>], looks: &mut Vec<Look>, end: Look, halved: u32) -> Result<()> {
        let time = 0.5 * (looks[looks.len() - 1].time + end.time);
        if halved == HALVINGS || time <= looks[looks.len() - 1].time || time >= end.time {
            looks.push(end);
            return Ok(());
        }
        let middle = Look::of(events, &self.sample_within_step(time)?.0)?;
        let ends = [&looks[looks.len() - 1], &middle, &end];
        let beyond = |look: usize, k: usize| ends[look].beyond[k];
        let hides = (0..events.len()).any(|k| hides_crossings(beyond(0, k), beyond(1, k), beyond(2, k)));
        let halved = if hides { halved + 1 } else { HALVINGS };
        self.look_until(events, looks, middle, halved)?;
        self.look_until(events, looks, end, halved)
    }
}

/// Whether a quantity with these distances to the value, at both ends of a part of a step and in its middle, may
/// cross the value more often than they show: where it stays on one side, if it is nearer than it bends, or than a
/// quarter of its change; else if the parabola through the three turns.
fn hides_crossings(start: f64, middle: f64, end: f64) -> bool {
    let (bend, change) = ((start - 2.0 * middle + end).abs(), (end - start).abs());
    let nearest = start.abs().min(middle.abs()).min(end.abs());
    if (start >= 0.0) == (end >= 0.0) { nearest < bend.max(0.25 * change) } else { 2.0 * bend > change }
}

/// The first time found at which the quantity is beyond the value, at most `same` after one at which it is not: by
/// secants, and by halves where these are slow. From times and distances to the value of two looks.
fn crossing_within([mut low, mut high]: [(f64, f64); 2], same: f64, at: impl Fn(f64) -> Result<f64>) -> Result<f64> {
    let strict = low.1 == 0.0;
    let mut weights = [1.0; 2];
    for k in 0..MOST_LOOKS {
        let width = high.0 - low.0;
        if width <= same {
            break;
        }
        let [a, b] = [weights[0] * low.1, weights[1] * high.1];
        let is_secant = k % 3 != 2 && a != 0.0 && b != 0.0 && a.is_finite() && b.is_finite();
        let share = if is_secant { a / (a - b) } else { 0.5 };
        let least = (0.5 * same / width).min(0.5);
        let time = low.0 + share.clamp(least, 1.0 - least) * width;
        let beyond = at(time)?;
        if if strict { beyond > 0.0 } else { beyond >= 0.0 } {
            (high, weights) = ((time, beyond), [0.5 * weights[0], 1.0]);
        } else {
            (low, weights) = ((time, beyond), [1.0, 0.5 * weights[1]]);
        }
    }
    Ok(high.0)
}
