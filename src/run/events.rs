//! Events: steps that end where a quantity of the contact crosses a value.

use std::fmt;

use crate::contact::{Contact, StepReport};
use crate::error::{Result, finite};
use crate::run::RunContact;
use crate::run::follow::{Run, SAME_TIME};

/// Differences to the value below this part of the greatest one so far count as none, just after an event.
const NOISE: f64 = 1e-6;
/// Looks within a step for the time of an event: bisection alone needs 20 to 1e-6 of the step.
const MOST_LOOKS: u32 = 60;
/// Attempts to end a step at the first event in it.
const MOST_ATTEMPTS: u32 = 8;

/// The value that a quantity crosses, and the direction, in [`Run::stop_when`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Crossing {
    /// From below the value to the value, or from the value to above it.
    Up(f64),
    /// From above the value to the value, or from the value to below it.
    Down(f64),
}

impl Crossing {
    fn value(self) -> f64 {
        let (Crossing::Up(value) | Crossing::Down(value)) = self;
        value
    }

    /// How far a quantity is beyond the value.
    fn beyond(self, quantity: f64) -> f64 {
        match self {
            Crossing::Up(value) => quantity - value,
            Crossing::Down(value) => value - quantity,
        }
    }
}

/// Where the quantity of an event is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    /// Before the value, or at it: the event is met once it goes on.
    Before,
    /// At the value, just after the event.
    Met,
    Beyond,
}

/// What a run watches: whether and when a quantity has crossed a value ([`Run::events`]).
pub struct Event<C> {
    quantity: Box<dyn Fn(&C) -> f64 + Send + Sync>,
    crossing: Crossing,
    /// At the start of the step to be taken, unknown before the first.
    side: Option<Side>,
    /// At the end of the step tried; `None` if it has crossed.
    next: Option<Side>,
    /// Greatest distance of the quantity from the value.
    greatest: f64,
    times: Vec<f64>,
    is_met: bool,
}

impl<C> Event<C> {
    /// The value, and the direction in which it is crossed.
    pub fn crossing(&self) -> Crossing {
        self.crossing
    }

    /// Whether the last step ended at this event.
    pub fn is_met(&self) -> bool {
        self.is_met
    }

    /// The times of all crossings so far \[s\]: none if the event was not met.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Whether the quantity lies beyond the value, perhaps since the start of the run, in which case the event is not met before the
    /// quantity has come back.
    pub fn is_beyond(&self) -> bool {
        matches!(self.side, Some(Side::Met | Side::Beyond))
    }

    fn look(&self, contact: &C) -> Look
    where
        C: Contact,
    {
        Look { time: contact.time(), beyond: self.crossing.beyond((self.quantity)(contact)) }
    }

    /// Accepts the step tried, which ends at `time`.
    fn settle(&mut self, time: f64) {
        self.is_met = self.next.is_none();
        self.side = self.next.or(Some(Side::Met));
        self.times.extend(self.is_met.then_some(time));
    }

    /// The side of a quantity that is `now` so far beyond the value, after it was at `side`; `None` if it has crossed.
    fn side_after(&self, side: Option<Side>, start: f64, now: f64) -> Option<Side> {
        let noise = NOISE * self.greatest;
        let crosses = if start == 0.0 { now > 0.0 } else { now >= 0.0 };
        match side {
            None if now > 0.0 => Some(Side::Beyond),
            None => Some(Side::Before),
            Some(Side::Before) if crosses => None,
            Some(Side::Met | Side::Beyond) if now < -noise => Some(Side::Before),
            Some(Side::Met) if now > noise => Some(Side::Beyond),
            Some(Side::Beyond) if now == 0.0 => Some(Side::Before),
            side => side,
        }
    }
}

impl<C> fmt::Debug for Event<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Event").field("crossing", &self.crossing).field("times", &self.times).finish_non_exhaustive()
    }
}

/// The quantity of an event at a time within a step.
#[derive(Clone, Copy)]
struct Look {
    time: f64,
    beyond: f64,
}

impl<'a, C: RunContact> Run<'a, C> {
    /// Makes a step end where a quantity of the contact crosses a value: where the force falls to 0, the area grows to a value, the
    /// approach passes one, or any function of the contact does. Leave the loop there, or go on to the next crossing:
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
    /// A quantity that lies beyond the value when the run begins has to come back first. The time of a crossing is found to a
    /// millionth of a step. Each step is looked at in its middle, and at the top of the parabola through start, middle and end, if
    /// this is beyond the value: so two crossings within a step are found unless both lie between two looks. In space each look costs a
    /// contact problem and a copy of the contact, a crossing about ten. Where [ranks](crate::parallel) share out the contact the
    /// quantity must be the same on all of them.
    ///
    /// # Errors
    /// If the value is not finite.
    pub fn stop_when(
        mut self,
        quantity: impl Fn(&C) -> f64 + Send + Sync + 'static,
        crossing: Crossing,
    ) -> Result<Run<'a, C>> {
        finite("value of an event", crossing.value())?;
        let (quantity, times) = (Box::new(quantity), Vec::new());
        self.events.push(Event { quantity, crossing, side: None, next: None, greatest: 0.0, times, is_met: false });
        Ok(self)
    }

    /// The events of [`Run::stop_when`], in the order of its calls.
    pub fn events(&self) -> &[Event<C>] {
        &self.events
    }

    /// Takes a step that ends at the first event in it.
    pub(super) fn take_until_event(&mut self) -> Result<Option<StepReport>> {
        let (start, saved) = (C::clone(&self.contact), self.progress.clone());
        let mut target: Option<(usize, f64)> = None;
        for attempt in 0.. {
            self.events.iter_mut().for_each(|event| event.is_met = false);
            let Some(report) = self.take_step()? else { break };
            let arrived = target.filter(|(_, time)| *time == report.time);
            let searches = arrived.is_none() && attempt < MOST_ATTEMPTS;
            let mut events = std::mem::take(&mut self.events);
            let first = self.first_event(&mut events, &start, searches);
            self.events = events;
            match first {
                Ok(Some((first, time))) if time < report.time => {
                    self.stops.add([time].into(), self.progress.start)?;
                    target = Some((first, time));
                }
                Ok(_) => {
                    arrived.iter().for_each(|(event, _)| self.events[*event].next = None);
                    self.events.iter_mut().for_each(|event| event.settle(report.time));
                    return Ok(Some(report));
                }
                Err(error) => {
                    (*self.contact, self.progress) = (start, saved);
                    return Err(error);
                }
            }
            (*self.contact, self.progress) = (start.clone(), saved.clone());
        }
        Ok(None)
    }

    /// Follows all events through the last step. Returns the first of them and its time, the end of the step if it is as near as that or
    /// not to be searched for.
    fn first_event(&self, events: &mut [Event<C>], start: &C, searches: bool) -> Result<Option<(usize, f64)>> {
        let (from, to) = (start.time(), self.contact.time());
        let same = SAME_TIME * (to - from);
        let middle = if to > from { Some(self.within_step(0.5 * (from + to))?) } else { None };
        let mut first: Option<(usize, f64)> = None;
        for (k, event) in events.iter_mut().enumerate() {
            let mut looks: Vec<Look> = [Some(start), middle.as_ref(), Some(self.contact())]
                .into_iter()
                .flatten()
                .map(|c| event.look(c))
                .collect();
            if let Some(top) = top(&looks) {
                looks.insert(if top < looks[1].time { 1 } else { 2 }, event.look(&self.within_step(top)?));
            }
            event.greatest = looks.iter().fold(event.greatest, |most, look| most.max(look.beyond.abs()));
            event.next = event.side.or_else(|| event.side_after(None, 0.0, looks[0].beyond));
            for pair in looks.windows(2) {
                event.next = event.side_after(event.next, pair[0].beyond, pair[1].beyond);
                if event.next.is_some() {
                    continue;
                }
                let at = |time: f64| Ok(event.look(&self.within_step(time)?));
                let found = if searches { crossing_within([pair[0], pair[1]], same, at)? } else { to };
                let time = if found > to - same { to } else { found };
                if first.is_none_or(|(_, earlier)| time < earlier) {
                    first = Some((k, time));
                }
                break;
            }
        }
        Ok(first)
    }
}

/// The time of the extremum of the parabola through start, middle and end of a step, if it is inside the step and on the other side of the
/// value than the middle.
fn top(looks: &[Look]) -> Option<f64> {
    let [start, middle, end] = looks[..] else { return None };
    let (slope, bend) = (end.beyond - start.beyond, start.beyond - 2.0 * middle.beyond + end.beyond);
    let share = -0.25 * slope / bend;
    let value = middle.beyond + slope * share + 2.0 * bend * share * share;
    let is_inside = (1e-3..0.499).contains(&share.abs());
    (is_inside && (value >= 0.0) != (middle.beyond >= 0.0)).then(|| middle.time + share * (end.time - start.time))
}

/// The first time found at which the quantity is beyond the value, at most `same` after one at which it is not: by secants, and by
/// halves where these are slow.
fn crossing_within([mut low, mut high]: [Look; 2], same: f64, at: impl Fn(f64) -> Result<Look>) -> Result<f64> {
    let strict = low.beyond == 0.0;
    let mut weights = [1.0; 2];
    for k in 0..MOST_LOOKS {
        let width = high.time - low.time;
        if width <= same {
            break;
        }
        let [a, b] = [weights[0] * low.beyond, weights[1] * high.beyond];
        let share = if k % 3 == 2 || a == 0.0 || b == 0.0 { 0.5 } else { a / (a - b) };
        let least = (0.5 * same / width).min(0.5);
        let time = low.time + share.clamp(least, 1.0 - least) * width;
        let found = at(time)?;
        if if strict { found.beyond > 0.0 } else { found.beyond >= 0.0 } {
            (high, weights) = (found, [0.5 * weights[0], 1.0]);
        } else {
            (low, weights) = (found, [1.0, 0.5 * weights[1]]);
        }
    }
    Ok(high.time)
}
