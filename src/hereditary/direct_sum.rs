//! The hereditary integral as a sum over every past increment.

use crate::error::{Error, MaterialError, Result, StepError};
use crate::hereditary::field::{Field, Role};
use crate::hereditary::interval::{HistoryInputs, Interval};

/// The end of a step to which its increment is assigned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Weighting {
    /// At the end, the rule of the source paper: u(t_n) = Σ C(t_n − t_k) (v_k − v_(k−1)), Eq. 11 with the
    /// coefficients of Eq. 12. First order, explicit in the creep, unstable for long steps.
    End,
    /// At the start: u(t_n) = Σ C(t_n − t_(k−1)) (v_k − v_(k−1)). First order and L-stable.
    Start,
}

/// Cells summed together, so that they stay in the fastest cache while the increments stream by.
const BLOCK: usize = 2048;

/// The past as all increments of v = K p, one field per step, no transforms.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DirectSum {
    weighting: Weighting,
    increments: Vec<Increment>,
    /// What each increment contributes to u_old of the step predicted last, per unit of v.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    weights: Vec<f64>,
}

clone_by_fields! { DirectSum { weighting, increments, weights } }

/// What a step has added.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Increment {
    /// When it happened, by the weighting.
    time: f64,
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    change: Vec<f64>,
}

clone_by_fields! { Increment { time, change } }

impl DirectSum {
    pub(crate) fn new(weighting: Weighting) -> DirectSum {
        DirectSum { weighting, increments: Vec::new(), weights: Vec::new() }
    }

    /// A copy; `map` gives its fields, one for each field here.
    pub(super) fn map(&self, map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> DirectSum {
        let DirectSum { weighting, ref increments, ref weights } = *self;
        let increment = |&Increment { time, ref change }: &Increment| {
            let change = map(Field::single(change, Role::Lasting { source: None }));
            Increment { time, change }
        };
        let increments = increments.iter().map(increment).collect();
        DirectSum { weighting, increments, weights: weights.clone() }
    }

    /// Writes u_old over `u_old`; returns c.
    pub(super) fn predict(
        &mut self,
        Interval { time, reduced, dt, .. }: Interval,
        HistoryInputs { material, history_limit: limit, .. }: HistoryInputs<'_>,
        u_old: &mut [f64],
    ) -> Result<f64> {
        let bytes = (self.increments.len() + 1).saturating_mul(std::mem::size_of_val(u_old));
        if bytes > limit {
            return Err(Error::Step(StepError::HistoryFull { time, steps: self.increments.len(), bytes, limit }));
        }
        let age = if self.weighting == Weighting::Start { dt } else { 0.0 };
        // before the first increment, a step may be longer than the material is known for
        let age = if self.increments.is_empty() { age.min(material.known_until()) } else { age };
        let newest = material.checked_compliance(age, (0.0, material.contact_compliance(0.0)))?;
        if newest == 0.0 && age > 0.0 {
            return Err(MaterialError::InvalidCompliance { time: age, value: newest, previous: 0.0 }.into());
        }
        // c acts on the whole of v, so that a past increment adds only what exceeds c
        self.weights.clear();
        let (mut oldest, mut younger) = (age, newest);
        for Increment { time: when, .. } in self.increments.iter().rev() {
            // ages never fall, but their differences of times may, by rounding
            let older = (reduced - when).max(oldest);
            younger = material.checked_compliance(older, (oldest, younger))?;
            oldest = older;
            self.weights.push(younger - newest);
        }
        for (block, old) in u_old.chunks_mut(BLOCK).enumerate() {
            old.fill(0.0);
            let first = block * BLOCK;
            for (Increment { change, .. }, &weight) in self.increments.iter().rev().zip(&self.weights) {
                for (old, &dv) in old.iter_mut().zip(&change[first..]) {
                    *old += weight * dv;
                }
            }
        }
        Ok(newest)
    }

    /// Takes the step of length `dt` that ends at the reduced time `end` into the past, given v at its start and at
    /// its end.
    pub(super) fn commit(&mut self, (end, dt): (f64, f64), [before, after]: [&[f64]; 2]) {
        let time = if self.weighting == Weighting::Start { end - dt } else { end };
        let change = after.iter().zip(before).map(|(new, old)| new - old).collect();
        self.increments.push(Increment { time, change });
    }

    /// Drops the increment of the step committed last.
    pub(super) fn roll_back(&mut self) {
        self.increments.pop();
    }

    /// Whether `other` has the same weighting.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &DirectSum) -> bool {
        self.weighting == other.weighting
    }
}
