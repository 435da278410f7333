//! How a run chooses its steps, how far it has come, the error so far, and when it is saved.

use std::fmt;
#[cfg(feature = "checkpoint")]
use std::time::{Duration, Instant};

use crate::contact::run::run_scale::RunScale;
use crate::contact::run::step_control::StepControl;
use crate::observe::MeshError;

/// How long the steps are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stepping {
    /// Equal steps, counted from the time at which following starts; cut where the load has a corner.
    Fixed {
        /// Length of a step \[s\].
        dt: f64,
    },
    /// Steps as long as the error in time allows; short after jumps and corners of the load, long when little happens.
    Adaptive {
        /// Error in time of approach or force.
        tolerance: f64,
    },
}

impl Stepping {
    /// Equal steps of `dt` \[s\], which must be finite and positive.
    pub fn fixed(dt: f64) -> Stepping {
        Stepping::Fixed { dt }
    }

    /// Steps whose error in time is estimated to be at most `tolerance`, in \[1e-9, 0.1\]: that of the approach where a force
    /// is given, that of the force where the approach is. It is relative to displacement or force, where these are large, and
    /// else to the greatest of the run, of which small loads, and those that begin from nothing, are a part. Errors of the
    /// pressure at a point may be larger, see [`ErrorBudget::pressure`](crate::contact::ErrorBudget::pressure). The solver is
    /// not asked for more than suits: [`Settings::tolerance`](crate::contact::Settings::tolerance) or 0.03 of `tolerance`,
    /// whichever is greater.
    pub fn adaptive(tolerance: f64) -> Stepping {
        Stepping::Adaptive { tolerance }
    }
}

/// The errors of a step, or the greatest ones of several steps.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct StepErrors {
    /// Estimated error in time, relative.
    pub(super) time: f64,
    /// Estimated error in time of the pressure of a single cell, relative to the mean in contact.
    pub(super) pressure: f64,
    /// Residual of the contact problem.
    pub(super) residual: f64,
}

impl StepErrors {
    fn max(self, other: StepErrors) -> StepErrors {
        StepErrors {
            time: self.time.max(other.time),
            pressure: self.pressure.max(other.pressure),
            residual: self.residual.max(other.residual),
        }
    }
}

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
    /// Greatest estimated errors in time of a step, in all and in a cell, and greatest residual; `None` before the first step.
    worst: Option<StepErrors>,
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

    /// Takes account of the errors of a step, and of the mesh at its end.
    pub(super) fn include(&mut self, errors: StepErrors, mesh: Option<MeshError>) {
        self.worst = Some(self.worst.map_or(errors, |worst| worst.max(errors)));
        self.mesh = match (self.mesh, mesh) {
            (Some(worst), Some(mesh)) => Some(worst.max(mesh)),
            (worst, mesh) => worst.or(mesh),
        };
    }

    /// What is known of the errors so far, with those due to the `mesh` now.
    pub(super) fn error_budget(&self, mesh: Option<MeshError>) -> ErrorBudget {
        ErrorBudget {
            time: self.worst.map(|worst| worst.time),
            pressure: self.worst.map(|worst| worst.pressure),
            mesh,
            max_mesh: self.mesh,
            solver: self.worst.map_or(0.0, |worst| worst.residual),
        }
    }
}

/// Where the error of a run comes from, made by
/// [`Follow::error_budget`](crate::contact::Follow::error_budget). All relative; `None` where nothing was estimated.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Burgers::new(1.0e6, 2.0e6, 0.5e6, 0.5e6)?))
///     .build()?;
/// let load = PiecewiseLinear::new(&[(0.0, Load::force(0.5)), (2.0, Load::force(0.5)), (3.0, Load::force(0.0))])?;
/// let mut run = contact.follow(&load, Stepping::fixed(0.5), 4.0);
/// assert_eq!(run.error_budget().time, None);
/// while run.next_step()?.is_some() {}
/// let budget = run.error_budget();
/// assert!(budget.time > Some(1.0e-3));
/// assert_eq!(budget.mesh, None); // the bodies have parted ...
/// assert!(budget.max_mesh.is_some()); // ... but were in contact before
/// println!("{budget}");
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ErrorBudget {
    /// Greatest error in time estimated for a step: of the approach where a force is given, of the force where a motion is.
    /// Relative to the displacement, or to v = K p; below a part of the greatest so far, to that part. 0 of elastic bodies,
    /// which make no such error; `None` before the first step.
    ///
    /// Of steps chosen by their error it is what they were chosen by, or the error that all steps together have left, as far as a
    /// mean over the contact tells, where that is greater. Steps of given length are estimated by the same, and the
    /// first after a jump or a corner of a force from the material alone. Measured on a sphere and six bodies
    /// (`tests/time/fixed_steps.rs`), the true error is 0.5 to 1.5 times the estimate for forces that jump or grow linearly.
    /// It is up to 4.5 times where a force begins like a power of time, whose course in the first step nothing tells, and down
    /// to 0.05 times under a given motion of bodies that begin to touch, whose first cells are met in part.
    pub time: Option<f64>,
    /// Greatest error in time estimated for a step in a single cell, relative to the mean in contact: what the pressure at a
    /// point, and the greatest pressure, may be off by. It is largest where a body meets cells faster than the steps resolve,
    /// which hardly moves the body. `None` before the first step.
    pub pressure: Option<f64>,
    /// Errors due to the mesh, of the present state; `None` without contact, of a contact that the cells do not resolve, and where
    /// [ranks](crate::parallel) share out the rows.
    pub mesh: Option<MeshError>,
    /// The greatest errors due to the mesh of all states of the run that have an estimate, each of them relative to its own
    /// state: largest where few cells are in contact. `None` if no state has one.
    pub max_mesh: Option<MeshError>,
    /// Greatest residual of the contact problems, of the displacement.
    pub solver: f64,
}

/// One line: `error in time 1.2e-3 (pressure 2.0e-2), mesh: approach 1.0e-3, ...; solver 9.8e-7`.
impl fmt::Display for ErrorBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = |error: Option<f64>| error.map_or("not estimated".into(), |error| format!("{error:.1e}"));
        write!(f, "error in time {} (pressure {}), mesh: ", known(self.time), known(self.pressure))?;
        match self.mesh {
            Some(mesh) => write!(f, "{mesh}")?,
            None => f.write_str("not estimated")?,
        }
        if let Some(greatest) = self.max_mesh {
            write!(f, " (greatest of the run: {greatest})")?;
        }
        write!(f, "; solver {:.1e}", self.solver)
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
