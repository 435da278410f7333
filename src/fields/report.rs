//! The report of a step.

use std::fmt;

use crate::equilibrium::{Figures, Warnings};
use crate::fields::Fields;
use crate::load::Load;
use crate::rounded::{TIME, rounded};
use crate::solver::Solution;

/// The outcome and the cost of one step; of an [`ElasticContact`](crate::elastic::ElasticContact), which has no time,
/// as of a jump at time 0.
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
    /// Cells in contact; [`ViscoelasticContact::contact_area`](crate::ViscoelasticContact::contact_area) resolves
    /// fractions of a cell. On elastic states the cells of the state at or below the level, 0 where they were not
    /// swept on cells.
    pub contact_cells: usize,
    /// Tilt (α1, α2) of the first body \[rad\].
    pub tilt: [f64; 2],
    /// Length of the step \[s\]; 0 for a jump of the load.
    pub dt: f64,
    /// Estimated error in time of the step, relative: of the approach under a given force, of the force under a given
    /// motion. 0 in jumps, which take no time, and of elastic bodies; `None` where nothing was estimated: in steps over
    /// the bodies ([`Frame::Indenter`](crate::contact::Frame::Indenter)), in steps on elastic states that are not
    /// adaptive, and where the estimate overflows.
    /// [`ErrorBudget::time`](crate::run::ErrorBudget::time) compares it with true errors.
    pub time_error: Option<f64>,
    /// The quantity of which [`StepReport::time_error`] is the relative error.
    pub estimated: Estimated,
    /// Reasons why the result may be less accurate than expected.
    pub warnings: Warnings,
    /// The numbers of the warnings.
    pub figures: Figures,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Iterations by the fall-back solver, which is slower and always descends.
    pub fallback_iterations: usize,
    /// Convolutions with the influence kernel on the computed cells: forward and inverse padded transforms.
    pub convolutions: usize,
    /// Applications of the preconditioner, and where surfaces attract each other of the near field of the kernel,
    /// each on an unpadded grid of a quarter of the size.
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
    /// The approach or the force, whichever errs more: under springs, and where some bodies have a given force and
    /// others a given approach.
    ApproachOrForce,
}

impl Estimated {
    /// What these loads leave free.
    pub(crate) fn under(loads: &[Load]) -> Estimated {
        let any = |is: fn(&Load) -> bool| loads.iter().any(is);
        match (any(|load| !matches!(load, Load::Approach { .. })), any(|load| !load.is_force())) {
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
    /// Of a jump at time 0 to what these fields hold, without warnings.
    pub(crate) fn solved(fields: Fields<'_>) -> StepReport {
        let Solution { counts, residual, .. } = &fields.held.current.solution;
        StepReport {
            time: 0.0,
            force: fields.force(),
            approach: fields.approach(),
            contact_cells: fields.contact_cells(),
            tilt: fields.tilt(),
            dt: 0.0,
            time_error: Some(0.0),
            estimated: Estimated::under(&fields.held.loads),
            warnings: Warnings::default(),
            figures: Figures::default(),
            iterations: counts.iterations,
            fallback_iterations: counts.fallback_iterations,
            convolutions: counts.convolutions,
            preconditioner_applications: counts.preconditioner_applications,
            residual: *residual,
        }
    }

    /// The transforms of the step in units of one convolution; a transform without padding counts a quarter.
    pub fn convolution_equivalents(&self) -> f64 {
        self.convolutions as f64 + 0.25 * self.preconditioner_applications as f64
    }

    /// What each warning says, with its number: one line each.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(64, 4.0e-3)?)
    ///     .geometry(&Cone::new(0.9)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// let report = contact.step(0.0, Load::approach(1.0e-3))?;
    /// let messages: Vec<_> = report.messages().collect();
    /// assert!(messages[0].starts_with("the bodies are steeper than 0.5"), "{messages:?}");
    /// assert!(messages[0].ends_with("(maximum slope 0.8989)"), "{messages:?}");
    /// # Ok::<(), Error>(())
    /// ```
    pub fn messages(&self) -> impl Iterator<Item = String> + '_ {
        self.figures.messages(self.warnings, self.time_error)
    }

    /// Warns at the end of a run that never brought the bodies into contact; upright they touch at the approach
    /// `touch`.
    pub(crate) fn warn_of_no_contact(&mut self, touch: f64) {
        if self.estimated != Estimated::Approach {
            self.warnings |= Warnings::NO_CONTACT;
            self.figures.touch = Some(touch);
        }
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
        self.messages().try_for_each(|message| write!(f, "; {message}"))
    }
}

#[cfg(test)]
mod tests {
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
        there_and_back(&contact.fields().body(0).unwrap());
        there_and_back(&contact.fields().patches().unwrap().all);
        there_and_back(rubber.report());
        there_and_back(&Grid::new([3, 7], [1.0e-3, 0.3]).unwrap());
        let wrong = postcard::to_stdvec(&([3_usize, 0], [1.0e-3, 0.3])).unwrap();
        assert!(postcard::from_bytes::<Grid>(&wrong).is_err());
        let creep = CreepSpectrum::new(1.0, 0.5, &[(2.0, 3.0)]).unwrap();
        there_and_back(&creep);
        there_and_back(&creep.relaxation());
        let bytes = postcard::to_stdvec(&(-1.0, 0.0, [(1.0, 1.0)].to_vec())).unwrap();
        assert!(postcard::from_bytes::<CreepSpectrum>(&bytes).is_err());
        assert!(postcard::from_bytes::<RelaxationSpectrum>(&bytes).is_err());
    }
}
