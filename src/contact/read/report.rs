//! The report of a step, and its warnings.

use std::fmt;

use bitflags::bitflags;

use crate::load::Load;
use crate::rounded::{TIME, rounded};

/// The outcome and the cost of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct StepReport {
    /// Time at the end of the step \[s\].
    pub time: f64,
    /// Normal force on all bodies together \[N\].
    pub force: f64,
    /// Rigid-body approach ω of the first body, at the origin \[m\].
    pub approach: f64,
    /// Cells in contact; [`ViscoelasticContact::contact_area`](crate::ViscoelasticContact::contact_area) resolves fractions of a cell.
    /// On elastic states the cells of the state at or below the level, 0 where they were not swept on cells.
    pub contact_cells: usize,
    /// Tilt (α1, α2) of the first body \[rad\].
    pub tilt: [f64; 2],
    /// Length of the step \[s\]; 0 for a jump of the load.
    pub dt: f64,
    /// Estimated error in time of the step, relative: of the approach under a given force, of the force under a given
    /// motion. 0 in jumps, which take no time, and of elastic bodies; `None` where nothing was estimated: in steps over
    /// the bodies ([`Frame::Indenter`](crate::contact::Frame::Indenter)), and where the estimate overflows.
    /// [`ErrorBudget::time`](crate::run::ErrorBudget::time) compares it with true errors.
    pub time_error: Option<f64>,
    /// The quantity of which [`StepReport::time_error`] is the relative error.
    pub estimated: Estimated,
    /// Reasons why the result may be less accurate than expected.
    pub warnings: Warnings,
    /// Greatest slope of the undeformed bodies in contact, where it is too steep for the model ([`Warnings::STEEP`]).
    pub max_slope: Option<f64>,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Iterations by the fall-back solver, which is slower and always descends.
    pub fallback_iterations: usize,
    /// Convolutions with the influence kernel on the computed cells: forward and inverse padded transforms.
    pub convolutions: usize,
    /// Applications of the preconditioner, and where surfaces attract each other of the near field of the kernel, each on an unpadded grid of a
    /// quarter of the size.
    pub preconditioner_applications: usize,
    /// Residual reached, in the measure of [`Settings::tolerance`](crate::contact::Settings::tolerance).
    pub residual: f64,
}

/// The quantity of which an error is estimated: the one that the load leaves free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Estimated {
    /// The approach, under a given force.
    Approach,
    /// The force, under a given approach.
    Force,
    /// The approach or the force, whichever errs more: under springs, and where some bodies have a given force and others a given
    /// approach.
    ApproachOrForce,
}

impl Estimated {
    /// What these loads leave free.
    pub(crate) fn under(loads: &[Load]) -> Estimated {
        let any = |is: fn(&Load) -> bool| loads.iter().any(is);
        match (any(|load| !matches!(load, Load::Approach { .. })), any(|load| !matches!(load, Load::Force { .. }))) {
            (false, true) => Estimated::Force,
            (_, false) => Estimated::Approach,
            (true, true) => Estimated::ApproachOrForce,
        }
    }
}

impl fmt::Display for Estimated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Estimated::Approach => "approach",
            Estimated::Force => "force",
            Estimated::ApproachOrForce => "approach or force",
        })
    }
}

impl StepReport {
    /// The transforms of the step in units of one convolution; a transform without padding counts a quarter.
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
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
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
            Some(error) => write!(f, ", error in time {error:.1e} of the {}", self.estimated)?,
            None => write!(f, ", error in time not estimated")?,
        }
        self.warnings.iter().try_for_each(|warning| write!(f, "; {warning}"))?;
        self.max_slope.map_or(Ok(()), |slope| write!(f, " (the greatest slope is {slope:.3})"))
    }
}

/// The state of one rigid body, see [`ViscoelasticContact::body`](crate::ViscoelasticContact::body).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// let report = contact.step(0.0, Load::force(0.1))?;
    /// assert!(report.warnings.contains(Warnings::FEW_CELLS));
    /// for warning in &report.warnings {
    ///     println!("{warning}");
    /// }
    /// # Ok::<(), Error>(())
    /// ```
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
        /// The contact modulus at once, 1/C(0), is below 10 Pa or above 1e13 Pa, which no solid has: moduli are given in another
        /// unit than Pa, or compliances in another one than 1/Pa.
        const MODULUS = 1 << 9;
        /// The undeformed bodies are steeper than 0.5 somewhere in contact ([`StepReport::max_slope`](crate::contact::StepReport::max_slope)):
        /// slopes and strains are not small, and half-spaces are no model of the bodies. Heights in µm that are read as metres are that steep.
        /// A slope is the lesser of the slopes to the neighbours on each side, so that a step between two cells does not count.
        const STEEP = 1 << 10;
        /// The zone at the edge of the contact in which the attraction acts is less than 4 cells long at the compliance that the bodies have
        /// reached: the force of a slow pull-off errs by a percent or more. A fast pull finds a stiffer body, and a longer zone. Refine the mesh,
        /// or take an attraction of longer range.
        const COARSE_ZONE = 1 << 11;
        /// Surfaces that attract each other snapped together or apart within the step, or nearly so: its end is known, not the moment within it
        /// ([`PassReport::response`](crate::contact::PassReport::response)); [`PassReport::released`](crate::contact::PassReport::released) is the
        /// energy that was lost. Adaptive steps are shortened until the moment no longer matters.
        const JUMP = 1 << 12;
        /// The undeformed bodies are flatter than a slope of 1e-6 everywhere on the grid, a nanometre over a millimetre, but not flat:
        /// sides of a map or a grid in µm that are read as metres are that long for their heights.
        const FLAT = 1 << 13;
    }
}

impl IntoIterator for &Warnings {
    type Item = Warnings;
    type IntoIter = bitflags::iter::Iter<Warnings>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// The message of each warning.
const MESSAGES: [(Warnings, &str); 14] = [
    (Warnings::NEAR_EDGE, "contact is within two cells of the edge of the grid: enlarge the grid"),
    (Warnings::FEW_CELLS, "contact is fewer than 8 cells across, or fewer than 50 in all: refine the mesh"),
    (Warnings::EXTRAPOLATED, "the material is extrapolated beyond its data"),
    (Warnings::FASTER_THAN_MATERIAL, "the step is shorter than the material is known for: that counts as elastic"),
    (Warnings::NEAR_END_OF_MATERIAL, "one more such step would look beyond what is known of the material"),
    (Warnings::RINGS, "the time rule rings at steps of this length: take shorter ones, or another rule"),
    (Warnings::FALL_BACK, "the solver needed its slow fall-back: take smaller steps if this happens often"),
    (Warnings::UNCERTAIN_MATERIAL, "the table of the material leaves its creep uncertain: see its fit report"),
    (Warnings::ROUNDING, "the pressure is so small that the rounding of the gap makes it uncertain"),
    (Warnings::MODULUS, "no solid has such a modulus: moduli are in Pa, compliances in 1/Pa"),
    (
        Warnings::STEEP,
        "the bodies are steeper than 0.5 in contact, too steep for small strains: heights and lengths are in m",
    ),
    (Warnings::FLAT, "the bodies are flatter than 1e-6 everywhere, as no real ones are: heights and lengths are in m"),
    (
        Warnings::COARSE_ZONE,
        "the attraction acts over fewer than 4 cells at the edge: refine the mesh, or lengthen its range",
    ),
    (Warnings::JUMP, "surfaces snapped together or apart in this step"),
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

    /// Results, statistics and specifications come back from a file; values out of range do not.
    #[cfg(feature = "checkpoint")]
    #[test]
    fn serialised_results_come_back() {
        use std::fmt::Debug;

        use crate::prelude::*;
        use crate::rheology::{CreepSpectrum, RelaxationSpectrum};

        fn there_and_back<T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + Debug>(value: &T) {
            assert_eq!(postcard::from_bytes::<T>(&postcard::to_stdvec(value).unwrap()).unwrap(), *value);
        }
        let rubber = PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap().series(1e-3..=1e3, 1e-3).unwrap();
        let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3).unwrap())
            .geometry(&Sphere::new(10.0e-3).unwrap())
            .material(Material::incompressible(rubber.clone()))
            .build()
            .unwrap();
        contact.step(0.0, Load::force(0.1)).unwrap();
        let report = contact.step(0.1, Load::force(0.1)).unwrap();
        assert!(report.warnings.contains(Warnings::FEW_CELLS));
        there_and_back(&report);
        there_and_back(&contact.body(0).unwrap());
        there_and_back(&contact.pressure_distribution(7).unwrap());
        there_and_back(&contact.patches().unwrap().all);
        there_and_back(rubber.report());
        there_and_back(&Accuracy::FINE);
        there_and_back(&Grid::new([3, 7], [1.0e-3, 0.3]).unwrap());
        let wrong = postcard::to_stdvec(&([3_usize, 0], [1.0e-3, 0.3])).unwrap();
        assert!(postcard::from_bytes::<Grid>(&wrong).is_err());
        let body = Material::incompressible(Elastic::new(1.0e6).unwrap());
        let line: String = postcard::from_bytes(&postcard::to_stdvec(&body).unwrap()).unwrap();
        assert_eq!(line, body.to_string());
        let load = StepLoad::new(Load::force(0.5)).unwrap();
        let sphere = Sphere::new(10.0e-3).unwrap();
        let plan = Plan::builder(&sphere, &body, &load, 1.0).accuracy(Accuracy::COARSE).build().unwrap();
        // the builder is left out: stepping comes first
        let figures = postcard::to_stdvec(&plan).unwrap();
        let (stepping, rest) = postcard::take_from_bytes::<Stepping>(&figures).unwrap();
        assert_eq!((stepping, postcard::take_from_bytes::<Grid>(rest).unwrap().0), (plan.stepping, plan.grid));
        let creep = CreepSpectrum::new(1.0, 0.5, &[(2.0, 3.0)]).unwrap();
        there_and_back(&creep);
        there_and_back(&creep.relaxation());
        let bytes = postcard::to_stdvec(&(-1.0, 0.0, [(1.0, 1.0)].to_vec())).unwrap();
        assert!(postcard::from_bytes::<CreepSpectrum>(&bytes).is_err());
        assert!(postcard::from_bytes::<RelaxationSpectrum>(&bytes).is_err());
        assert!(postcard::from_bytes::<Accuracy>(&postcard::to_stdvec(&0.9).unwrap()).is_err());
    }
}
