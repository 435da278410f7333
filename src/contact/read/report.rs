//! The report of a step, and its warnings.

use std::fmt;

use bitflags::bitflags;

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
    /// Total area of the cells in contact \[m²\];
    /// [`ViscoelasticContact::contact_area`](crate::ViscoelasticContact::contact_area) resolves fractions of a cell.
    pub area: f64,
    /// Cells in contact.
    pub contact_cells: usize,
    /// Tilt (α1, α2) of the first body \[rad\].
    pub tilt: [f64; 2],
    /// Length of the step \[s\]; 0 for a jump of the load.
    pub dt: f64,
    /// Estimated error in time of the step, relative: of the approach under a given force, of the force under a given
    /// motion. 0 in jumps, which take no time, and of elastic bodies; `None` where nothing was estimated: in steps over
    /// the bodies ([`Frame::Indenter`](crate::contact::Frame::Indenter)), and where the estimate overflows.
    /// [`ErrorBudget::time`](crate::contact::ErrorBudget::time) compares it with true errors.
    pub time_error: Option<f64>,
    /// Reasons why the result may be less accurate than expected.
    pub warnings: Warnings,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Iterations by the fall-back solver, which is slower and always descends.
    pub fallback_iterations: usize,
    /// Convolutions with the influence kernel on the computed cells: forward and inverse padded transforms.
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

/// One line for logs: the result of the step, its cost, and its warnings.
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
        // given forces are exact to rounding; times are sums of steps
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

bitflags! {
    /// Reasons why the result of a step may be less accurate than expected: none, one or several.
    ///
    /// ```
    /// use viscocontact::contact::Warnings;
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
    ///     .build()?;
    /// let report = contact.step(0.0, Load::force(0.1))?;
    /// assert!(report.warnings.contains(Warnings::FEW_CELLS));
    /// for warning in report.warnings {
    ///     println!("{warning}");
    /// }
    /// # Ok::<(), Error>(())
    /// ```
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub struct Warnings: u16 {
        /// Contact is within two cells of an edge of the grid beyond which the bodies extend. Under a slightly greater load
        /// a step fails with [`StepError::ContactAtEdge`](crate::contact::StepError::ContactAtEdge). Enlarge the grid. Only with
        /// [`Edge::Refuse`](crate::contact::Edge::Refuse).
        const NEAR_EDGE = 1 << 0;
        /// The contact is fewer than 8 cells across, or, unless it is a line, has fewer than 50. Refine the mesh;
        /// [`ViscoelasticContact::mesh_error`](crate::ViscoelasticContact::mesh_error) estimates the error from 5 on. A sphere's approach,
        /// greatest pressure and contact area err by up to 1.3 %, 4 % and 8 % with contacts of 4 cells across, by 0.5 %, 1.5 % and 2.5 % with 8.
        const FEW_CELLS = 1 << 1;
        /// The loading time exceeds the measured range of the material: a table is extrapolated beyond its data
        /// ([`CreepSeries::extrapolated`](crate::rheology::CreepSeries::extrapolated)).
        const EXTRAPOLATED = 1 << 2;
        /// The step is shorter than the times for which the material is known: creep within it counts as elastic.
        const FASTER_THAN_MATERIAL = 1 << 3;
        /// One more step of this length would exceed the range in which the material is known, and fail with
        /// [`StepError::BeyondMaterial`](crate::contact::StepError::BeyondMaterial).
        const NEAR_END_OF_MATERIAL = 1 << 4;
        /// The time rule oscillates at steps of this length. The rectangle rule does where the bodies creep in a step by more than
        /// they yield at once, C(Δ) > 2 C(0), which is Δ > τ on a Maxwell body; on fluids it diverges further on.
        const RINGS = 1 << 5;
        /// The solver stagnated, and its slow fall-back took over for a while:
        /// [`StepReport::fallback_iterations`](crate::contact::StepReport::fallback_iterations). The result meets the
        /// tolerance. If this happens often, take smaller steps or a larger tolerance.
        const FALL_BACK = 1 << 6;
        /// The table of the material does not determine its creep well, or is inconsistent with a linear body: see
        /// [`FitReport::warning`](crate::rheology::FitReport::warning) of each of the
        /// [`Material::fit_reports`](crate::rheology::Material::fit_reports).
        const UNCERTAIN_MATERIAL = 1 << 7;
        /// The gap is a sum of numbers whose rounding exceeds [`Settings::tolerance`](crate::contact::Settings::tolerance)
        /// times the displacement due to the pressure, as where little pressure is left on bodies that were pressed much
        /// harder before: the error of pressure and force exceeds the residual.
        const ROUNDING = 1 << 8;
    }
}

/// The message of each warning.
const MESSAGES: [(Warnings, &str); 9] = [
    (Warnings::NEAR_EDGE, "contact is within two cells of the edge of the grid: enlarge the grid"),
    (Warnings::FEW_CELLS, "contact is fewer than 8 cells across, or fewer than 50 in all: refine the mesh"),
    (Warnings::EXTRAPOLATED, "the material is extrapolated beyond its data"),
    (Warnings::FASTER_THAN_MATERIAL, "the step is shorter than the material is known for: that counts as elastic"),
    (Warnings::NEAR_END_OF_MATERIAL, "one more such step would look beyond what is known of the material"),
    (Warnings::RINGS, "the time rule rings at steps of this length: take shorter ones, or another rule"),
    (Warnings::FALL_BACK, "the solver needed its slow fall-back: take smaller steps if this happens often"),
    (Warnings::UNCERTAIN_MATERIAL, "the table of the material leaves its creep uncertain: see its fit report"),
    (Warnings::ROUNDING, "the pressure is so small that the rounding of the gap makes it uncertain"),
];

/// The warnings, separated by semicolons; nothing if there are none.
impl fmt::Display for Warnings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for (_, message) in MESSAGES.iter().filter(|(warning, _)| self.contains(*warning)) {
            write!(f, "{separator}{message}")?;
            separator = "; ";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_warning_has_a_message() {
        assert!(Warnings::empty().to_string().is_empty());
        assert!(Warnings::all().iter().all(|warning| !warning.to_string().is_empty()));
        assert_eq!(Warnings::all().to_string().split("; ").count(), MESSAGES.len());
    }
}
