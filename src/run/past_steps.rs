//! What the steps of a run so far leave.

use crate::error::Result;
use crate::hereditary::{ExponentialRule, LastingError, TimeError};
use crate::rheology::{CreepSpectrum, Material};

/// How far the defects of v of the steps so far add up, and the mean errors of u that they leave. Under a given force
/// a defect of v makes the bodies creep as a force does. Defects of one sign leave an error in u that grows with the
/// compliance; defects of changing sign cancel.
///
/// Holds the creep response to the defects and to their absolute values. The ratio of the two responses measures the
/// agreement of signs.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PastSteps {
    fluidity: f64,
    flow: [f64; 2],
    terms: Vec<CreepTerm>,
    /// Mean errors of u, in contact and outside.
    lasting: Option<[LastingError; 2]>,
    count: u64,
}

/// One term of the creep spectrum.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct CreepTerm {
    compliance: f64,
    /// Retardation time.
    time: f64,
    /// Response to the defects, and to their absolute values.
    crept: [f64; 2],
}

impl PastSteps {
    /// No steps. Without a series no defects add up.
    pub(super) fn none(material: &Material) -> Result<PastSteps> {
        let creep = material.contact_spectrum()?;
        let term = |&(compliance, time): &(f64, f64)| CreepTerm { compliance, time, crept: [0.0; 2] };
        let terms = creep.iter().flat_map(|creep| creep.terms().iter().map(term)).collect();
        let fluidity = creep.as_ref().map_or(0.0, CreepSpectrum::fluidity);
        Ok(PastSteps { fluidity, terms, ..PastSteps::default() })
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        let known = |values: [f64; 2]| values.iter().all(|value| value.is_finite());
        known(self.flow)
            && self.fluidity >= 0.0
            && self.terms.iter().all(|term| term.compliance >= 0.0 && term.time > 0.0 && known(term.crept))
            && self.lasting.iter().flatten().all(LastingError::fits)
    }

    /// Number of steps.
    pub(super) fn count(&self) -> f64 {
        self.count as f64
    }

    /// The shortest retardation time; infinite if there is none.
    pub(super) fn shortest_time(&self) -> f64 {
        self.terms.iter().map(|term| term.time).fold(f64::INFINITY, f64::min)
    }

    /// Includes a step of length `dt`; `motion_is_given` states whether its motion is given.
    pub(super) fn include(&mut self, rule: &ExponentialRule, dt: f64, error: &TimeError, motion_is_given: bool) {
        self.count += 1;
        for (which, defect) in error.defect.into_iter().enumerate() {
            self.flow[which] += self.fluidity * dt * defect;
            for CreepTerm { compliance, time, crept } in &mut self.terms {
                let decay = (-dt / *time).exp();
                crept[which] = decay * crept[which] + *compliance * (1.0 - decay) * defect;
            }
        }
        let [contact, surface] = self.lasting.get_or_insert_with(|| [(); 2].map(|()| LastingError::none(rule)));
        contact.include(rule, error.defect[0], motion_is_given);
        surface.include(rule, error.surface, false);
    }

    /// Agreement of the signs of the defects so far: 1 if all have one sign, 0 if they cancel.
    pub(super) fn agreement(&self) -> f64 {
        let [signed, absolute] =
            [0, 1].map(|which| self.flow[which] + self.terms.iter().map(|term| term.crept[which]).sum::<f64>());
        if absolute > 0.0 { (signed / absolute).abs().min(1.0) } else { 1.0 }
    }

    /// Mean errors of u, in contact and outside.
    pub(super) fn lasting(&self) -> [f64; 2] {
        let errors = self.lasting.as_ref().map(<[_; 2]>::each_ref);
        errors.map_or([0.0; 2], |errors| errors.map(LastingError::of_displacement))
    }
}
