//! Limits of the model and of a material, beyond which a step warns.

use crate::equilibrium::{Warnings, modulus_of_no_solid};
use crate::error::{Error, Result, StepError};
use crate::rheology::{FitWarning, Material, is_known};

/// A step of a greater error in time is too long.
pub(crate) const LONG_STEP: f64 = 0.05;
/// What a material is known for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    pub(crate) known_until: f64,
    measured: [f64; 2],
    is_uncertain: bool,
    /// The contact modulus at once, if no solid has it \[Pa\].
    pub(crate) modulus: Option<f64>,
}

impl Limits {
    pub(crate) fn of(material: &Material) -> Limits {
        let modulus = modulus_of_no_solid(material.contact_compliance(0.0));
        // of a table that begins late only shorter steps are uncertain
        let is_doubt = |warning| !matches!(warning, FitWarning::BeginsLate { .. });
        let is_uncertain = material.fit_reports().any(|report| report.warning().is_some_and(is_doubt));
        Limits { known_until: material.known_until(), measured: material.measured(), is_uncertain, modulus }
    }

    /// Rejects a step to a `time` at which bodies that were ever `touched` have a loading time, their `age`, for
    /// which the material is not known.
    pub(crate) fn check_age(&self, time: f64, age: f64, touched: bool) -> Result<()> {
        let known_until = self.known_until;
        if !touched || is_known(age, known_until) {
            Ok(())
        } else {
            Err(Error::Step(StepError::BeyondMaterial { time, age, known_until }))
        }
    }

    /// The warnings of a step of length `dt` to the loading time `age`, without its modulus.
    pub(crate) fn warnings(&self, age: f64, dt: f64) -> Warnings {
        let [from, until] = self.measured;
        let reasons = [
            (Warnings::EXTRAPOLATED, !is_known(age, until)),
            (Warnings::FASTER_THAN_MATERIAL, dt > 0.0 && dt < from),
            (Warnings::NEAR_END_OF_MATERIAL, dt > 0.0 && !is_known(age + dt, self.known_until)),
            (Warnings::UNCERTAIN_MATERIAL, self.is_uncertain),
        ];
        Warnings::of(&reasons)
    }
}
