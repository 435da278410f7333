//! What bodies store and dissipate, from their displacement and their tractions.

use crate::hereditary::moments::Relaxed;
use crate::rheology::{CreepSpectrum, RelaxationSpectrum};

/// The branches of a generalized Maxwell body in every cell, as springs E_i with dashpots E_i τ_i in series.
///
/// With u = K P, where P = C ∗ dq is a field as local as the tractions q, branch i displaces the surface by E_i^(−1)
/// u_i, and carries the tractions t_i: both obey y′ = E_i x′ − y/τ_i, with x = u for u_i and x = P for t_i, and
/// u_i = K t_i. The bodies store ½ E∞ Σ u P + Σ_i Σ u_i t_i/(2 E_i), and dissipate Σ_i Σ u_i t_i/(E_i τ_i) and η Σ u′
/// P′ in a unit of time, each positive since K is. On a step u and P are linear in time, and energies exact: with
/// z = Δ/τ_i and the functions φ of [`Relaxed`], a branch takes up the work φ₁ Σ t_i Δu + φ₂ E_i Σ ΔP Δu.
#[derive(Debug, Clone)]
pub(crate) struct BranchEnergies {
    relaxation: RelaxationSpectrum,
    /// u and P.
    whole: [Vec<f64>; 2],
    changes: [Vec<f64>; 2],
    /// u_i and t_i.
    branches: Vec<[Vec<f64>; 2]>,
    /// What the branches store.
    stored: f64,
}

impl BranchEnergies {
    /// Undisturbed bodies on this number of cells.
    pub(crate) fn new(creep: &CreepSpectrum, cells: usize) -> BranchEnergies {
        let (relaxation, fields) = (creep.relaxation(), || [vec![0.0; cells], vec![0.0; cells]]);
        let branches = relaxation.terms().iter().map(|_| fields()).collect();
        BranchEnergies { relaxation, whole: fields(), changes: fields(), branches, stored: 0.0 }
    }

    /// A step of length Δ to the displacement u and the tractions q: what is stored at its end, and what was
    /// dissipated, per area of a cell.
    pub(crate) fn step(&mut self, dt: f64, u: &[f64], q: &[f64]) -> [f64; 2] {
        let BranchEnergies { relaxation, whole, changes: [du, dp], branches, stored } = self;
        let relaxed = |&(modulus, tau): &(f64, f64)| (modulus, Relaxed::new(dt / tau));
        let (equilibrium, terms) = (relaxation.equilibrium(), relaxation.terms().iter().map(relaxed));
        let viscous = if relaxation.viscosity() > 0.0 { relaxation.viscosity() / dt } else { 0.0 };
        let answer: f64 = terms.clone().map(|(modulus, relaxed)| modulus * relaxed.phi[0]).sum();
        du.iter_mut().zip(u).zip(&whole[0]).for_each(|((du, now), before)| *du = now - before);
        dp.iter_mut().zip(q).zip(&whole[1]).for_each(|((dp, now), before)| *dp = now - equilibrium * before);
        for ([_, tractions], (_, relaxed)) in branches.iter().zip(terms.clone()) {
            dp.iter_mut().zip(tractions).for_each(|(dp, t)| *dp -= relaxed.decay * t);
        }
        dp.iter_mut().for_each(|dp| *dp /= equilibrium + answer + viscous);
        let both = dot(dp, du);
        // an immediate dashpot does not move in a jump
        let mut dissipated = if viscous.is_finite() { viscous * both } else { 0.0 } + *stored;
        *stored = 0.0;
        for (fields, (modulus, relaxed)) in branches.iter_mut().zip(terms) {
            let [first, second, ..] = relaxed.phi;
            dissipated += first * dot(&fields[1], du) + second * modulus * both;
            for (field, changes) in fields.iter_mut().zip([&*du, &*dp]) {
                let next = |y: &f64, dx: &f64| relaxed.decay * y + modulus * first * dx;
                field.iter_mut().zip(changes).for_each(|(y, dx)| *y = next(y, dx));
            }
            *stored += 0.5 * dot(&fields[0], &fields[1]) / modulus;
        }
        for (field, changes) in whole.iter_mut().zip([&*du, &*dp]) {
            field.iter_mut().zip(changes).for_each(|(x, dx)| *x += dx);
        }
        [0.5 * equilibrium * dot(&whole[0], &whole[1]) + *stored, dissipated - *stored]
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
