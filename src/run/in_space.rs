//! Runs of a contact in space.

use std::sync::Arc;

use crate::contact::{Step, StepReport, ViscoelasticContact};
use crate::error::Result;
use crate::hereditary::StepContext;
use crate::load::{Load, LoadHistory};
use crate::observe::MeshError;
use crate::rheology::TemperatureHistory;
use crate::run::Run;
use crate::run::adaptive_step::adaptive_step;
use crate::run::driven::{Course, Driven, Next};
use crate::run::error_budget::{ErrorBudget, StepErrors};
use crate::run::progress::{Progress, Stepping};
use crate::run::run_scale::RunScale;
use crate::run::step_control::StepControl;

/// The control of the steps, and the errors so far.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct SpaceControl {
    /// Chooses adaptive steps.
    pub(super) adaptive: Option<StepControl>,
    /// Greatest loads and displacements of a run by equal steps.
    pub(super) scale: Option<RunScale>,
    /// Greatest estimated errors in time of a step, in all and in a cell, and greatest residual; `None` before the first step.
    worst: Option<StepErrors>,
    /// Greatest estimated errors due to the mesh, of the states in contact.
    mesh: Option<MeshError>,
}

impl SpaceControl {
    /// Includes the errors of a step, and the errors of the mesh at its end.
    fn include(&mut self, errors: StepErrors, mesh: Option<MeshError>) {
        self.worst = Some(self.worst.map_or(errors, |worst| worst.max(errors)));
        self.mesh = match (self.mesh, mesh) {
            (Some(worst), Some(mesh)) => Some(worst.max(mesh)),
            (worst, mesh) => worst.or(mesh),
        };
    }

    /// The tolerance of the solver in the steps of a run.
    fn solver_tolerance(&self, contact: &ViscoelasticContact) -> f64 {
        let own = contact.scene.settings.tolerance;
        self.adaptive.as_ref().map_or(own, |control| control.solver_tolerance(&contact.scene))
    }
}

impl Driven for ViscoelasticContact {
    type Control = SpaceControl;

    fn control(&self, stepping: Stepping, _: f64) -> SpaceControl {
        let tolerance = if let Stepping::Adaptive { tolerance } = stepping { Some(tolerance) } else { None };
        SpaceControl { adaptive: tolerance.map(StepControl::new), ..SpaceControl::default() }
    }

    fn saved_progress(&mut self) -> Option<Arc<Progress<SpaceControl>>> {
        self.saved_run.take()?.downcast().ok()
    }

    fn load(&self, _: &SpaceControl) -> Option<Load> {
        Some(self.load())
    }

    fn temperature(&self) -> Option<&TemperatureHistory> {
        self.scene.temperature.as_ref()
    }

    fn untouched(&self) -> Option<f64> {
        let state = &self.computation.state;
        state.is_undisturbed().then(|| state.indenter.gap().datum)
    }

    fn advance(&mut self, control: &mut SpaceControl, course: &Course<'_>) -> Result<StepReport> {
        let rows = self.computation.state.region.rows();
        rows.together(|| {
            let (report, errors) = match course.next {
                Next::Given { time, load } => self.given_step(control, course, time, load)?,
                Next::Adaptive { tolerance } => {
                    let steps = control.adaptive.get_or_insert_with(|| StepControl::new(tolerance));
                    adaptive_step(self, steps, *course)?
                }
            };
            control.include(errors, self.mesh_error().unwrap_or_default());
            Ok(report)
        })
    }

    fn within(&self, control: &SpaceControl, history: &dyn LoadHistory, time: f64) -> Result<(Self, StepReport)> {
        let loads = |_: &_| Ok(vec![history.checked_at(time, self.scene.attraction.is_some())?]);
        let (contact, reach) = self.advanced_within_step(time, control.solver_tolerance(self), loads)?;
        let report = contact.report(None, reach);
        Ok((contact, report))
    }

    fn rejected(control: &SpaceControl) -> u64 {
        control.adaptive.as_ref().map_or(0, |control| control.rejected)
    }

    #[cfg(feature = "checkpoint")]
    fn autosave(run: &mut Run<'_>, over: bool) -> Result<()> {
        run.save_if_due(over)
    }
}

impl ViscoelasticContact {
    fn given_step(
        &mut self,
        control: &mut SpaceControl,
        course: &Course<'_>,
        time: f64,
        load: Load,
    ) -> Result<(StepReport, StepErrors)> {
        let dt = time - self.time();
        if dt == 0.0 {
            control.adaptive.iter_mut().for_each(StepControl::jump);
        }
        let (tolerance, loads) = (control.solver_tolerance(self), [load]);
        let step = Step { cancelled: course.cancelled, ..self.request(time, dt, &loads, tolerance)? };
        let ViscoelasticContact { scene, computation, .. } = &*self;
        if control.scale.is_none() {
            control.scale = Some(RunScale::new(scene, &computation.state, course.history, course.until)?);
        }
        let age = step.interval.reduced - computation.state.clock.undisturbed_until;
        let expected = control.scale.as_ref().map_or([0.0; 2], |scale| scale.expected(scene, &load, age));
        let outlook = StepContext { expected, ..StepContext::default() };
        let (report, error) = self.take_expecting(step, outlook)?;
        if time == course.corner {
            self.computation.state.history.reset_differences();
        }
        let errors = StepErrors { time: error.relative, pressure: error.greatest, residual: report.residual };
        Ok((report, errors))
    }
}

impl Run<'_> {
    /// The errors of the run so far, by their source.
    pub fn error_budget(&self) -> ErrorBudget {
        let SpaceControl { worst, mesh, .. } = self.progress.control;
        ErrorBudget {
            time: worst.map(|worst| worst.time),
            pressure: worst.map(|worst| worst.pressure),
            mesh: self.contact.mesh_error().unwrap_or_default(),
            max_mesh: mesh,
            solver: worst.map_or(0.0, |worst| worst.residual),
        }
    }
}
