//! The hereditary integral as a sum over every past increment.

use educe::Educe;

use crate::error::{Error, MaterialError, Result, StepError};
use crate::hereditary::field::{Field, Role};
use crate::hereditary::history::HistoryInputs;
use crate::hereditary::interval::Interval;
use crate::kernel::{LocalKernel, Workspace};

/// The end of a step to which its increment is assigned, and what it is an increment of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Weighting {
    /// At the end, the rule of the source paper: u(t_n) = Σ C(t_n − t_k) (v_k − v_(k−1)), Eq. 11 with the coefficients of
    /// Eq. 12. First order, explicit in the creep, unstable for long steps.
    End,
    /// At the start: u(t_n) = Σ C(t_n − t_(k−1)) (v_k − v_(k−1)). First order and L-stable.
    Start,
    /// At the end, by increments of p: u(t_n) = Σ C(t_n − t_k) K (p_k − p_(k−1)), each convolved anew in every step. The same
    /// sum as of `End`, at the cost that the source paper states (section 4).
    EndUncached,
}

/// Cells summed together, so that they stay in the fastest cache while the increments stream by.
const BLOCK: usize = 2048;

/// The past as all increments of v = K p, one field per step, no transforms; or of p, each convolved anew in every step.
#[derive(Debug, Educe)]
#[educe(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DirectSum {
    weighting: Weighting,
    increments: Vec<Increment>,
    /// What each increment contributes to u_old of the step predicted last, per unit of v.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    weights: Vec<f64>,
    /// The convolution of one increment of p.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    image: Vec<f64>,
}

/// What a step has added.
#[derive(Debug, Educe)]
#[educe(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Increment {
    /// When it happened, by the weighting.
    time: f64,
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    change: Vec<f64>,
}

impl DirectSum {
    pub(crate) fn new(weighting: Weighting) -> DirectSum {
        DirectSum { weighting, increments: Vec::new(), weights: Vec::new(), image: Vec::new() }
    }

    /// A copy; `map` gives its fields, one for each field here.
    pub(super) fn map(&self, map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> DirectSum {
        let DirectSum { weighting, ref increments, ref weights, ref image } = *self;
        let increment = |&Increment { time, ref change }: &Increment| {
            let change = map(Field::single(change, Role::Lasting { source: None }));
            Increment { time, change }
        };
        let increments = increments.iter().map(increment).collect();
        let image = map(Field { values: image, per_cell: usize::from(self.is_uncached()), role: Role::Work });
        DirectSum { weighting, increments, weights: weights.clone(), image }
    }

    /// Whether the stored increments are increments of p.
    fn is_uncached(&self) -> bool {
        self.weighting == Weighting::EndUncached
    }

    /// Writes u_old over `u_old`; returns c and the number of convolutions taken.
    pub(super) fn predict(
        &mut self,
        Interval { time, reduced, dt, .. }: Interval,
        HistoryInputs { material, history_limit: limit, .. }: HistoryInputs<'_>,
        (kernel, work): (&LocalKernel, &mut Workspace),
        u_old: &mut [f64],
    ) -> Result<(f64, usize)> {
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
        let past = || self.increments.iter().rev().zip(&self.weights);
        if self.is_uncached() {
            u_old.fill(0.0);
            for (Increment { change, .. }, &weight) in past() {
                kernel.apply(change, &mut self.image, work);
                u_old.iter_mut().zip(&self.image).for_each(|(old, &dv)| *old += weight * dv);
            }
            return Ok((newest, self.increments.len()));
        }
        for (block, old) in u_old.chunks_mut(BLOCK).enumerate() {
            old.fill(0.0);
            let first = block * BLOCK;
            for (Increment { change, .. }, &weight) in past() {
                for (old, &dv) in old.iter_mut().zip(&change[first..]) {
                    *old += weight * dv;
                }
            }
        }
        Ok((newest, 0))
    }

    /// Takes the step of length `dt` that ends at the reduced time `end` into the past, given p and v at its start and at its end.
    pub(super) fn commit(&mut self, (end, dt): (f64, f64), [pressure, potential]: [[&[f64]; 2]; 2]) {
        let time = if self.weighting == Weighting::Start { end - dt } else { end };
        let [before, after] = if self.is_uncached() { pressure } else { potential };
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
