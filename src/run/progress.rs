//! How a run chooses its steps, how far it has come, the error so far, and when it is saved.

use std::fmt;

use crate::error::{Result, finite, positive, within};
use crate::observe::MeshError;
use crate::rounded::rounded;
use crate::run::run_scale::RunScale;
use crate::run::step_control::StepControl;

/// The rule for the length of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stepping {
    /// Equal steps, counted from the start of the run. Steps are shortened to end at corners of the load.
    Fixed {
        /// Length of a step \[s\].
        dt: f64,
    },
    /// Steps as long as the error in time allows: short after jumps and corners of the load, long while the state
    /// changes slowly.
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

    /// Steps whose estimated error in time is at most `tolerance`, in \[1e-9, 0.1\]: the error of the approach under a
    /// given force, the error of the force under a given approach. It is relative to the displacement or force; for
    /// small values it is relative to a fraction of the greatest of the run. Errors of the pressure at a point may be
    /// larger, see [`ErrorBudget::pressure`](crate::run::ErrorBudget::pressure). The tolerance of the solver is
    /// [`Settings::tolerance`](crate::contact::Settings::tolerance) or 0.03 of `tolerance`, whichever is greater.
    pub fn adaptive(tolerance: f64) -> Stepping {
        Stepping::Adaptive { tolerance }
    }

    /// Accepts steps and tolerances in range, and a run that does not end before its `start`.
    pub(crate) fn validate_run(&self, start: f64, until: f64) -> Result<()> {
        match *self {
            Stepping::Fixed { dt } => positive("fixed step", dt)?,
            Stepping::Adaptive { tolerance } => {
                let inside = (1e-9..=0.1).contains(&tolerance);
                within("tolerance of the adaptive steps", tolerance, inside, "in [1e-9, 0.1]")?
            }
        };
        finite("end of the run", until)?;
        within("end of the run", until, until >= start, "at or after the time of the contact").map(drop)
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

/// How far a run has come, and the state of its step control.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Progress {
    pub(super) start: f64,
    /// Time of the contact that belongs to this progress.
    pub(crate) now: f64,
    /// Number of equal steps taken, and their length, 0 for adaptive steps.
    pub(super) steps: u64,
    dt: f64,
    pub(super) control: Option<StepControl>,
    /// Greatest loads and displacements of a run by equal steps.
    pub(super) scale: Option<RunScale>,
    /// Greatest estimated errors in time of a step, in all and in a cell, and greatest residual; `None` before the first step.
    worst: Option<StepErrors>,
    /// Greatest estimated errors due to the mesh, of the states in contact.
    mesh: Option<MeshError>,
}

#[cfg(feature = "checkpoint")]
impl crate::contact::checkpoint::SavedRun for Progress {
    fn fits(&self) -> bool {
        let scale_fits = self.scale.as_ref().is_none_or(RunScale::fits);
        scale_fits
            && match &self.control {
                Some(control) => control.fits(),
                None => (self.now - self.start - self.steps as f64 * self.dt).abs() <= 2.0 * self.dt,
            }
    }
}

impl Progress {
    pub(super) fn begin(now: f64, stepping: Stepping) -> Progress {
        let (control, dt) = match stepping {
            Stepping::Fixed { dt } => (None, dt),
            Stepping::Adaptive { tolerance } => (Some(StepControl::new(tolerance)), 0.0),
        };
        Progress { start: now, now, steps: 0, dt, control, scale: None, worst: None, mesh: None }
    }

    /// Whether a run of this progress began like `begun`.
    pub(super) fn continues(&self, begun: &Progress) -> bool {
        let tolerance = |progress: &Progress| progress.control.as_ref().map(|control| control.tolerance);
        self.now == begun.now && self.dt == begun.dt && tolerance(self) == tolerance(begun)
    }

    /// The end of the next fixed step.
    pub(super) fn end_of_step(&self, dt: f64) -> f64 {
        self.start + (self.steps + 1) as f64 * dt
    }

    /// Includes the errors of a step, and the errors of the mesh at its end.
    pub(super) fn include(&mut self, errors: StepErrors, mesh: Option<MeshError>) {
        self.worst = Some(self.worst.map_or(errors, |worst| worst.max(errors)));
        self.mesh = match (self.mesh, mesh) {
            (Some(worst), Some(mesh)) => Some(worst.max(mesh)),
            (worst, mesh) => worst.or(mesh),
        };
    }

    /// The errors so far; `mesh` is the error due to the mesh of the present state.
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

/// How far a run has come, from [`Run::progress`](crate::run::Run::progress). No share of the run is a share of its steps, which
/// nobody knows before: take the one along which the steps are spread.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Zener::relaxing(1.0e6, 0.5e6, 1.0)?))
///     .build()?;
/// let load = StepLoad::new(Load::force(0.5))?;
/// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-2), 1.0e4);
/// while run.next_step()?.is_some() {
///     println!("{:3.0} %: {}", 100.0 * run.progress().share_of_decades(), run.progress());
/// }
/// assert_eq!(run.progress().share_of_decades(), 1.0);
/// assert_eq!(run.progress().share_of_time(), 1.0);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RunProgress {
    /// Steps taken, those before a resumption not counted.
    pub steps: u64,
    /// Time at the start of the run \[s\].
    pub start: f64,
    /// Time of the contact \[s\].
    pub time: f64,
    /// Time at the end of the run \[s\].
    pub until: f64,
    /// Length of the first step that took time \[s\]; 0 before.
    pub first_step: f64,
}

impl RunProgress {
    /// The part of the time that is over, 0 to 1: for steps of given length, and for loads that keep changing.
    pub fn share_of_time(&self) -> f64 {
        if self.until > self.start {
            ((self.time - self.start) / (self.until - self.start)).clamp(0.0, 1.0)
        } else {
            1.0
        }
    }

    /// The part of the decades of time that is over, 0 to 1: ln(1 + t/δ) over its value at the end, t counted from the start and δ
    /// the first step. For adaptive steps under a load that is held, which grow in proportion to the time since it was applied.
    pub fn share_of_decades(&self) -> f64 {
        let decades = |time: f64| ((time - self.start) / self.first_step).ln_1p();
        if self.first_step > 0.0 && self.until > self.start {
            (decades(self.time) / decades(self.until)).clamp(0.0, 1.0)
        } else {
            self.share_of_time()
        }
    }
}

/// One line: `12 steps, t = 0.5 s of 10 s`.
impl fmt::Display for RunProgress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let RunProgress { steps, time, until, .. } = *self;
        write!(f, "{steps} steps, t = {} s of {} s", rounded(time, 4), rounded(until, 4))
    }
}

/// Where the error of a run comes from, made by [`Run::error_budget`](crate::run::Run::error_budget). All
/// errors are relative; `None` where nothing was estimated.
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
    /// Greatest estimated error in time of a step: of the approach under a given force, of the force under a given
    /// motion. It is relative to the displacement, or to v = K p, or to a fraction of the greatest so far, whichever is
    /// greater. 0 for elastic bodies, which have no error in time; `None` before the first step.
    ///
    /// For adaptive steps it is the error that chose their length, or, if greater, the error left by all steps
    /// together, estimated by a mean over the contact. The estimate of steps of given length is the same; for the first
    /// step after a jump or a corner of a force it follows from the material alone. Measured on a sphere and six bodies
    /// (`tests/time/fixed_steps.rs`), the true error is 0.5 to 1.5 times the estimate for forces that jump or grow
    /// linearly. It is up to 4.5 times the estimate where a force begins like a power of time, since the estimate does
    /// not include its course within the first step. It is down to 0.05 times under a given motion of bodies that begin
    /// to touch, when the first cells touch in part.
    pub time: Option<f64>,
    /// Greatest estimated error in time of a step in a single cell, relative to the mean in contact. It bounds the
    /// error of the pressure at a point, and of the greatest pressure. It is largest where a body meets cells faster
    /// than the steps resolve, which hardly changes its approach. Where a given approach is to return to a surface that
    /// recovers, or a force jumps up, it includes the error of the cells that the body may meet. `None` before the first
    /// step.
    pub pressure: Option<f64>,
    /// Errors due to the mesh in the present state; `None` without contact, for a contact that the cells do not
    /// resolve, and where [ranks](crate::parallel) share out the rows.
    pub mesh: Option<MeshError>,
    /// Greatest errors due to the mesh over the states of the run, each relative to its state. They are largest where
    /// few cells are in contact. `None` if no state has an estimate.
    pub max_mesh: Option<MeshError>,
    /// Greatest residual of the contact problems, relative to the displacement.
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
