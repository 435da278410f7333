//! How far a run has come, and when it is saved.

#[cfg(feature = "checkpoint")]
use std::time::{Duration, Instant};

use crate::contact::run::run_scale::RunScale;
use crate::contact::run::step_control::StepControl;
use crate::contact::run::stepping::Stepping;

/// How far a run has come, and what it knows of the steps to come.
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
    /// Greatest estimated errors in time of a step, in all and in a cell, and greatest residual.
    pub(super) worst: [f64; 3],
}

impl Progress {
    pub(super) fn begin(now: f64, stepping: Stepping) -> Progress {
        let (control, dt) = match stepping {
            Stepping::Fixed { dt } => (None, dt),
            Stepping::Adaptive { tolerance } => (Some(StepControl::new(tolerance)), 0.0),
        };
        Progress { start: now, now, steps: 0, dt, control, scale: None, worst: [0.0; 3] }
    }

    /// Whether it is that of a run that begins like this one.
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

    /// Takes account of the errors of a step.
    pub(super) fn include(&mut self, errors: [f64; 3]) {
        self.worst = [0, 1, 2].map(|which| self.worst[which].max(errors[which]));
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
