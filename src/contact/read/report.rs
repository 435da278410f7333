//! The report of a step, and its warnings.

use std::fmt;

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

/// A reason why the result of a step may be less accurate than expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Warning {
    /// Contact is within two cells of an edge of the grid beyond which the bodies extend. Under a slightly greater load
    /// a step fails with [`Error::ContactAtEdge`](crate::Error::ContactAtEdge). Enlarge the grid. Only with
    /// [`Edge::Refuse`](crate::contact::Edge::Refuse).
    NearEdge,
    /// The contact is fewer than 8 cells across, or, unless it is a line, has fewer than 50. Refine the mesh;
    /// [`ViscoelasticContact::mesh_error`](crate::ViscoelasticContact::mesh_error) estimates the error from 5 on. A sphere's approach,
    /// greatest pressure and contact area err by up to 1.3 %, 4 % and 8 % with contacts of 4 cells across, by 0.5 %, 1.5 % and 2.5 % with 8.
    FewCells,
    /// The loading time exceeds the measured range of the material: a table is extrapolated beyond its data
    /// ([`CreepSeries::extrapolated`](crate::rheology::CreepSeries::extrapolated)).
    Extrapolated,
    /// The step is shorter than the times for which the material is known: creep within it counts as elastic.
    FasterThanMaterial,
    /// One more step of this length would exceed the range in which the material is known, and fail with
    /// [`Error::BeyondMaterial`](crate::Error::BeyondMaterial).
    NearEndOfMaterial,
    /// The time rule oscillates at steps of this length. The rectangle rule does where a step lets the bodies creep by more than
    /// they yield at once, C(Δ) > 2 C(0), which is Δ > τ on a Maxwell body; on fluids it diverges further on.
    Rings,
    /// The solver stagnated, and its slow fall-back took over for a while:
    /// [`StepReport::fallback_iterations`](crate::contact::StepReport::fallback_iterations). The result meets the
    /// tolerance. If this happens often, take smaller steps or a larger tolerance.
    FallBack,
    /// The table of the material does not determine its creep well, or is inconsistent with a linear body: see
    /// [`FitReport::warning`](crate::rheology::FitReport::warning) of each of the
    /// [`Material::fit_reports`](crate::rheology::Material::fit_reports).
    UncertainMaterial,
    /// The gap is a sum of numbers whose rounding exceeds [`Settings::tolerance`](crate::contact::Settings::tolerance)
    /// times the displacement due to the pressure, as where little pressure is left on bodies that were pressed much
    /// harder before: the error of pressure and force exceeds the residual.
    Rounding,
}

impl Warning {
    const ALL: [Warning; 9] = [
        Warning::NearEdge,
        Warning::FewCells,
        Warning::Extrapolated,
        Warning::FasterThanMaterial,
        Warning::NearEndOfMaterial,
        Warning::Rings,
        Warning::FallBack,
        Warning::UncertainMaterial,
        Warning::Rounding,
    ];

    fn bit(self) -> u16 {
        1 << self as u16
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Warning::NearEdge => "contact is within two cells of the edge of the grid: enlarge the grid",
            Warning::FewCells => "contact is fewer than 8 cells across, or fewer than 50 in all: refine the mesh",
            Warning::Extrapolated => "the material is extrapolated beyond its data",
            Warning::FasterThanMaterial => "the step is shorter than the material is known for: that counts as elastic",
            Warning::NearEndOfMaterial => "one more such step would look beyond what is known of the material",
            Warning::Rings => "the time rule rings at steps of this length: take shorter ones, or another rule",
            Warning::FallBack => "the solver needed its slow fall-back: take smaller steps if this happens often",
            Warning::Rounding => "the pressure is so small that the rounding of the gap makes it uncertain",
            Warning::UncertainMaterial => "the table of the material leaves its creep uncertain: see its fit report",
        })
    }
}

/// The warnings of a step, none, one or several. Stored as a bit set; no allocation.
///
/// ```
/// use viscocontact::contact::Warning;
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// let report = contact.step(0.0, Load::force(0.1))?;
/// assert!(report.warnings.contains(Warning::FewCells));
/// for warning in report.warnings {
///     println!("{warning}");
/// }
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Warnings {
    bits: u16,
}

impl Warnings {
    /// This set, and `warning` if it `applies`.
    #[must_use]
    pub(crate) fn with(self, warning: Warning, applies: bool) -> Warnings {
        Warnings { bits: self.bits | if applies { warning.bit() } else { 0 } }
    }

    /// Whether there is no warning.
    pub fn is_empty(self) -> bool {
        self.bits == 0
    }

    /// The number of warnings.
    pub fn len(self) -> usize {
        self.bits.count_ones() as usize
    }

    /// Whether `warning` is in the set.
    pub fn contains(self, warning: Warning) -> bool {
        self.bits & warning.bit() != 0
    }

    /// The warnings of the set, in the order of [`Warning`].
    pub fn iter(self) -> impl Iterator<Item = Warning> {
        Warning::ALL.into_iter().filter(move |&warning| self.contains(warning))
    }

    /// The union of two sets, such as the warnings of two steps.
    #[must_use]
    pub fn union(self, other: Warnings) -> Warnings {
        Warnings { bits: self.bits | other.bits }
    }
}

impl FromIterator<Warning> for Warnings {
    fn from_iter<I: IntoIterator<Item = Warning>>(warnings: I) -> Warnings {
        warnings.into_iter().fold(Warnings::default(), |set, warning| set.with(warning, true))
    }
}

impl IntoIterator for Warnings {
    type Item = Warning;
    type IntoIter = std::iter::Flatten<std::array::IntoIter<Option<Warning>, 9>>;

    fn into_iter(self) -> Self::IntoIter {
        Warning::ALL.map(|warning| self.contains(warning).then_some(warning)).into_iter().flatten()
    }
}

impl fmt::Debug for Warnings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.iter()).finish()
    }
}

/// The warnings, separated by semicolons; nothing if there are none.
impl fmt::Display for Warnings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, warning) in self.iter().enumerate() {
            if k > 0 {
                f.write_str("; ")?;
            }
            warning.fmt(f)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_what_was_put_into_it() {
        let none = Warnings::default();
        assert!(none.is_empty() && none.to_string().is_empty() && format!("{none:?}") == "{}");
        let mut all = none;
        for (k, warning) in Warning::ALL.into_iter().enumerate() {
            assert!(!all.contains(warning) && !warning.to_string().is_empty());
            all = all.with(warning, false).with(warning, true).with(warning, true);
            assert!(all.contains(warning) && all.len() == k + 1);
        }
        assert_eq!(all.into_iter().collect::<Vec<_>>(), Warning::ALL);
        assert_eq!(all.to_string().split("; ").count(), Warning::ALL.len());
        let two = none.with(Warning::Rings, true).union(none.with(Warning::NearEdge, true));
        assert_eq!(format!("{two:?}"), "{NearEdge, Rings}");
    }
}
