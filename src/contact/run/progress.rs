//! How far a run has come, and when it is saved.

#[cfg(feature = "checkpoint")]
use std::time::{Duration, Instant};

use crate::contact::run::error_budget::ErrorBudget;
use crate::contact::run::run_scale::RunScale;
use crate::contact::run::step_control::StepControl;
use crate::contact::run::stepping::Stepping;
use crate::observe::MeshError;

/// How far a run has come, and its data on the steps to come.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Progress {
    pub(super) start: f64,
    /// Time of the contact when this was true.
    pub(crate) now: f64,
    /// Equal steps that were taken, and their length, 0 for steps chosen by their error.
    pub(super) steps: u64,
    dt: f64,
    pub(super) control: Option<StepControl>,
    /// The sizes of a run by equal steps.
    pub(super) scale: Option<RunScale>,
    /// Greatest estimated errors in time of a step, in all and in a cell, and greatest residual; `None` before the first step.
    worst: Option<[f64; 3]>,
    /// Greatest estimated errors due to the mesh, of the states in contact.
    mesh: Option<MeshError>,
}

impl Progress {
    pub(super) fn begin(now: f64, stepping: Stepping) -> Progress {
        let (control, dt) = match stepping {
            Stepping::Fixed { dt } => (None, dt),
            Stepping::Adaptive { tolerance } => (Some(StepControl::new(tolerance)), 0.0),
        };
        Progress { start: now, now, steps: 0, dt, control, scale: None, worst: None, mesh: None }
    }

    /// Whether it belongs to a run that begins like this one.
    pub(super) fn continues(&self, begun: &Progress) -> bool {
        let tolerance = |progress: &Progress| progress.control.as_ref().map(|control| control.tolerance);
        self.now == begun.now && self.dt == begun.dt && tolerance(self) == tolerance(begun)
    }

    /// The end of the fixed step that is under way.
    pub(super) fn end_of_step(&self, dt: f64) -> f64 {
        self.start + (self.steps + 1) as f64 * dt
    }

    /// Whether a run can be continued from it: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self) -> bool {
        let scale_fits = self.scale.as_ref().is_none_or(RunScale::fits);
        scale_fits
            && match &self.control {
                Some(control) => control.fits(),
                None => (self.now - self.start - self.steps as f64 * self.dt).abs() <= 2.0 * self.dt,
            }
    }

    /// Takes account of the errors of a step, and of the mesh at its end.
    pub(super) fn include(&mut self, errors: [f64; 3], mesh: Option<MeshError>) {
        self.worst =
            self.worst.map_or(Some(errors), |worst| Some([0, 1, 2].map(|which| worst[which].max(errors[which]))));
        self.mesh = match (self.mesh, mesh) {
            (Some(worst), Some(mesh)) => Some(worst.max(mesh)),
            (worst, mesh) => worst.or(mesh),
        };
    }

    /// What is known of the errors so far, with those due to the `mesh` now.
    pub(super) fn error_budget(&self, mesh: Option<MeshError>) -> ErrorBudget {
        let [time, pressure] = [0, 1].map(|which| self.worst.map(|worst| worst[which]));
        ErrorBudget { time, pressure, mesh, max_mesh: self.mesh, solver: self.worst.map_or(0.0, |worst| worst[2]) }
    }
}

/// Where a run is saved, how often, and when it was last.
#[cfg(feature = "checkpoint")]
#[derive(Debug)]
pub(in crate::contact) struct Autosave {
    pub(in crate::contact) path: std::path::PathBuf,
    every: Duration,
    last: Instant,
}

#[cfg(feature = "checkpoint")]
impl Autosave {
    pub(in crate::contact) fn new(path: std::path::PathBuf, every: Duration) -> Autosave {
        Autosave { path, every, last: Instant::now() }
    }

    pub(in crate::contact) fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every
    }

    pub(in crate::contact) fn done(&mut self) {
        self.last = Instant::now();
    }
}
