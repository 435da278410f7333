//! Steps as long as their error allows, which is measured: each is taken whole and in two halves.
//!
//! The halves are kept. How far the whole is from them tells the error, in the measure of the [`Judge`] of the
//! contact. What happens within a step and is over at its end does not show there: so the control looks at the load
//! within the step, and ends steps at its events.

pub(crate) mod judge;
pub(crate) mod plain;
mod rounded;
pub(crate) mod turned_back;

#[cfg(feature = "checkpoint")]
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::contact::{Estimated, Figures, StepReport, Warnings};
use crate::error::{Error, ErrorKind, Result, StepError, within};
use crate::load::{Load, LoadHistory};
use crate::run::Contact;
use crate::run::control::{Control, Course, MOST_UNSOLVED};
use crate::run::error_budget::ErrorBudget;
use crate::run::histories::Histories;
use crate::run::passage::{AT_START, Passage, Span};
use crate::run::progress::{Progress, SAME_TIME, Stepping};
use judge::{FIRST_STEP, Judge, MAX_GROWTH, Record, Tries};
use rounded::WithoutRounding;

/// Rounding of times: no step is shorter than this part of the time.
const SHORTEST: f64 = 8.0 * f64::EPSILON;
/// Within so many of the shortest steps after a jump or a corner, the creep may be faster than times are resolved:
/// such a step is accepted.
const LATE: f64 = 64.0;
/// Limit of the ratio of a step to the one before.
const MIN_GROWTH: f64 = 0.1;
/// A step may have so many times the error that it aims at.
const ALLOWED: f64 = 3.0;
/// The next attempt, over one that the solver did not converge for.
const SHORTER_UNSOLVED: f64 = 0.2;
/// Maximum deviation of the load from a parabola within a step, over the maximum load.
const BEND: f64 = 0.03;

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
    /// Convolutions, and preconditioner applications, of the tries of the step.
    work: [usize; 2],
    /// The first time within the step at which what acts along the surface turns: what slips there turns back, and the
    /// contact remembers where it turned.
    turn: Option<f64>,
}

impl<C: Contact, J: Judge<C>> Doubled<C, J> {
    fn new(contact: &C, record: Record<J>) -> Doubled<C, J> {
        let (before, whole) = (contact.clone(), J::trial(contact));
        let tries = Tries { halves: whole.clone(), middle: whole.clone(), whole };
        Doubled { record, before, halved: false, tries, passage: Passage::default(), work: [0; 2], turn: None }
    }

    /// The history that the steps follow.
    fn rounded<'a>(&self, contact: &C, history: &'a dyn LoadHistory) -> WithoutRounding<'a> {
        WithoutRounding { history, rest: J::rest(contact), least: self.record.least_load }
    }

    fn take_step(&mut self, contact: &mut C, course: &Course<'_>) -> Result<StepReport> {
        let rounded = self.rounded(contact, course.histories.first());
        match course.given {
            Some((time, &[load, ..])) => contact.step_to_unless(course.cancelled, time, rounded.round(load)),
            _ => self.step(contact, &rounded, course),
        }
    }

    /// Takes the longest step that the tolerance allows, towards the next stop of the run.
    fn step(&mut self, contact: &mut C, history: &dyn LoadHistory, course: &Course<'_>) -> Result<StepReport> {
        let &Course { stop, cancelled, .. } = course;
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
        // times near 0 are resolved more finely; a jump may come so late that the creep after it is faster than times
        // are resolved
        let shortest = (SHORTEST * now).max(SHORTEST * SHORTEST * stop);
        let is_late = now > 0.0 && now - self.record.corner <= LATE * shortest;
        let mut length = if is_first { FIRST_STEP * (stop - now) } else { self.record.next }.max(shortest);
        let longest = J::longest_growth(contact, load_at(stop)?);
        let first = J::size(contact, history.checked_at(now, attracts)?)?;
        let mut failures = 0;
        self.work = [0; 2];
        loop {
            if is_late {
                length = length.max(shortest);
            } else if length < shortest {
                return Err(self.too_short(contact, history, Span { now, end: stop }, length, cancelled));
            }
            let mut end = if now + (1.0 + SAME_TIME) * length >= stop { stop } else { now + length };
            if self.bends(contact, history, Span { now, end }, first)? && end - now > 2.0 * shortest {
                length = 0.5 * (end - now);
                continue;
            }
            let event = J::event(&self.record, contact, history, &self.passage, &mut self.tries.whole)?;
            let turn = self.turn.filter(|turn| event.is_none_or(|event| *turn < event));
            let event = turn.or(event);
            end = event.unwrap_or(end);
            let span = Span { now, end };
            let report = match self.try_both(contact, history, span, cancelled) {
                // up to where the load becomes too much for the contact
                Err(error) if contact.is_beyond(&error) && end - now > 0.1 * tolerance * (end - self.record.start) => {
                    self.record.rejected += 1;
                    length = 0.5 * (end - now);
                    continue;
                }
                Err(error) if error.kind() == ErrorKind::Convergence && failures < MOST_UNSOLVED => {
                    (failures, self.record.rejected) = (failures + 1, self.record.rejected + 1);
                    length = SHORTER_UNSOLVED * (end - now);
                    continue;
                }
                report => report?,
            };
            let error = J::error(&self.record, contact, &mut self.tries, history, span, &report)?;
            let corner = if J::begins_anew(contact, &self.tries.halves) { now } else { self.record.corner };
            let aim = J::aim(&self.record, contact, span, corner);
            let most = if error > 0.0 { longest } else { MAX_GROWTH };
            let growth = (aim / error).powf(1.0 / J::ORDER).clamp(MIN_GROWTH, most);
            if error <= ALLOWED * aim || is_late && length <= shortest {
                self.record.next = match event {
                    // what slid sticks and slips anew
                    Some(_) if turn.is_some() && (contact.slides() || self.tries.halves.slides()) => {
                        (FIRST_STEP * (self.record.until - end)).min(growth.max(0.5) * (end - now))
                    }
                    Some(_) => growth.clamp(0.5, 1.0) * length,
                    None => growth.max(0.5) * (end - now).max(length.min(stop - now)),
                };
                self.record.greatest = J::greatest(&self.record, &self.tries.halves);
                self.record.touches = event.is_some() && contact.is_separated();
                self.record.worst = Some(self.record.worst.map_or(error, |worst| worst.max(error)));
                self.record.corner = corner;
                J::copy(contact, &self.tries.halves);
                J::accept(&self.record, contact);
                // of all tries
                let [convolutions, preconditioner_applications] = self.work;
                let dt = end - now;
                return Ok(StepReport {
                    dt,
                    time_error: Some(error),
                    convolutions,
                    preconditioner_applications,
                    ..report
                });
            }
            self.record.rejected += 1;
            length = growth.min(0.5) * (end - now);
        }
    }

    /// Why no step before a stop is short enough: a load that soon becomes too much for the contact, if there is one, near
    /// which motions grow beyond all accuracy. Soon is the tolerance of the time so far, or a few times as much.
    fn too_short(
        &mut self,
        contact: &C,
        history: &dyn LoadHistory,
        Span { now, end }: Span,
        dt: f64,
        cancelled: Option<&AtomicBool>,
    ) -> Error {
        let (tolerance, start) = (self.record.tolerance, self.record.start);
        for times in [1.0, 4.0, 16.0] {
            let soon = Span { now, end: end.min(now + times * tolerance * (now - start)) };
            match self.try_both(contact, history, soon, cancelled) {
                Err(error) if contact.is_beyond(&error) || matches!(error, Error::Cancelled { .. }) => return error,
                _ => {}
            }
        }
        StepError::StepTooShort { time: now, dt, tolerance }.into()
    }

    /// Looks at the loads within a step, the normal one of which begins with this size: whether one is off a parabola.
    fn bends(&mut self, contact: &C, history: &dyn LoadHistory, span: Span, first: f64) -> Result<bool> {
        let Doubled { record, passage, turn, .. } = self;
        // deviations below the least normal number are rounding
        let is_bent =
            |passage: &Passage, greatest| passage.bend(greatest) > f64::max(BEND * greatest, f64::MIN_POSITIVE);
        *turn = None;
        let mut is_bent_along = false;
        for (along, greatest) in contact.lateral().iter().zip(&mut record.greatest_along) {
            let size_at = |time: f64| Ok(along.checked_before(time, true).map_err(Error::along)?.main());
            let first = along.checked_at(span.now, true).map_err(Error::along)?.main();
            passage.look(span, first, &record.bends_along, size_at)?;
            *greatest = passage.top().abs().max(*greatest);
            let first =
                passage.turns().map(|turn| turn.0).find(|turn| turn - span.now > AT_START * (span.end - span.now));
            *turn = [*turn, first].into_iter().flatten().reduce(f64::min);
            is_bent_along |= is_bent(passage, *greatest);
        }
        let size_at = |time: f64| J::size(contact, history.checked_before(time, contact.attracts())?);
        passage.look(span, first, record.bends.as_deref().unwrap_or_default(), size_at)?;
        record.greatest_load = record.greatest_load.max(passage.top());
        Ok(is_bent_along || is_bent(passage, record.greatest_load))
    }

    /// Takes a step whole and in two halves. Returns the report of the second.
    fn try_both(
        &mut self,
        contact: &C,
        history: &dyn LoadHistory,
        Span { now, end }: Span,
        cancelled: Option<&AtomicBool>,
    ) -> Result<StepReport> {
        let Doubled { tries: Tries { whole, halves, middle }, work, .. } = self;
        let mut to = |contact: &mut C, time: f64| {
            unless_cancelled(cancelled)?;
            let mut report = J::take(contact, time, history.checked_before(time, contact.attracts())?, cancelled)?;
            work[0] += std::mem::take(&mut report.convolutions);
            work[1] += std::mem::take(&mut report.preconditioner_applications);
            Ok(report)
        };
        J::copy(whole, contact);
        to(whole, end)?;
        J::copy(halves, contact);
        to(halves, now + 0.5 * (end - now))?;
        J::copy(middle, halves);
        to(halves, end)
    }
}

/// A run in a file.
pub type SavedRun<J> = (Progress, Record<J>);

/// Progress and control of a run that begins here, or that continues a saved one.
pub(crate) fn lead<C: Contact, J: Judge<C>>(
    contact: &C,
    saved: Option<&SavedRun<J>>,
    stepping: Stepping,
    until: f64,
) -> (Progress, Box<dyn Control<C>>) {
    let time = contact.time();
    let (progress, record) = match saved.filter(|(progress, _)| progress.continues(time, stepping, until)) {
        Some((progress, record)) => {
            let mut record = record.clone();
            if until > record.until {
                // what lies beyond the end that it had is looked at
                (record.until, record.bends) = (until, None);
            }
            (progress.clone(), record)
        }
        None => {
            let (_, tolerance) = stepping.lengths();
            let record = Record { tolerance, start: time, until, by_force: true, ..Record::default() };
            (Progress::begin(time, stepping), record)
        }
    };
    (progress, Box::new(Doubled::<C, J>::new(contact, record)))
}

/// The report of a step without work.
pub(crate) fn report<C: Contact>(contact: &C, dt: f64, load: Load) -> StepReport {
    StepReport {
        time: contact.time(),
        force: contact.force(),
        approach: contact.approach(),
        contact_cells: contact.in_space().map_or(0, |fields| fields.contact_cells()),
        tilt: contact.tilt(),
        dt,
        time_error: (dt == 0.0).then_some(0.0),
        estimated: Estimated::under(&[load]),
        warnings: Warnings::default(),
        figures: Figures::default(),
        iterations: 0,
        fallback_iterations: 0,
        convolutions: 0,
        preconditioner_applications: 0,
        residual: 0.0,
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
    fn loads_act(&self, _: &C, loads: &[Load]) -> bool {
        self.record.loads == loads
    }

    fn advance(&mut self, contact: &mut C, course: &Course<'_>) -> Result<StepReport> {
        unless_cancelled(course.cancelled)?;
        if self.record.tolerance > 0.0 && self.record.bends.is_none() {
            self.record.look(contact, course.histories.first())?;
            self.passage.reserve(self.record.bends.as_ref().map_or(0, Vec::len).max(self.record.bends_along.len()));
        }
        contact.neglect(self.record.least_along());
        J::copy(&mut self.before, contact);
        let report = self.take_step(contact, course).inspect_err(|_| J::copy(contact, &self.before))?;
        self.halved = course.given.is_none();
        let (loads, attracts) = (&mut self.record.loads, contact.attracts());
        loads.clear();
        match course.given {
            Some((_, given)) => loads.extend_from_slice(given),
            None => {
                loads.push(course.histories.first().checked_before(report.time, attracts)?);
                for along in contact.lateral() {
                    loads.push(along.checked_before(report.time, true)?);
                }
            }
        }
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
        J::save(contact, (progress.clone(), self.record.clone()), path)
    }
}
