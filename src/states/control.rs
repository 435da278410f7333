//! Length of the adaptive steps of a run on elastic states.
//!
//! A step is taken whole and in two halves, and the halves are kept. Their difference at the end is not enough: a
//! body that parts and touches within the step, or a surface that recovers while nothing presses on it, does not show
//! there. So the control looks at the load within the step, ends steps where bodies touch and forces begin or end,
//! and compares the free surface and the strains of all levels.

use crate::contact::StepReport;
use crate::error::{Result, StepError};
use crate::load::{Load, LoadHistory};
use crate::run::SAME_TIME;
use crate::run::driven::Course;
use crate::states::contact::StatesContact;
use crate::states::levels::Demand;
use crate::states::passage::{Passage, Span};
use crate::states::rounded::Rounded;

/// First step after a jump or a corner, over the time to the next one.
const FIRST_STEP: f64 = 1e-4;
/// Bodies that relax by this factor within a step come to a corner in steps that are halved.
const RELAXED: f64 = 2.0;
/// Rounding of times: no step is shorter than this part of the time.
const SHORTEST: f64 = 8.0 * f64::EPSILON;
/// Within so many of the shortest steps after a jump or a corner, the creep may be faster than times are resolved:
/// such a step is accepted.
const LATE: f64 = 64.0;
/// Limits of the ratio of a step to the one before.
const MAX_GROWTH: f64 = 4.0;
const MIN_GROWTH: f64 = 0.1;
/// Share of the tolerance that the error of a step aims at: errors of several steps add up, and over taps.
const AIM: f64 = 0.08;
const AIM_OF_FORCE: f64 = 0.1;
/// Further part of the aim for bodies without elastic response: nothing brings their level back.
const AIM_OF_RATES: f64 = 0.2;
/// A step may have so many times the error that it aims at.
const ALLOWED: f64 = 3.0;
/// Order of a corrected step, by which its length is chosen.
const ORDER: f64 = 3.0;
/// Two halves err by a third of their difference to the whole, as where the order is two: the curve between states
/// has kinks in its curvature.
const OF_HALVES: f64 = 1.0 / 3.0;
/// Where there is no order, in a first step, the one after bodies touched and one in which they part,
/// halves may be no better than the whole.
const WITHOUT_ORDER: f64 = 2.0;
/// Levels that were swept in a step are resolved by its length alone: their error does not add up over the steps, but
/// over the taps that come back to them, and counts so much, chosen on 300 random runs that tap and part; less where
/// forces are given throughout.
const SWEPT: f64 = 0.2;
const SWEPT_BY_FORCE: f64 = 0.05;
/// Number of equal parts of a run at which the load is looked at.
const PARTS_OF_RUN: u32 = 4096;
/// Greatest deviation of the load from a parabola within a step, over the greatest load.
const BEND: f64 = 0.03;
/// Overshoot of the step that ends where bodies touch, in tolerances.
const OVERSHOOT: f64 = 0.01;
/// Contacts that get smaller than this part of the greatest level within a step are looked at inside its halves too.
const SHALLOW: f64 = 0.3;
/// Depth and force are not small, for errors relative to them, from this part of what the greatest load of the run
/// will make of them.
const EXPECTED: f64 = 0.1;
/// Depths and forces below this part of their maximum count as if they were as large.
const SMALL: f64 = 0.1;
/// Groups of levels merge with this share of the tolerance.
const MERGING: f64 = 0.01;

/// The control of the steps of a run, and the state at the start of the last one.
#[derive(Debug, Clone)]
pub struct StatesControl {
    pub(super) record: Record,
    pub(super) before: StatesContact,
    /// Whether the last step was taken in two halves.
    pub(super) halved: bool,
    /// The step taken whole, in halves, and after the first half.
    whole: StatesContact,
    halves: StatesContact,
    middle: StatesContact,
    /// The load within the step.
    passage: Passage,
}

/// What the control knows of the run: all that a run from a file needs.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Record {
    /// The load that acts; unknown before the first step.
    pub(super) load: Option<Load>,
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) tolerance: f64,
    until: f64,
    /// Length of the next step; 0 after a jump or a corner.
    pub(super) next: f64,
    /// Time of the last jump or corner.
    corner: f64,
    /// Whether the last step ended where bodies touched.
    touches: bool,
    /// Whether forces are given throughout the run.
    by_force: bool,
    /// Greatest depth and force of the run, for errors relative to them.
    greatest: [f64; 2],
    /// Times and loads at equal parts of the run, and the greatest of them.
    loads: Vec<(f64, f64)>,
    greatest_load: f64,
    /// Loads below this one are lost in rounding.
    least_load: f64,
    /// The longest time for which at least half of the greatest load acts.
    pressed: f64,
    /// How long loads act in all.
    loaded: f64,
    /// A load, and the time that it takes from nothing to there at its rate then, where a body
    /// without elastic response that is approached resists most.
    rise: [f64; 2],
    pub(super) rejected: u64,
}

impl Record {
    /// For a run to the time `until`.
    pub(super) fn new(until: f64, tolerance: f64) -> Record {
        let loads = Vec::with_capacity(PARTS_OF_RUN as usize + 1);
        Record {
            load: None,
            tolerance,
            until,
            next: 0.0,
            corner: 0.0,
            touches: false,
            by_force: true,
            greatest: [0.0; 2],
            loads,
            greatest_load: 0.0,
            least_load: 0.0,
            pressed: 0.0,
            loaded: 0.0,
            rise: [0.0; 2],
            rejected: 0,
        }
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        let [[load, rise], [depth, force], spells] = [self.rise, self.greatest, [self.pressed, self.loaded]];
        let sizes = [self.until, self.next, depth, force, self.greatest_load, self.least_load, load, rise];
        let times = self.loads.iter().flat_map(|(time, load)| [*time, *load]);
        sizes.iter().chain(&spells).all(|&size| size >= 0.0)
            && times.chain([self.next, self.corner]).all(f64::is_finite)
    }

    /// Looks at the load at equal parts of the run, which fails where there is none. A load that the states have no
    /// demand for fails the step to it.
    fn sample(&mut self, contact: &StatesContact, history: &dyn LoadHistory) -> Result<()> {
        let (start, length) = (contact.time(), self.until - contact.time());
        let mut presses = false;
        for k in 0..=PARTS_OF_RUN {
            let time = start + length * f64::from(k) / f64::from(PARTS_OF_RUN);
            let load = history.checked_at(time, false).inspect_err(|_| self.loads.clear())?;
            (self.by_force, presses) = (self.by_force && load.is_force(), presses || load.is_force());
            self.loads.extend(value(contact, load).ok().map(|load| (time, load)));
        }
        self.greatest_load = self.loads.iter().fold(0.0, |most, load| load.1.max(most));
        // of forces or of depths
        self.least_load = if presses == self.by_force { f64::EPSILON * self.greatest_load } else { 0.0 };
        // a body without elastic response has no depth as soon as the load acts
        let spells = self.loads.split(|load| load.1 < 0.5 * self.greatest_load);
        let lengths = spells.filter_map(|spell| Some(spell.last()?.0 - spell.first()?.0));
        self.pressed = lengths.fold(length / f64::from(PARTS_OF_RUN), f64::max);
        let loaded = self.loads.iter().filter(|load| load.1 > 0.0).count();
        self.loaded = loaded as f64 * length / f64::from(PARTS_OF_RUN);
        let lost = self.loads.iter_mut().filter(|load| 0.0 < load.1 && load.1 < self.least_load);
        lost.for_each(|load| load.1 = 0.0);
        // it resists by the rate of its level, about the square of the load
        let rises = self.loads.windows(2).filter(|pair| pair[1].1 > pair[0].1.max(0.0)).map(|pair| {
            let [(start, before), (end, load)] = [pair[0], pair[1]];
            [load, load * (end - start) / (load - before.max(0.0))]
        });
        let resists = |[load, rise]: &[f64; 2]| load * load / rise;
        let steepest = rises.max_by(|a, b| resists(a).total_cmp(&resists(b)));
        self.rise = steepest.unwrap_or([self.greatest_load.max(0.0), length]);
        Ok(())
    }
}

impl StatesControl {
    /// The history that adaptive steps follow, which is looked at before the first of them.
    pub(super) fn rounded<'a>(&mut self, contact: &StatesContact, history: &'a dyn LoadHistory) -> Result<Rounded<'a>> {
        if self.record.tolerance > 0.0 && self.record.loads.is_empty() {
            self.record.sample(contact, history)?;
        }
        Ok(self.of_record(contact, history))
    }

    /// The same after the first step.
    pub(super) fn of_record<'a>(&self, contact: &StatesContact, history: &'a dyn LoadHistory) -> Rounded<'a> {
        Rounded { history, rest: contact.states.rest.approach, least: self.record.least_load }
    }

    pub(super) fn new(contact: &StatesContact, record: Record) -> StatesControl {
        let [before, middle] = [contact.clone(), contact.clone().with_quadratic_steps()];
        let (whole, halves, passage) = (middle.clone(), middle.clone(), Passage::new(PARTS_OF_RUN as usize + 1));
        StatesControl { record, before, halved: false, whole, halves, middle, passage }
    }

    /// Takes the longest step that the tolerance allows, towards the next stop of the run. If it fails, the contact stays as it was.
    pub(super) fn step(
        &mut self,
        contact: &mut StatesContact,
        history: &dyn LoadHistory,
        &Course { stop, corner, .. }: &Course<'_>,
    ) -> Result<StepReport> {
        let (now, is_first, tolerance) = (contact.time(), self.record.next == 0.0, self.record.tolerance);
        if stop - now <= 2.0 * SHORTEST * stop {
            return contact.step_to(stop, stop - now, load_at(history, stop)?);
        }
        if is_first {
            self.record.corner = now;
        }
        // bodies that part after the corner leave the levels that were met last, and relax most, first
        let is_far = !is_first && corner - now > FIRST_STEP * (corner - self.record.corner);
        let stop = if is_far && contact.levels.relaxed() > RELAXED { stop.min(0.5 * (now + corner)) } else { stop };
        // times near 0 are resolved more finely; a jump may come so late that the creep after it is faster than times are resolved
        let shortest = (SHORTEST * now).max(SHORTEST * SHORTEST * stop);
        let is_late = now > 0.0 && now - self.record.corner <= LATE * shortest;
        let mut length = if is_first { FIRST_STEP * (stop - now) } else { self.record.next }.max(shortest);
        // imprints need the short steps that come of rejections where nothing yields
        let yields = contact.levels.has_dashpot() || !matches!(load_at(history, stop)?, Load::Approach { .. });
        let longest = if yields { contact.levels.longest_growth() } else { MAX_GROWTH };
        let of_load = if self.record.by_force { AIM_OF_FORCE } else { AIM };
        let aim = if contact.levels.has_dashpot() { AIM_OF_RATES } else { 1.0 } * of_load * tolerance;
        let mut last: Option<(f64, f64)> = None;
        loop {
            if is_late {
                length = length.max(shortest);
            } else if length < shortest {
                return Err(StepError::StepTooShort { time: now, dt: length, tolerance }.into());
            }
            let mut end = if now + (1.0 + SAME_TIME) * length >= stop { stop } else { now + length };
            let value_at = |time: f64| value(contact, load_at(history, time)?);
            let first = value(contact, history.checked_at(now, false)?)?;
            self.passage.look(Span { now, end }, first, &self.record.loads, value_at)?;
            self.record.greatest_load = self.record.greatest_load.max(self.passage.top());
            // deviations below the least normal number are rounding
            let straight = (BEND * self.record.greatest_load).max(f64::MIN_POSITIVE);
            let is_bent = self.passage.bend(self.record.greatest_load) > straight;
            if is_bent && end - now > 2.0 * shortest {
                length = 0.5 * (end - now);
                continue;
            }
            let event = self.event(contact, history, end)?;
            end = event.unwrap_or(end);
            let (report, difference) = self.compare(contact, history, Span { now, end })?;
            let parts = report.force == 0.0 && contact.level() > 0.0;
            let error = if is_first || self.record.touches || parts { WITHOUT_ORDER } else { OF_HALVES } * difference;
            let order = match last {
                _ if is_first => 1.0,
                Some((length, before)) if 0.0 < error && error < before => {
                    ((before / error).ln() / (length / (end - now)).ln()).clamp(1.0, ORDER)
                }
                Some(_) => 1.0,
                None => ORDER,
            };
            let most = if error > 0.0 { longest } else { MAX_GROWTH };
            let growth = (aim / error).powf(1.0 / order).clamp(MIN_GROWTH, most);
            if error <= ALLOWED * aim || is_late && length <= shortest {
                self.record.next = match event {
                    Some(_) => growth.clamp(0.5, 1.0) * length,
                    None => growth.max(0.5) * (end - now).max(length.min(stop - now)),
                };
                self.record.greatest = self.greatest_with(report.force);
                self.record.touches = event.is_some() && contact.level() == 0.0;
                contact.copy_from(&self.halves);
                contact.levels.merge(&contact.states, MERGING * tolerance);
                return Ok(StepReport { dt: end - now, time_error: Some(error), ..report });
            }
            self.record.rejected += 1;
            last = Some((end - now, error));
            length = growth.min(0.5) * (end - now);
        }
    }

    /// The first time within a step at which bodies touch or part, or a force begins or ends.
    fn event(&mut self, contact: &StatesContact, history: &dyn LoadHistory, end: f64) -> Result<Option<f64>> {
        let StatesControl { record, whole: scratch, passage, .. } = self;
        let mut load = |time: f64| value(contact, load_at(history, time)?);
        if load_at(history, end)?.is_force() {
            return passage.first_change_of_force(&mut load);
        }
        let touch = contact.level() > 0.0;
        if touch && !passage.falls() {
            return Ok(None);
        }
        scratch.copy_from(contact);
        let scale = record.greatest[0].max(1e-3 * record.greatest_load);
        passage.first_event(
            touch,
            OVERSHOOT * record.tolerance * scale,
            &mut |time| scratch.surface_at(time),
            &mut load,
        )
    }

    /// Takes a step whole and in two halves. Returns how far the whole differs from the halves, in depth and force,
    /// relative to values that are not small in this run.
    fn compare(
        &mut self,
        contact: &StatesContact,
        history: &dyn LoadHistory,
        Span { now, end }: Span,
    ) -> Result<(StepReport, f64)> {
        let StatesControl { whole, halves, middle, .. } = self;
        let to = |contact: &mut StatesContact, time: f64| {
            contact.advance(time, time - contact.time(), load_at(history, time)?)
        };
        let half = 0.5 * (end - now);
        whole.copy_from(contact);
        to(whole, end)?;
        halves.copy_from(contact);
        to(halves, now + half)?;
        middle.copy_from(halves);
        let report = to(halves, end)?;

        let cuts = [middle.level(), halves.level()];
        let mut of_surface = whole.levels.distance(
            &whole.states,
            &halves.levels,
            contact.level(),
            cuts,
            (end - self.record.corner) / half,
            if self.record.by_force { SWEPT_BY_FORCE } else { SWEPT },
        );
        if self.record.by_force {
            of_surface[1] = 0.0;
        }
        let demand = contact.demand(load_at(history, end)?)?;
        let Record { until, pressed, loaded, greatest_load, rise, .. } = self.record;
        let times = [until, pressed, rise[1]].map(|time| time / half);
        let expected = halves.levels.expected(&halves.states, demand, [greatest_load, rise[0]], times);
        let greatest = self.greatest_with(report.force);
        let greatest = [0, 1].map(|k| greatest[k].max(EXPECTED * expected[k]));
        let StatesControl { whole, halves, middle, .. } = self;
        let results = |contact: &StatesContact| [contact.depth(), contact.force()];
        let ended = [&*whole, &*halves].map(results);
        // rates of a prescribed approach resist at once, and leave nothing behind
        let is_local = halves.levels.has_dashpot() && matches!(load_at(history, end)?, Load::Approach { .. });
        let small = [SMALL, if is_local { 1.0 } else { SMALL }];
        let scales = [0, 1].map(|k| f64::abs(ended[1][k]).max(small[k] * greatest[k]));
        let mut worst = 0.0f64;
        let mut see = |differences: [f64; 2], scales: [f64; 2]| {
            for (difference, scale) in differences.into_iter().zip(scales).filter(|(_, scale)| *scale > 0.0) {
                worst = worst.max(difference.abs() / scale);
            }
        };
        see(of_surface, greatest);
        if whole.level() > 0.0 || halves.level() > 0.0 {
            see([0, 1].map(|k| ended[0][k] - ended[1][k]), scales);
        }
        // what steps like this one add since the last corner, and nothing brings back, may be as large as the
        // tolerance: to the depth under a spring, and to the surface of bodies apart that resist rates alone
        let acts = halves.level() > 0.0;
        let (time, off) = if acts { (loaded, ended[0][0] - ended[1][0]) } else { (until, of_surface[0]) };
        let by_spring = matches!(demand, Demand::Depth { give, .. } if give > 0.0);
        if acts && by_spring || !acts && halves.levels.has_dashpot() {
            let time = time.min(end - self.record.corner);
            let steps = (time / (end - now)).min(f64::from(PARTS_OF_RUN));
            see([AIM * halves.levels.lasting(&halves.states, demand, time / half) * steps * off, 0.0], greatest);
        }
        let levels = [contact.level(), cuts[0], cuts[1]];
        let deepest = levels.into_iter().fold(0.0, f64::max);
        let presses = load_at(history, end)?.is_force() && value(contact, load_at(history, now + half)?)? > 0.0;
        if levels.iter().any(|level| *level < SHALLOW * deepest) || deepest == 0.0 && presses {
            for start in [contact, middle] {
                let mut quarter = |ends: &[f64]| -> Result<[f64; 2]> {
                    whole.copy_from(start);
                    for end in ends {
                        to(whole, start.time() + end * half)?;
                    }
                    Ok(results(whole))
                };
                let (one, two) = (quarter(&[0.5])?, quarter(&[0.25, 0.5])?);
                see([0, 1].map(|k| one[k] - two[k]), scales);
            }
        }
        Ok((report, worst))
    }

    /// The greatest depth and force of the run, the step being tried included. Depths without contact are no scale.
    fn greatest_with(&self, force: f64) -> [f64; 2] {
        let depth = if force == 0.0 { 0.0 } else { self.halves.depth().abs() };
        [self.record.greatest[0].max(depth), self.record.greatest[1].max(force)]
    }
}

/// The load at a time, or just before it where it jumps.
pub(super) fn load_at(history: &dyn LoadHistory, time: f64) -> Result<Load> {
    history.checked_before(time, false)
}

/// Force, or depth of the load point or of the far end of its spring.
fn value(contact: &StatesContact, load: Load) -> Result<f64> {
    let (Demand::Force(value) | Demand::Depth { depth: value, .. }) = contact.demand(load)?;
    Ok(value)
}
