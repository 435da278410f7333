//! The hereditary integral as a sum over every past increment.

use crate::error::{Error, MaterialError, Result};
use crate::hereditary::Change;
use crate::rheology::Material;

/// At which end of its step an increment of pressure is thought to have happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weighting {
    /// At the end, the rule of the source paper: u(t_n) = Σ C(t_n − t_k) (v_k − v_(k−1)). First order,
    /// explicit in the creep, unstable for long steps.
    End,
    /// At the start: u(t_n) = Σ C(t_n − t_(k−1)) (v_k − v_(k−1)). First order and L-stable.
    Start,
}

/// Cells summed together, so that they stay in the fastest cache while the past passes by.
const BLOCK: usize = 2048;

/// The history as all past increments of v = K p: one field a step, no transforms.
#[derive(Debug, Clone)]
pub(crate) struct Direct {
    material: Material,
    weighting: Weighting,
    /// When each increment happened, by the weighting, and the increment.
    increments: Vec<(f64, Vec<f64>)>,
    /// What each increment contributes to u_old of the step predicted last, per unit of v.
    weights: Vec<f64>,
    /// Bytes that the increments may take.
    limit: usize,
}

impl Direct {
    pub(crate) fn new(material: Material, weighting: Weighting, limit: usize) -> Direct {
        Direct { material, weighting, increments: Vec::new(), weights: Vec::new(), limit }
    }

    /// The past: when each increment happened, and the increment.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn increments(&self) -> &[(f64, Vec<f64>)] {
        &self.increments
    }

    /// The same with another past.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn with(&self, increments: Vec<(f64, Vec<f64>)>) -> Direct {
        Direct { material: self.material.clone(), increments, weights: Vec::new(), ..*self }
    }

    pub(crate) fn predict(&mut self, time: f64, dt: f64, u_old: &mut [f64]) -> Result<f64> {
        let bytes = (self.increments.len() + 1).saturating_mul(std::mem::size_of_val(u_old));
        if bytes > self.limit {
            return Err(Error::HistoryFull { time, steps: self.increments.len(), bytes, limit: self.limit });
        }
        let age = if self.weighting == Weighting::Start { dt } else { 0.0 };
        // while nothing has happened, a step may be longer than the material is known
        let age = if self.increments.is_empty() { age.min(self.material.known_until()) } else { age };
        let newest = self.material.checked_compliance(age, (0.0, self.material.contact_compliance(0.0)))?;
        if newest == 0.0 && age > 0.0 {
            return Err(MaterialError::InvalidCompliance { time: age, value: newest, previous: 0.0 }.into());
        }
        // c acts on the whole of v, so that a past increment adds only what exceeds c
        self.weights.clear();
        let (mut oldest, mut younger) = (age, newest);
        for (when, _) in self.increments.iter().rev() {
            // ages never fall, but their differences of times may, by rounding
            let older = (time - when).max(oldest);
            younger = self.material.checked_compliance(older, (oldest, younger))?;
            oldest = older;
            self.weights.push(younger - newest);
        }
        let past = || self.increments.iter().rev().zip(&self.weights);
        for (block, old) in u_old.chunks_mut(BLOCK).enumerate() {
            old.fill(0.0);
            let first = block * BLOCK;
            for ((_, increment), &weight) in past() {
                for (old, &dv) in old.iter_mut().zip(&increment[first..]) {
                    *old += weight * dv;
                }
            }
        }
        Ok(newest)
    }

    /// The same past on other cells, where each increment is what `carry` makes of it.
    pub(crate) fn carry(&mut self, carry: impl Fn(&[f64]) -> Vec<f64>) {
        self.increments.iter_mut().for_each(|(_, increment)| *increment = carry(increment));
    }

    pub(crate) fn commit(&mut self, change: &Change<'_>) {
        let [before, after] = change.potential;
        let when = match self.weighting {
            Weighting::End => change.time,
            Weighting::Start => change.time - change.dt,
        };
        let increment = after.iter().zip(before).map(|(new, old)| new - old).collect();
        self.increments.push((when, increment));
    }
}
