//! Exponential integration of the relaxation form.

use crate::error::{Error, Result};
use crate::hereditary::Change;
use crate::rheology::{CreepSpectrum, RelaxationSpectrum};

/// The history as one stress-like field q_i for each relaxation time.
///
/// With v = K p and the contact relaxation modulus E(t) = E∞ + Σ E_i e^(−t/τ_i) + η δ(t),
/// v = ∫ E(t − s) du(s). Let u be linear on a step of length Δ, z_i = Δ/τ_i,
/// w_i = (1 − e^(−z_i))/z_i. Then
///
/// c = 1/(E∞ + Σ E_i w_i + η/Δ),
/// u_old = u − c (E∞ u + Σ e^(−z_i) q_i),
/// q_i ← e^(−z_i) q_i + E_i w_i (u_new − u).
///
/// Second order in Δ, positive, and L-stable: for Δ → ∞ the response tends to the relaxed one.
#[derive(Debug, Clone)]
pub(crate) struct Exponential {
    relaxation: RelaxationSpectrum,
    branches: Vec<Vec<f64>>,
    /// (e^(−z_i), E_i w_i) of the step predicted last.
    factors: Vec<(f64, f64)>,
}

impl Exponential {
    /// The undisturbed past of a body with contact compliance `creep` on `cells` cells.
    pub(crate) fn new(creep: &CreepSpectrum, cells: usize) -> Exponential {
        let relaxation = creep.relaxation();
        let branches = relaxation.terms().len();
        Exponential { relaxation, branches: vec![vec![0.0; cells]; branches], factors: vec![(1.0, 0.0); branches] }
    }

    /// A past of jumps alone, at one time, that left the surface displaced: every branch has its share.
    pub(crate) fn jump_from_rest(&mut self, displacement: &[f64]) {
        for (branch, &(modulus, _)) in self.branches.iter_mut().zip(self.relaxation.terms()) {
            for (q, &u) in branch.iter_mut().zip(displacement) {
                *q = modulus * u;
            }
        }
    }

    /// Whether there is a past at all: an elastic body has none.
    pub(crate) fn remembers(&self) -> bool {
        !self.branches.is_empty() || self.relaxation.viscosity() > 0.0
    }

    pub(crate) fn predict(&mut self, time: f64, dt: f64, displacement: &[f64], u_old: &mut [f64]) -> Result<f64> {
        let mut stiffness = self.relaxation.equilibrium();
        for (factor, &(modulus, tau)) in self.factors.iter_mut().zip(self.relaxation.terms()) {
            let z = dt / tau;
            let w = if z > 0.0 { -(-z).exp_m1() / z } else { 1.0 };
            *factor = ((-z).exp(), modulus * w);
            stiffness += factor.1;
        }
        if self.relaxation.viscosity() > 0.0 {
            if dt == 0.0 {
                return Err(Error::NoElasticResponse {
                    time,
                    what: "a step of length zero (ramp the load over a short time instead)",
                });
            }
            stiffness += self.relaxation.viscosity() / dt;
        }
        let c = 1.0 / stiffness;
        // u − c E∞ u, written so that an elastic body keeps exactly nothing
        let kept = if self.remembers() { 1.0 - c * self.relaxation.equilibrium() } else { 0.0 };
        for (old, &u) in u_old.iter_mut().zip(displacement) {
            *old = kept * u;
        }
        for (branch, &(decay, _)) in self.branches.iter().zip(&self.factors) {
            let weight = c * decay;
            for (old, &q) in u_old.iter_mut().zip(branch) {
                *old -= weight * q;
            }
        }
        Ok(c)
    }

    pub(crate) fn commit(&mut self, change: &Change<'_>) {
        let [before, after] = change.displacement;
        for (branch, &(decay, weight)) in self.branches.iter_mut().zip(&self.factors) {
            for ((q, &old), &new) in branch.iter_mut().zip(before).zip(after) {
                *q = decay * *q + weight * (new - old);
            }
        }
    }
}
