//! What the defects of the steps of a run leave in the displacement.

use crate::rheology::CreepSpectrum;

/// Whether the defects of v of the steps so far add up. Under a given force a defect of v makes the bodies creep as a force would:
/// defects of one sign leave an error in u that grows with the compliance of the bodies' age; defects of changing sign cancel.
///
/// The response to the defects, and to their absolute values, by the same series: the ratio of both is how far they agree.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Drift {
    fluidity: f64,
    flow: [f64; 2],
    /// Compliance, retardation time and what has crept, of each term.
    terms: Vec<(f64, f64, [f64; 2])>,
}

impl Drift {
    pub(super) fn new(creep: &CreepSpectrum) -> Drift {
        let terms = creep.terms().iter().map(|&(c, lambda)| (c, lambda, [0.0; 2])).collect();
        Drift { fluidity: creep.fluidity(), flow: [0.0; 2], terms }
    }

    /// Whether a run can be continued with it: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        let known = |values: [f64; 2]| values.iter().all(|value| value.is_finite());
        known(self.flow)
            && self.fluidity >= 0.0
            && self.terms.iter().all(|&(c, lambda, crept)| c >= 0.0 && lambda > 0.0 && known(crept))
    }

    /// The shortest retardation time; infinite if there is none.
    pub(super) fn shortest_time(&self) -> f64 {
        self.terms.iter().map(|&(_, lambda, _)| lambda).fold(f64::INFINITY, f64::min)
    }

    /// Takes account of a step of length `dt` with such a mean defect of v, and mean of its absolute value.
    pub(super) fn include(&mut self, dt: f64, defect: [f64; 2]) {
        for which in [0, 1] {
            self.flow[which] += self.fluidity * dt * defect[which];
            for (c, lambda, crept) in &mut self.terms {
                let decay = (-dt / *lambda).exp();
                crept[which] = decay * crept[which] + *c * (1.0 - decay) * defect[which];
            }
        }
    }

    /// How far the defects so far agree: 1 if they are all of one sign, 0 if they cancel.
    pub(super) fn agreement(&self) -> f64 {
        let [signed, absolute] =
            [0, 1].map(|which| self.flow[which] + self.terms.iter().map(|term| term.2[which]).sum::<f64>());
        if absolute > 0.0 { (signed / absolute).abs().min(1.0) } else { 1.0 }
    }
}
