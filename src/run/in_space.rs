//! Runs of a contact in space.

#[cfg(feature = "checkpoint")]
use std::path::Path;

use crate::contact::{Step, StepReport, ViscoelasticContact};
use crate::error::Result;
use crate::fields::KeptFields;
use crate::hereditary::{StepContext, TimeError};
use crate::load::Load;
use crate::rheology::TemperatureHistory;
use crate::run::Run;
use crate::run::adaptive_step::adaptive_step;
use crate::run::driven::{Course, Driven};
use crate::run::error_budget::ErrorBudget;
use crate::run::halves::Halves;
use crate::run::histories::Histories;
use crate::run::progress::{Progress, Stepping};
use crate::run::step_control::StepControl;

impl Driven for ViscoelasticContact {
    type Control = StepControl;
    type Exact = KeptFields;

    fn begin(&mut self, stepping: Stepping, until: f64) -> (Progress, StepControl) {
        let saved = self.saved_run.take().and_then(|saved| saved.downcast::<(Progress, StepControl)>().ok());
        let continues = |(progress, control): &(Progress, StepControl)| {
            progress.continues(self.time(), stepping, until) && control.tracks.len() == self.fields().bodies()
        };
        match saved.filter(|saved| continues(saved)) {
            Some(saved) => (*saved).clone(),
            None => (Progress::begin(self.time(), stepping), StepControl::new(stepping, self.fields().bodies())),
        }
    }

    fn bears(&self, _: &StepControl, loads: &[Load]) -> bool {
        self.computation.state.held.loads == loads
    }

    fn temperature(&self) -> Option<&TemperatureHistory> {
        self.scene.temperature.as_ref()
    }

    fn untouched(&self) -> Option<f64> {
        let state = &self.computation.state;
        state.is_undisturbed().then(|| state.held.indenter.gap().datum)
    }

    fn is_known_until(&self, end: f64) -> Result<()> {
        let clock = &self.computation.state.clock;
        // a temperature that the law does not cover ends the run when it is reached
        let Ok(reduced) = self.scene.reduced_time(clock, end) else { return Ok(()) };
        self.scene.limits.check_age(end, reduced - clock.undisturbed_until, true)
    }

    fn advance(&mut self, control: &mut StepControl, course: &Course<'_>) -> Result<StepReport> {
        let rows = self.computation.state.held.region.rows();
        rows.unless_lost(|| {
            let (report, error) = match course.given {
                Some((time, loads)) => self.given_step(control, course, time, loads)?,
                None => adaptive_step(self, control, course)?,
            };
            control.include(&error, report.residual);
            Ok(report)
        })
    }

    fn within(&self, control: &StepControl, histories: &Histories<'_>, time: f64) -> Result<(Self, StepReport)> {
        let attracts = self.scene.ground.attraction.is_some();
        let loads = |_: &_| histories.each().map(|history| history.checked_at(time, attracts)).collect();
        let of_last = |halves: &&Halves| halves.middle == self.computation.state.start.clock.time;
        let before = control.halves.as_deref().filter(of_last).map(|halves| &halves.start);
        let (contact, pressed) =
            self.advanced_within_step(time, control.solver_tolerance(&self.scene), before, loads)?;
        let report = contact.report(None, pressed);
        Ok((contact, report))
    }

    fn tighten(control: &mut StepControl, tolerance: f64) {
        control.tolerance = control.tolerance.min(tolerance);
    }

    fn rejected(control: &StepControl) -> u64 {
        control.rejected
    }

    #[cfg(feature = "checkpoint")]
    fn save_run(&self, path: &Path, (progress, control): (&Progress, &StepControl)) -> Result<()> {
        self.save_with(path, Some(&(progress.clone(), control.clone())))
    }

    #[cfg(feature = "checkpoint")]
    fn is_due(&self, due: bool) -> Result<bool> {
        let rows = self.computation.state.held.region.rows();
        rows.unless_lost(|| Ok(rows.any(due)))
    }
}

impl ViscoelasticContact {
    fn given_step(
        &mut self,
        control: &mut StepControl,
        course: &Course<'_>,
        time: f64,
        loads: &[Load],
    ) -> Result<(StepReport, TimeError)> {
        let dt = time - self.time();
        if dt == 0.0 {
            control.jump();
        }
        let tolerance = control.solver_tolerance(&self.scene);
        let step = Step { cancelled: course.cancelled, ..self.request(time, dt, loads, tolerance)? };
        let state = &self.computation.state;
        control.look_ahead(&self.scene, state, course.histories, course.until)?;
        let (report, error) = self.take_expecting(step, &StepContext::default())?;
        if time == course.corner {
            self.computation.state.history.reset_differences();
        }
        Ok((report, error))
    }
}

impl Run<'_> {
    /// The errors of the run so far, by their source. That of the mesh is
    /// [measured](crate::fields::Fields::mesh_error) by this call, in the present state.
    pub fn error_budget(&self) -> ErrorBudget {
        let mesh = self.contact.fields().mesh_error().unwrap_or_default();
        ErrorBudget { field: self.worst_field(), mesh, ..self.control.worst }
    }
}
