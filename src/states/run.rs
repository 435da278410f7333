//! Runs of contacts on elastic states.

#[cfg(feature = "checkpoint")]
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use crate::contact::StepReport;
use crate::error::{Error, Result, within};
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use crate::run::driven::{Course, Driven};
use crate::run::histories::Histories;
use crate::run::progress::Progress;
use crate::run::{OwnedOrBorrowed, Run, Stepping};
use crate::states::contact::StatesContact;
use crate::states::control::{Record, StatesControl, load_at};
#[cfg(feature = "checkpoint")]
use crate::states::saved::SavedRun;

/// A [`Run`] of a [`StatesContact`], made by [`StatesContact::follow`]. Adaptive steps are taken whole and in two
/// halves, and the halves are kept. The error of the step is the difference of both, in depth and force and in what
/// the surfaces can ever add to them.
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

impl Driven for StatesContact {
    type Control = StatesControl;
    type Exact = StatesContact;

    fn instead(exact: &StatesContact) -> Option<&StatesContact> {
        Some(exact)
    }

    fn begin(&mut self, stepping: Stepping, until: f64) -> (Progress, StatesControl) {
        let (_, tolerance) = stepping.lengths();
        #[cfg(feature = "checkpoint")]
        if let Some(Ok(saved)) = self.saved_run.take().map(|saved| saved.downcast::<SavedRun>())
            && saved.0.continues(self.time, stepping, until)
        {
            let (progress, mut record) = (*saved).clone();
            record.tolerance = tolerance;
            return (progress, StatesControl::new(self, record));
        }
        (Progress::begin(self.time, stepping), StatesControl::new(self, Record::new(until, tolerance)))
    }

    fn bears(&self, control: &StatesControl, loads: &[Load]) -> bool {
        control.record.load.as_ref() == loads.first()
    }

    fn temperature(&self) -> Option<&TemperatureHistory> {
        self.scene.temperature.as_ref()
    }

    fn untouched(&self) -> Option<f64> {
        (self.groups() == 0).then(|| self.states().approach(0.0))
    }

    fn is_known_until(&self, end: f64) -> Result<()> {
        let Ok((_, reduced)) = self.reduced(end, end - self.time) else { return Ok(()) };
        self.scene.limits.check_age(end, reduced - self.undisturbed_until, true)
    }

    fn advance(&mut self, control: &mut StatesControl, course: &Course<'_>) -> Result<StepReport> {
        if course.cancelled.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Err(Error::Cancelled { what: "a step" });
        }
        control.before.copy_from(self);
        let rounded = control.rounded(self, course.histories.first())?;
        let report = match course.given {
            Some((time, &[load, ..])) => self.step_to(time, time - self.time(), rounded.round(load))?,
            _ => control.step(self, &rounded, course)?,
        };
        control.halved = course.given.is_none();
        control.record.load = match course.given {
            Some((_, &[load, ..])) => Some(load),
            _ => Some(load_at(course.histories.first(), report.time)?),
        };
        if report.time >= course.corner {
            self.reset_differences();
        }
        if report.dt == 0.0 || report.time >= course.corner {
            control.record.next = 0.0;
        }
        Ok(report)
    }

    fn within(&self, control: &StatesControl, histories: &Histories<'_>, time: f64) -> Result<(Self, StepReport)> {
        let history = histories.first();
        let (start, end) = (control.before.time(), self.time());
        let history: &dyn LoadHistory = &control.of_record(self, history);
        within("time within the last step", time, (start..=end).contains(&time), "between its start and its end")?;
        let mut contact = if time == end { self.clone() } else { control.before.clone() };
        // an adaptive step is taken in two halves
        let scene = Arc::clone(&contact.scene);
        if control.halved {
            contact = contact.with_quadratic_steps();
        }
        let middle = start + 0.5 * (end - start);
        if control.halved && time > middle && time < end {
            contact.step_to(middle, middle - start, load_at(history, middle)?)?;
        }
        let load = history.checked_at(time, false)?;
        if time > start && time < end {
            contact.step_to(time, time - contact.time(), load)?;
        }
        let report = contact.report(time - start, load);
        // a clone of this contact, for snapshots
        contact.scene = scene;
        Ok((contact, report))
    }

    // steps on levels are free: fields have a run of their own
    fn tighten(_: &mut StatesControl, _: f64) {}

    fn rejected(control: &StatesControl) -> u64 {
        control.record.rejected
    }

    #[cfg(feature = "checkpoint")]
    fn save_run(&self, path: &Path, (progress, control): (&Progress, &StatesControl)) -> Result<()> {
        self.save_with(path, Some((progress.clone(), control.record.clone())))
    }
}
