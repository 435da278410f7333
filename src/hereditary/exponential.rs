//! Exponential integration of the relaxation form of the hereditary integral.

use std::ops::Range;

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
///
/// The last line waits until the next step is predicted, so that every q_i passes through the processor once per step: with
/// many relaxation times this is the cost of a step besides its contact problem.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Exponential {
    relaxation: RelaxationSpectrum,
    /// The fields q_i by blocks of cells, within a block one branch after the other: one stream through memory.
    fields: Vec<f64>,
    /// (e^(−z_i), E_i w_i) of the step predicted last.
    factors: Vec<(f64, f64)>,
    /// The same of the step committed last, as long as the branches have not taken it in.
    committed: Vec<(f64, f64)>,
    waiting: bool,
}

/// Cells processed together, so that what the branches share stays in the fastest cache. With 30 branches at 256² cells a
/// step takes 1.1 times as long as with one; 1.4 times if each branch is an array of its own, whose start must be fetched
/// from memory for every block.
const BLOCK: usize = 512;
/// e^(−700) is near the smallest normal number: what decays further counts as zero.
const MAX_EXPONENT: f64 = 700.0;

impl Exponential {
    /// The undisturbed past of a body with contact compliance `creep` on `cells` cells.
    pub(crate) fn new(creep: &CreepSpectrum, cells: usize) -> Exponential {
        Exponential::undisturbed(creep.relaxation(), cells)
    }

    fn undisturbed(relaxation: RelaxationSpectrum, cells: usize) -> Exponential {
        let branches = relaxation.terms().len();
        Exponential {
            relaxation,
            fields: vec![0.0; cells * branches],
            factors: vec![(1.0, 0.0); branches],
            committed: vec![(1.0, 0.0); branches],
            waiting: false,
        }
    }

    /// The undisturbed past of the same body on `cells` cells.
    pub(crate) fn undisturbed_on(&self, cells: usize) -> Exponential {
        Exponential::undisturbed(self.relaxation.clone(), cells)
    }

    /// Updates the fields with the step committed last, from `before` to `displacement`.
    pub(crate) fn settle(&mut self, before: &[f64], displacement: &[f64]) {
        if !std::mem::take(&mut self.waiting) {
            return;
        }
        let branches = self.factors.len();
        for (block, fields) in self.fields.chunks_mut((BLOCK * branches).max(1)).enumerate() {
            let cells = block * BLOCK..(block * BLOCK + fields.len() / branches);
            let (old, new) = (&before[cells.clone()], &displacement[cells]);
            for (q, &(decay, gain)) in fields.chunks_mut(new.len()).zip(&self.committed) {
                for ((q, &new), &old) in q.iter_mut().zip(new).zip(old) {
                    *q = decay * *q + gain * (new - old);
                }
            }
        }
    }

    /// Copies another without reallocating.
    pub(crate) fn copy_from(&mut self, other: &Exponential) {
        if self.relaxation != other.relaxation {
            *self = other.clone();
            return;
        }
        self.fields.clone_from(&other.fields);
        self.factors.clone_from(&other.factors);
        self.committed.clone_from(&other.committed);
        self.waiting = other.waiting;
    }

    /// Whether it has as many relaxation times as another, and its fields have so many cells.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &Exponential, cells: usize) -> bool {
        let branches = other.branches();
        self.relaxation.terms().len() == branches
            && [self.factors.len(), self.committed.len()] == [branches; 2]
            && Some(self.fields.len()) == cells.checked_mul(branches)
    }

    /// Number of relaxation times.
    pub(crate) fn branches(&self) -> usize {
        self.factors.len()
    }

    /// The ranges of the field q_i.
    fn pieces(branches: usize, i: usize, cells: usize) -> impl Iterator<Item = Range<usize>> {
        (0..cells.div_ceil(BLOCK)).map(move |block| {
            let width = BLOCK.min(cells - block * BLOCK);
            let start = block * BLOCK * branches + i * width;
            start..start + width
        })
    }

    /// The field q_i, on `cells` cells.
    pub(crate) fn branch(&self, i: usize, cells: usize) -> Vec<f64> {
        let mut field = vec![0.0; cells];
        self.read_branch(i, &mut field);
        field
    }

    /// Copies the field q_i to `field`.
    pub(crate) fn read_branch(&self, i: usize, field: &mut [f64]) {
        let pieces = Self::pieces(self.branches(), i, field.len());
        field.chunks_mut(BLOCK).zip(pieces).for_each(|(out, piece)| out.copy_from_slice(&self.fields[piece]));
    }

    /// Replaces the field q_i.
    pub(crate) fn write_branch(&mut self, i: usize, field: &[f64]) {
        let pieces = Self::pieces(self.branches(), i, field.len());
        field.chunks(BLOCK).zip(pieces).for_each(|(values, piece)| self.fields[piece].copy_from_slice(values));
    }

    /// The same past, settled, on `to` instead of `from` cells; `carry` returns each field there.
    pub(crate) fn carried(
        &self,
        to: usize,
        from: usize,
        mut carry: impl FnMut(usize, &[f64]) -> Vec<f64>,
    ) -> Exponential {
        let mut carried = self.undisturbed_on(to);
        (0..self.branches()).for_each(|i| carried.write_branch(i, &carry(i, &self.branch(i, from))));
        carried
    }

    /// Bytes per cell.
    pub(crate) fn bytes_per_cell(&self) -> usize {
        8 * self.branches()
    }

    /// Whether there is a past: an elastic body has none.
    pub(crate) fn remembers(&self) -> bool {
        !self.factors.is_empty() || self.relaxation.viscosity() > 0.0
    }

    /// Writes u_old over `u_old`, which after a commit must still hold the displacement before that step, as
    /// `displacement` holds the one after it.
    pub(crate) fn predict(&mut self, dt: f64, displacement: &[f64], u_old: &mut [f64]) -> f64 {
        let c = self.compliance(dt);
        // u − c E∞ u, written so that an elastic body keeps exactly nothing
        let kept = if self.remembers() { 1.0 - c * self.relaxation.equilibrium() } else { 0.0 };
        let mut change = [0.0; BLOCK];
        let mut blocks = self.fields.chunks_mut((BLOCK * self.factors.len()).max(1));
        for (old, new) in u_old.chunks_mut(BLOCK).zip(displacement.chunks(BLOCK)) {
            let change = &mut change[..new.len()];
            for ((change, old), &new) in change.iter_mut().zip(old.iter_mut()).zip(new) {
                *change = new - *old;
                *old = kept * new;
            }
            let branches = blocks.next().into_iter().flat_map(|fields| fields.chunks_mut(new.len()));
            for ((q, &(decay, _)), &(before, gain)) in branches.zip(&self.factors).zip(&self.committed) {
                let weight = c * decay;
                if self.waiting {
                    take_in(q, change, [before, gain], old, weight);
                } else {
                    for (old, &q) in old.iter_mut().zip(&*q) {
                        *old -= weight * q;
                    }
                }
            }
        }
        self.waiting = false;
        c
    }

    /// Calls `take` with c (E∞ u + Σ e^(−z_i) q_i), by which a free displacement recedes in the step, for each cell that is
    /// `wanted`; after [`Exponential::predict`].
    pub(crate) fn recovery(
        &self,
        c: f64,
        displacement: &[f64],
        wanted: impl Fn(usize) -> bool,
        mut take: impl FnMut(usize, f64),
    ) {
        let equilibrium = self.relaxation.equilibrium();
        let mut blocks = self.fields.chunks((BLOCK * self.factors.len()).max(1));
        for (block, displacement) in displacement.chunks(BLOCK).enumerate() {
            let fields = blocks.next().unwrap_or_default();
            for k in (0..displacement.len()).filter(|k| wanted(block * BLOCK + k)) {
                let branches = fields.chunks(displacement.len()).zip(&self.factors);
                let stress = branches.fold(equilibrium * displacement[k], |sum, (q, (decay, _))| sum + decay * q[k]);
                take(block * BLOCK + k, c * stress);
            }
        }
    }

    /// The compliance c of a step, and its factors; 0 for a jump of a body without elastic response.
    fn compliance(&mut self, dt: f64) -> f64 {
        let mut stiffness = self.relaxation.equilibrium();
        for (factor, &(modulus, tau)) in self.factors.iter_mut().zip(self.relaxation.terms()) {
            let z = dt / tau;
            let w = if z > 0.0 { -(-z).exp_m1() / z } else { 1.0 };
            *factor = (if z < MAX_EXPONENT { (-z).exp() } else { 0.0 }, modulus * w);
            stiffness += factor.1;
        }
        if self.relaxation.viscosity() > 0.0 {
            stiffness += self.relaxation.viscosity() / dt;
        }
        1.0 / stiffness
    }

    /// Accepts the step predicted last. The fields follow at the next prediction.
    pub(crate) fn commit(&mut self) {
        self.committed.copy_from_slice(&self.factors);
        self.waiting = true;
    }
}

/// q ← decay q + gain (u_new − u), and u_old −= weight q, in one pass.
fn take_in(q: &mut [f64], change: &[f64], [decay, gain]: [f64; 2], u_old: &mut [f64], weight: f64) {
    for ((q, &change), old) in q.iter_mut().zip(change).zip(u_old) {
        *q = decay * *q + gain * change;
        *old -= weight * *q;
    }
}
