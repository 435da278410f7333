//! Reports of steps.

use std::fmt;

use crate::contact::read::warning::Warnings;
use crate::rounded::{TIME, rounded};

/// The outcome and the cost of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StepReport {
    /// Time at the end of the step \[s\].
    pub time: f64,
    /// Normal force on all bodies together \[N\].
    pub force: f64,
    /// Rigid-body approach ω of the first body, at the origin \[m\].
    pub approach: f64,
    /// Area of the cells in contact \[m²\], which costs nothing;
    /// [`ViscoelasticContact::contact_area`](crate::ViscoelasticContact::contact_area) resolves fractions of a cell.
    pub area: f64,
    /// Cells in contact.
    pub contact_cells: usize,
    /// Tilt (α1, α2) of the first body \[rad\].
    pub tilt: [f64; 2],
    /// Length of the step \[s\]; 0 for a jump of the load.
    pub dt: f64,
    /// Estimated error in time of the step, relative: of the approach under a given force, of the force under a given motion.
    /// 0 in jumps, which take no time, and of elastic bodies; `None` where nothing was estimated: in steps over the bodies
    /// ([`Frame::Indenter`](crate::contact::Frame::Indenter)), and where the estimate overflows. [`ErrorBudget::time`](crate::contact::ErrorBudget::time) says
    /// how far it can be trusted.
    pub time_error: Option<f64>,
    /// Reasons why the result may be less accurate than expected; mostly none.
    pub warnings: Warnings,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Those of them taken by the fall-back, which is slower and always descends.
    pub fallback_iterations: usize,
    /// Convolutions with the influence kernel on the cells that are computed: forward and inverse padded transforms.
    pub convolutions: usize,
    /// Applications of the preconditioner, each on an unpadded grid of a quarter of the size.
    pub preconditioner_applications: usize,
    /// Residual reached, in the measure of [`Settings::tolerance`](crate::contact::Settings::tolerance).
    pub residual: f64,
}

impl StepReport {
    /// The transforms of the step in units of one convolution; a preconditioner application counts a quarter.
    pub fn convolution_equivalents(&self) -> f64 {
        self.convolutions as f64 + 0.25 * self.preconditioner_applications as f64
    }

    /// Emits the event of an accepted step, with the feature `tracing`.
    #[inline]
    pub(crate) fn emit(&self) {
        #[cfg(feature = "tracing")]
        {
            let StepReport { time, dt, iterations, residual, contact_cells, approach, force, warnings, .. } = *self;
            tracing::debug!(time, dt, iterations, residual, contact_cells, approach, force, %warnings, "step accepted");
        }
    }
}

/// A line for logs: the result of the step, its cost, and its warnings.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(64, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// let report = contact.step(0.0, Load::force(1.0))?;
/// assert!(report.to_string().starts_with("t = 0 s: force 1 N, approach 1.52"), "{report}");
/// # Ok::<(), Error>(())
/// ```
impl fmt::Display for StepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let StepReport { time, force, approach, contact_cells, residual, .. } = *self;
        // forces are met to rounding, times are sums of steps
        let (time, force) = (rounded(time, TIME), rounded(force, 5));
        write!(f, "t = {time} s: force {force} N, approach {approach:.4e} m, {contact_cells} cells in contact; ")?;
        write!(f, "{} convolutions, residual {residual:.1e}", self.convolution_equivalents())?;
        match self.time_error {
            Some(0.0) => {}
            Some(error) => write!(f, ", error in time {error:.1e}")?,
            None => write!(f, ", error in time not estimated")?,
        }
        self.warnings.iter().try_for_each(|warning| write!(f, "; {warning}"))
    }
}

/// The state of one rigid body, see [`ViscoelasticContact::body`](crate::ViscoelasticContact::body).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BodyState {
    /// Approach ω at the origin of the grid \[m\]: the body lowers the surface by ω + α1 x1 + α2 x2.
    pub approach: f64,
    /// Tilt (α1, α2) \[rad\].
    pub tilt: [f64; 2],
    /// Normal force \[N\].
    pub force: f64,
    /// Moments of the pressure about the origin, \[∬ p x1, ∬ p x2\] \[N·m\].
    pub moment: [f64; 2],
    /// Cells in contact.
    pub contact_cells: usize,
}
