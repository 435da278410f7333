//! Steps as long as their error allows, which is measured: each is taken whole and in two halves.
//!
//! The halves are kept. How far the whole is from them tells the error, in the measure of the [`Judge`] of the
//! contact. What happens within a step and is over at its end does not show there: so the control looks at the load
//! within the step, and ends steps at its events.

use std::fmt::Debug;
#[cfg(feature = "checkpoint")]
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::contact::StepReport;
#[cfg(feature = "checkpoint")]
use crate::error::coverage;
use crate::error::{Error, Result, StepError, within};
use crate::load::{Load, LoadHistory};
use crate::run::Contact;
use crate::run::control::{Control, Course};
use crate::run::error_budget::ErrorBudget;
use crate::run::histories::Histories;
use crate::run::passage::{Passage, Span};
#[cfg(feature = "checkpoint")]
use crate::run::progress::Progress;
use crate::run::progress::{SAME_TIME, Stepping};
use crate::run::rounded::Rounded;
use crate::run::trace::{bends, looks};

/// First step after a jump or a corner, over the time to the next one.
pub(crate) const FIRST_STEP: f64 = 1e-4;
/// Rounding of times: no step is shorter than this part of the time.
const SHORTEST: f64 = 8.0 * f64::EPSILON;
/// Within so many of the shortest steps after a jump or a corner, the creep may be faster than times are resolved:
/// such a step is accepted.
const LATE: f64 = 64.0;
/// Limits of the ratio of a step to the one before.
pub(crate) const MAX_GROWTH: f64 = 4.0;
const MIN_GROWTH: f64 = 0.1;
/// A step may have so many times the error that it aims at.
const ALLOWED: f64 = 3.0;
/// Maximum deviation of the load from a parabola within a step, over the maximum load.
const BEND: f64 = 0.03;

/// What a kind of contact knows of its steps, and keeps of a run, which a file holds as well.
pub(crate) trait Judge<C: Contact>: Default + Clone + Debug + Send + Sync + 'static {
    /// Order of a step, by which the next one is chosen.
    const ORDER: f64;

    /// Force, or depth of the body or of the far end of its spring.
    fn size(contact: &C, load: Load) -> Result<f64>;

    /// The approach at which undisturbed bodies touch.
    fn rest(_: &C) -> f64 {
        0.0
    }

    /// Sees the times and sizes of the loads of the run, before the first step.
    fn look(_: &mut Record<Self>, _: &[(f64, f64)]) {}

    /// A contact that tries steps.
    fn trial(contact: &C) -> C {
        contact.clone()
    }

    /// Takes over the state of a contact.
    fn copy(to: &mut C, from: &C) {
        to.clone_from(from);
    }

    /// A step of a trial.
    fn take(contact: &mut C, time: f64, load: Load) -> Result<StepReport> {
        contact.step_to(time, load)
    }

    /// Sees the state at the end of an accepted step.
    fn accept(_: &Record<Self>, _: &mut C) {}

    /// Starts differences of steps anew.
    fn turn(_: &mut C) {}

    /// The time at which a step that is not the first one after a corner has to end, at the `stop` of the run at the
    /// latest.
    fn stop(_: &Record<Self>, _: &C, stop: f64, _corner: f64) -> f64 {
        stop
    }

    /// The most that a step towards this load may be longer than the one before.
    fn longest_growth(_: &C, _: Load) -> f64 {
        MAX_GROWTH
    }

    /// The error that a step aims at.
    fn aim(record: &Record<Self>, contact: &C, span: Span) -> f64;

    /// The first time within a step at which it has to end: where bodies touch or part, or a force begins or ends.
    fn event(
        record: &Record<Self>,
        contact: &C,
        history: &dyn LoadHistory,
        passage: &Passage,
        scratch: &mut C,
    ) -> Result<Option<f64>>;

    /// The error of the halves of a step from the state of `contact`.
    fn error(
        record: &Record<Self>,
        contact: &C,
        tries: &mut Tries<C>,
        history: &dyn LoadHistory,
        span: Span,
        report: &StepReport,
    ) -> Result<f64>;

    /// Saves a contact with a run that continues from there.
    #[cfg(feature = "checkpoint")]
    fn save(_: &C, _: &Progress, _: &Record<Self>, _: &Path) -> Result<()> {
        Err(coverage::RUN_IN_FILE.error())
    }

    /// Maximum approach and force of the run, the step that was tried included, for errors relative to them.
    fn greatest(record: &Record<Self>, halves: &C) -> [f64; 2];
}

/// Outcomes of one step: taken whole, in halves, and after the first half.
#[derive(Debug, Clone)]
pub(crate) struct Tries<C> {
    pub(crate) whole: C,
    pub(crate) halves: C,
    pub(crate) middle: C,
}

/// What the control knows of the run: all that a run from a file needs.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Record<J> {
    /// The load that acts; unknown before the first step.
    load: Option<Load>,
    pub(crate) tolerance: f64,
    pub(crate) start: f64,
    pub(crate) until: f64,
    /// Length of the next step; 0 after a jump or a corner.
    pub(crate) next: f64,
    /// Time of the last jump or corner.
    pub(crate) corner: f64,
    /// Whether the last step ended where bodies touched.
    pub(crate) touches: bool,
    /// Whether forces are given throughout the run.
    pub(crate) by_force: bool,
    pub(crate) greatest: [f64; 2],
    /// Times at which the load of the run bends, unknown before it was looked at, and its maximum.
    bends: Option<Vec<f64>>,
    pub(crate) greatest_load: f64,
    /// Loads below this one are lost in rounding.
    pub(crate) least_load: f64,
    /// Maximum error of an adaptive step.
    worst: Option<f64>,
    rejected: u64,
    pub(crate) own: J,
}

impl<J> Record<J> {
    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self) -> bool {
        let sizes = [self.next, self.greatest[0], self.greatest[1], self.greatest_load, self.least_load];
        let times = self.bends.iter().flatten().copied();
        sizes.iter().all(|&size| size >= 0.0)
            && times.chain([self.start, self.until, self.next, self.corner]).all(f64::is_finite)
            && self.bends.as_ref().is_none_or(|bends| bends.is_sorted())
    }

    /// Looks at the load of the run, which fails where there is none. A load that the contact has no size for fails
    /// the step to it.
    fn look<C: Contact>(&mut self, contact: &C, history: &dyn LoadHistory) -> Result<()>
    where
        J: Judge<C>,
    {
        let (mut loads, mut forces, mut others) = (Vec::new(), false, false);
        for look in looks(history, [contact.time(), self.until], contact.attracts()) {
            let (time, [before, at]) = look?;
            for load in [before, at].into_iter().skip(usize::from(before == at)) {
                (forces, others) = (forces || load.is_force(), others || !load.is_force());
                loads.extend(J::size(contact, load).ok().map(|load| (time, load)));
            }
        }
        (self.bends, self.by_force) = (Some(bends(&loads)), !others);
        self.greatest_load = loads.iter().fold(0.0, |most, load| load.1.max(most));
        // of forces or of depths
        self.least_load = if forces != others { f64::EPSILON * self.greatest_load } else { 0.0 };
        J::look(self, &loads);
        Ok(())
    }
}

/// The control of the steps of a run, and the state at the start of the last one.
#[derive(Debug, Clone)]
pub(crate) struct Doubled<C, J> {
    pub(crate) record: Record<J>,
    before: C,
    /// Whether the last step was taken in two halves.
    halved: bool,
    tries: Tries<C>,
    /// The load within the step.
    passage: Passage,
}

impl<C: Contact, J: Judge<C>> Doubled<C, J> {
    pub(crate) fn new(contact: &C, stepping: Stepping, until: f64) -> Doubled<C, J> {
        let (start, (_, tolerance)) = (contact.time(), stepping.lengths());
        Doubled::continued(contact, Record { tolerance, start, until, by_force: true, ..Record::default() })
    }

    pub(crate) fn continued(contact: &C, record: Record<J>) -> Doubled<C, J> {
        let (before, whole) = (contact.clone(), J::trial(contact));
        let tries = Tries { halves: whole.clone(), middle: whole.clone(), whole };
        Doubled { record, before, halved: false, tries, passage: Passage::default() }
    }

    /// The history that the steps follow.
    fn rounded<'a>(&self, contact: &C, history: &'a dyn LoadHistory) -> Rounded<'a> {
        Rounded { history, rest: J::rest(contact), least: self.record.least_load }
    }

    fn take_step(&mut self, contact: &mut C, course: &Course<'_>) -> Result<StepReport> {
        let history = course.histories.first();
        if self.record.tolerance > 0.0 && self.record.bends.is_none() {
            self.record.look(contact, history)?;
        }
        let rounded = self.rounded(contact, history);
        match course.given {
            Some((time, &[load, ..])) => contact.step_to(time, rounded.round(load)),
            _ => self.step(contact, &rounded, course),
        }
    }

    /// Takes the longest step that the tolerance allows, towards the next stop of the run.
    fn step(&mut self, contact: &mut C, history: &dyn LoadHistory, course: &Course<'_>) -> Result<StepReport> {
        let &Course { stop, corner, cancelled, .. } = course;
        let (now, is_first, tolerance) = (contact.time(), self.record.next == 0.0, self.record.tolerance);
        let attracts = contact.attracts();
        let load_at = |time: f64| history.checked_before(time, attracts);
        if stop - now <= 2.0 * SHORTEST * stop {
            let load = load_at(stop)?;
            return contact.step_to(stop, load);
        }
        if is_first {
            self.record.corner = now;
        }
        let stop = if is_first { stop } else { J::stop(&self.record, contact, stop, corner) };
        // times near 0 are resolved more finely; a jump may come so late that the creep after it is faster than times
        // are resolved
        let shortest = (SHORTEST * now).max(SHORTEST * SHORTEST * stop);
        let is_late = now > 0.0 && now - self.record.corner <= LATE * shortest;
        let mut length = if is_first { FIRST_STEP * (stop - now) } else { self.record.next }.max(shortest);
        let longest = J::longest_growth(contact, load_at(stop)?);
        let first = J::size(contact, history.checked_at(now, attracts)?)?;
        let mut last: Option<(f64, f64)> = None;
        loop {
            if is_late {
                length = length.max(shortest);
            } else if length < shortest {
                return Err(StepError::StepTooShort { time: now, dt: length, tolerance }.into());
            }
            let mut end = if now + (1.0 + SAME_TIME) * length >= stop { stop } else { now + length };
            let size_at = |time: f64| J::size(contact, load_at(time)?);
            let bends = self.record.bends.as_deref().unwrap_or_default();
            self.passage.look(Span { now, end }, first, bends, size_at)?;
            self.record.greatest_load = self.record.greatest_load.max(self.passage.top());
            // deviations below the least normal number are rounding
            let straight = (BEND * self.record.greatest_load).max(f64::MIN_POSITIVE);
            if self.passage.bend(self.record.greatest_load) > straight && end - now > 2.0 * shortest {
                length = 0.5 * (end - now);
                continue;
            }
            let event = J::event(&self.record, contact, history, &self.passage, &mut self.tries.whole)?;
            end = event.unwrap_or(end);
            let span = Span { now, end };
            let report = self.try_both(contact, history, span, cancelled)?;
            let error = J::error(&self.record, contact, &mut self.tries, history, span, &report)?;
            let order = match last {
                _ if is_first => 1.0,
                Some((length, before)) if 0.0 < error && error < before => {
                    ((before / error).ln() / (length / (end - now)).ln()).clamp(1.0, J::ORDER)
                }
                Some(_) => 1.0,
                None => J::ORDER,
            };
            let (aim, most) = (J::aim(&self.record, contact, span), if error > 0.0 { longest } else { MAX_GROWTH });
            let growth = (aim / error).powf(1.0 / order).clamp(MIN_GROWTH, most);
            if error <= ALLOWED * aim || is_late && length <= shortest {
                self.record.next = match event {
                    Some(_) => growth.clamp(0.5, 1.0) * length,
                    None => growth.max(0.5) * (end - now).max(length.min(stop - now)),
                };
                self.record.greatest = J::greatest(&self.record, &self.tries.halves);
                self.record.touches = event.is_some() && contact.is_separated();
                self.record.worst = Some(self.record.worst.map_or(error, |worst| worst.max(error)));
                J::copy(contact, &self.tries.halves);
                J::accept(&self.record, contact);
                return Ok(StepReport { dt: end - now, time_error: Some(error), ..report });
            }
            self.record.rejected += 1;
            last = Some((end - now, error));
            length = growth.min(0.5) * (end - now);
        }
    }

    /// Takes a step whole and in two halves. Returns the report of the second.
    fn try_both(
        &mut self,
        contact: &C,
        history: &dyn LoadHistory,
        Span { now, end }: Span,
        cancelled: Option<&AtomicBool>,
    ) -> Result<StepReport> {
        let Tries { whole, halves, middle } = &mut self.tries;
        let to = |contact: &mut C, time: f64| {
            unless_cancelled(cancelled)?;
            J::take(contact, time, history.checked_before(time, contact.attracts())?)
        };
        J::copy(whole, contact);
        to(whole, end)?;
        J::copy(halves, contact);
        to(halves, now + 0.5 * (end - now))?;
        J::copy(middle, halves);
        to(halves, end)
    }
}

fn unless_cancelled(flag: Option<&AtomicBool>) -> Result<()> {
    if flag.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
        Err(Error::Cancelled { what: "a step" })
    } else {
        Ok(())
    }
}

impl<C: Contact, J: Judge<C>> Control<C> for Doubled<C, J> {
    fn bears(&self, _: &C, loads: &[Load]) -> bool {
        self.record.load.as_ref() == loads.first()
    }

    fn advance(&mut self, contact: &mut C, course: &Course<'_>) -> Result<StepReport> {
        unless_cancelled(course.cancelled)?;
        J::copy(&mut self.before, contact);
        let report = self.take_step(contact, course).inspect_err(|_| J::copy(contact, &self.before))?;
        self.halved = course.given.is_none();
        self.record.load = Some(match course.given {
            Some((_, &[load, ..])) => load,
            _ => course.histories.first().checked_before(report.time, contact.attracts())?,
        });
        if report.time >= course.corner {
            J::turn(contact);
        }
        if report.dt == 0.0 || report.time >= course.corner {
            self.record.next = 0.0;
        }
        Ok(report)
    }

    fn within(&self, contact: &C, histories: &Histories<'_>, time: f64) -> Result<(C, StepReport)> {
        let rounded = self.rounded(contact, histories.first());
        let (history, attracts): (&dyn LoadHistory, _) = (&rounded, contact.attracts());
        let (start, end) = (self.before.time(), contact.time());
        within("time within the last step", time, (start..=end).contains(&time), "between its start and its end")?;
        let (mut found, load) = (contact.clone(), history.checked_at(time, attracts)?);
        if time < end {
            // an adaptive step is taken in two halves
            let mut trial = if self.halved { J::trial(&self.before) } else { self.before.clone() };
            let middle = start + 0.5 * (end - start);
            if self.halved && time > middle {
                trial.step_to(middle, history.checked_before(middle, attracts)?)?;
            }
            if time > start {
                trial.step_to(time, load)?;
            }
            J::copy(&mut found, &trial);
        }
        let report = found.report(time - start, load);
        Ok((found, report))
    }

    fn rejected(&self) -> u64 {
        self.record.rejected
    }

    fn worst(&self) -> ErrorBudget {
        ErrorBudget { time: self.record.worst, ..ErrorBudget::default() }
    }

    fn bends(&self) -> Vec<&[f64]> {
        self.record.bends.iter().map(|bends| &bends[..]).collect()
    }

    fn boxed(&self) -> Box<dyn Control<C>> {
        Box::new(self.clone())
    }

    #[cfg(feature = "checkpoint")]
    fn save_run(&self, contact: &C, progress: &Progress, path: &Path) -> Result<()> {
        J::save(contact, progress, &self.record, path)
    }
}
