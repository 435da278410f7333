//! Runs of contacts on elastic states.

use std::sync::atomic::Ordering;

use crate::contact::StepReport;
use crate::error::{Error, Result, StepError, within};
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use crate::run::driven::{Course, Driven, Next};
use crate::run::{OwnedOrBorrowed, Run, SAME_TIME, Stepping};
use crate::states::contact::StatesContact;

/// First adaptive step after a jump or a corner, over the time to the next one.
const FIRST_STEP: f64 = 1e-4;
/// Limits of the ratio of a step to the one before.
const MAX_GROWTH: f64 = 4.0;
const MIN_GROWTH: f64 = 0.1;
/// Shares of the tolerance that the error of a step aims at, and that it may have: errors of several steps add up.
const AIM: f64 = 0.1;
const ALLOWED: f64 = 0.3;
/// Order of a corrected step, by which its length is chosen.
const ORDER: f64 = 3.0;
/// Two halves err by a third of their difference to the whole, as where the order is two: the curve between states has kinks in its
/// curvature.
const OF_HALVES: f64 = 1.0 / 3.0;

/// A [`Run`] of a [`StatesContact`], made by [`StatesContact::follow`]. Adaptive steps are taken whole and in two halves; the difference
/// is the error of the step, and the halves are kept.
///
/// ```
/// use viscocontact::prelude::*;
/// use viscocontact::states::{Reach, StatesContact, Sweep};
///
/// let states = Sweep::new(Grid::square(32, 4.0e-3)?, &Sphere::new(10.0e-3)?).run(Reach::Level(6.0e-7))?;
/// let mut contact = StatesContact::new(&states, &Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?))?;
/// let load = Ramp::new(Load::force(0.0), Load::force(0.5), 1.0)?;
/// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-4), 10.0);
/// while let Some(report) = run.next_step()? {
///     println!("{:.3} s  {:.4} mm²", report.time, run.contact().contact_area() * 1e6);
/// }
/// # Ok::<(), viscocontact::Error>(())
/// ```
pub type StatesRun<'a> = Run<'a, StatesContact>;

impl StatesContact {
    /// Follows a load history to the time `until` \[s\], in steps chosen by `stepping`.
    pub fn follow<'a>(&'a mut self, history: &'a dyn LoadHistory, stepping: Stepping, until: f64) -> StatesRun<'a> {
        Run::new(OwnedOrBorrowed::Borrowed(self), OwnedOrBorrowed::Borrowed(history), stepping, until)
    }

    /// Like [`StatesContact::follow`], for a run that owns the contact and its history, as
    /// [`ViscoelasticContact::into_follow`](crate::ViscoelasticContact::into_follow).
    pub fn into_follow(
        self,
        history: impl LoadHistory + 'static,
        stepping: Stepping,
        until: f64,
    ) -> StatesRun<'static> {
        Run::new(OwnedOrBorrowed::Owned(Box::new(self)), OwnedOrBorrowed::Owned(Box::new(history)), stepping, until)
    }
}

/// The control of the steps of a run, and the state at the start of the last one.
#[derive(Debug, Clone)]
pub struct StatesControl {
    /// The load that acts; unknown before the first step.
    load: Option<Load>,
    before: StatesContact,
    steps: StepControl,
    /// Whether the last step was taken in two halves.
    halved: bool,
}

impl Driven for StatesContact {
    type Control = StatesControl;

    fn control(&self, _: Stepping, until: f64) -> StatesControl {
        StatesControl { load: None, before: self.clone(), steps: StepControl::new(self, until), halved: false }
    }

    fn load(&self, control: &StatesControl) -> Option<Load> {
        control.load
    }

    fn temperature(&self) -> Option<&TemperatureHistory> {
        StatesContact::temperature(self)
    }

    fn untouched(&self) -> Option<f64> {
        (self.groups() == 0).then(|| self.states().approach(0.0))
    }

    fn advance(&mut self, control: &mut StatesControl, course: &Course<'_>) -> Result<StepReport> {
        if course.cancelled.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Err(Error::Cancelled { what: "a step" });
        }
        let StatesControl { load, before, steps, halved } = control;
        before.copy_from(self);
        let report = match course.next {
            Next::Given { time, load } => self.step_to(time, time - self.time(), load)?,
            Next::Adaptive { tolerance } => steps.step(self, course.history, tolerance, course.stop)?,
        };
        (*load, *halved) = match course.next {
            Next::Given { load, .. } => (Some(load), false),
            Next::Adaptive { .. } => (Some(load_at(course.history, report.time)?), true),
        };
        if report.time >= course.corner {
            self.reset_differences();
        }
        if report.dt == 0.0 || report.time >= course.corner {
            steps.restart();
        }
        Ok(report)
    }

    fn within(&self, control: &StatesControl, history: &dyn LoadHistory, time: f64) -> Result<(Self, StepReport)> {
        let (start, end) = (control.before.time(), self.time());
        within("time within the last step", time, (start..=end).contains(&time), "between its start and its end")?;
        let mut contact = if time == end { self.clone() } else { control.before.clone() };
        // an adaptive step is taken in two halves
        let middle = start + 0.5 * (end - start);
        if control.halved && time > middle && time < end {
            contact.step_to(middle, middle - start, load_at(history, middle)?)?;
        }
        let load = history.checked_at(time, false)?;
        if time > start && time < end {
            contact.step_to(time, time - contact.time(), load)?;
        }
        let report = contact.report(time - start, load);
        Ok((contact, report))
    }

    fn rejected(control: &StatesControl) -> u64 {
        control.steps.rejected
    }
}

/// The load at a time, or just before it where it jumps.
fn load_at(history: &dyn LoadHistory, time: f64) -> Result<Load> {
    history.checked_before(time, false)
}

/// Chooses the adaptive steps.
#[derive(Debug, Clone)]
struct StepControl {
    /// Length of the next step; 0 after a jump or a corner.
    next: f64,
    /// Greatest depth and force of the run, for errors relative to them.
    greatest: [f64; 2],
    rejected: u64,
    before: StatesContact,
}

impl StepControl {
    fn new(contact: &StatesContact, _until: f64) -> StepControl {
        StepControl { next: 0.0, greatest: [0.0; 2], rejected: 0, before: contact.clone() }
    }

    /// Starts anew after a jump or a corner.
    fn restart(&mut self) {
        self.next = 0.0;
    }

    fn step(
        &mut self,
        contact: &mut StatesContact,
        history: &dyn LoadHistory,
        tolerance: f64,
        stop: f64,
    ) -> Result<StepReport> {
        let now = contact.time();
        self.before.copy_from(contact);
        let mut length = if self.next > 0.0 { self.next } else { FIRST_STEP * (stop - now) };
        loop {
            let end = if now + (1.0 + SAME_TIME) * length >= stop { stop } else { now + length };
            let middle = now + 0.5 * (end - now);
            if !(now < middle && middle < end) {
                return Err(Error::Step(StepError::StepTooShort { time: now, dt: length, tolerance }));
            }
            let (report, difference) = match self.whole_and_halves(contact, history, [now, middle, end]) {
                Ok(taken) => taken,
                Err(error) => {
                    contact.copy_from(&self.before);
                    return Err(error);
                }
            };
            let error = OF_HALVES * difference;
            let growth = (AIM * tolerance / error).powf(1.0 / ORDER).clamp(MIN_GROWTH, MAX_GROWTH);
            if error <= ALLOWED * tolerance {
                self.next = growth.max(0.5) * (end - now).max(length.min(stop - now));
                return Ok(StepReport { dt: end - now, time_error: Some(error), ..report });
            }
            contact.copy_from(&self.before);
            self.rejected += 1;
            length = growth.min(0.5) * (end - now);
        }
    }

    /// Takes a step in two halves. Returns how far the whole step differs from them: in depth and force, relative to values that are
    /// not small in this run.
    fn whole_and_halves(
        &mut self,
        contact: &mut StatesContact,
        history: &dyn LoadHistory,
        [now, middle, end]: [f64; 3],
    ) -> Result<(StepReport, f64)> {
        let whole = contact.outcome(end, load_at(history, end)?)?;
        contact.step_to(middle, middle - now, load_at(history, middle)?)?;
        let report = contact.step_to(end, end - middle, load_at(history, end)?)?;
        let mut difference = 0.0f64;
        for (k, halves) in [contact.depth(), report.force].into_iter().enumerate() {
            self.greatest[k] = self.greatest[k].max(halves.abs());
            let scale = halves.abs().max(0.1 * self.greatest[k]);
            if scale > 0.0 {
                difference = difference.max((whole[k] - halves).abs() / scale);
            }
        }
        Ok((report, difference))
    }
}
