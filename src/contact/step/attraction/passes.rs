//! What the passes of a step work in, and how they went.

use crate::contact::state::State;
use crate::linalg::solve_normal_equations;
use crate::parallel::for_each_band;
use crate::solver::Solution;

/// Passes that are extrapolated from, besides the last.
const OTHERS: usize = 2;
/// Share of the square of a change, independent of the other changes, that counts as zero.
const DEPENDENT: f64 = 1e-10;
/// Between the [response](PassReport::response) to a smooth change, on spheres at Tabor's numbers 0.5 to 3 at most 13, and to a jump, at least
/// 19.
const LEAST_OF_JUMP: f64 = 15.0;

/// What the passes of a step work in, besides the trial, and how the last step went.
#[derive(Debug, Clone)]
pub(in crate::contact) struct Passes {
    /// K s, or N s of the [near field](super::near_field).
    pub(super) image: Vec<f64>,
    /// F (z − s) of the far field; zero where passes work with K.
    pub(super) far: Vec<f64>,
    /// s of the last pass that was kept, and s at the gap that it led to.
    pub(super) last: [Vec<f64>; 2],
    pub(super) has_last: bool,
    /// By how much both changed from pass to pass, over the greatest traction, the last change first. They are directions: single precision
    /// is as good.
    changes: [[Vec<f32>; 2]; OTHERS],
    pub(super) known: usize,
    /// The change of s in the first pass.
    pub(super) first: Vec<f64>,
    pub(in crate::contact) report: PassReport,
}

/// How the passes of a step of surfaces that attract each other went: contact problems, each with the attraction at the gap that the one
/// before it led to ([`ViscoelasticContact::passes`](crate::ViscoelasticContact::passes)).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct PassReport {
    /// Passes.
    pub passes: usize,
    /// Passes that began with an extrapolated attraction under which the energy did not fall, and that were given up.
    pub rejected: usize,
    /// The greatest rise of the energy from pass to pass, over the sum of its parts, beyond the exactness of the passes.
    pub rise: f64,
    /// The energy of the state before the step, under the load and the creep of its end, less the energy of the state at its end \[J\]: the loss of a jump.
    /// Where nothing jumps, it is of second order in the length of the step, of either sign.
    pub released: f64,
    /// By how many times the response of the surfaces enlarges a change of the attraction: 1 where it is weak, above 15 in a jump
    /// ([`Warnings::JUMP`](crate::contact::Warnings::JUMP)).
    pub response: f64,
}

impl PassReport {
    /// Whether the surfaces snapped together or apart.
    pub(in crate::contact) fn jumped(&self) -> bool {
        self.response > LEAST_OF_JUMP
    }
}

impl Passes {
    /// Bytes for each cell, with s of the trial.
    pub(in crate::contact) const BYTES_PER_CELL: usize = 8 * 6 + 4 * 2 * OTHERS;

    pub(super) fn new(cells: usize) -> Passes {
        let field = || vec![0.0; cells];
        let changes = std::array::from_fn(|_| [vec![0.0; cells], vec![0.0; cells]]);
        Passes {
            image: field(),
            far: field(),
            last: [field(), field()],
            has_last: false,
            changes,
            known: 0,
            first: field(),
            report: PassReport::default(),
        }
    }

    /// Forgets all passes but the last.
    pub(super) fn forget_changes(&mut self) {
        self.known = 0;
    }

    /// Keeps a pass from `s` to `g`.
    pub(super) fn keep(&mut self, s: &[f64], g: &[f64], greatest: f64) {
        if std::mem::replace(&mut self.has_last, true) {
            self.changes.rotate_right(1);
            for ((change, last), now) in self.changes[0].iter_mut().zip(&self.last).zip([s, g]) {
                let values = change.iter_mut().zip(now.iter().zip(last));
                values.for_each(|(change, (now, last))| *change = ((now - last) / greatest) as f32);
            }
            self.known = (self.known + 1).min(OTHERS);
        }
        self.last[0].copy_from_slice(s);
        self.last[1].copy_from_slice(g);
    }

    /// |z − s| at the end of a step that was solved, at its start, and at the start of the step before.
    pub(in crate::contact) fn weights(&self) -> [&[f64]; 3] {
        [&self.last[0], &self.last[1], &self.first]
    }

    pub(super) fn keep_weights(&mut self, solutions: [&Solution; 3]) {
        let Passes { last: [now, before], first, .. } = self;
        for (weights, Solution { pressure, attraction, .. }) in [now, before, first].into_iter().zip(solutions) {
            for (weight, (z, s)) in weights.iter_mut().zip(pressure.iter().zip(attraction)) {
                // no cell counts as one that the bodies have yet to meet
                *weight = (z - s).abs().max(f64::MIN_POSITIVE);
            }
        }
    }

    /// Writes the next s: from the last pass, which led from s to g, g − Σ γ Δg, where γ makes f = g − s less Σ γ Δf as small as it can, Δ being
    /// the changes from pass to pass. Against f the energy rises: where this s lies that way, it aims at a state of greatest energy, and
    /// the signs of γ are reversed (saddle-free Newton method, Dauphin et al., NIPS 27, 2014). Returns whether they were.
    pub(super) fn extrapolate(&self, state: &State, greatest: f64, next: &mut [f64]) -> bool {
        const SQUARE: usize = OTHERS * OTHERS;
        let Passes { last: [s, g], changes, known, .. } = self;
        let known = *known;
        let of_g = |k: usize, j: usize| greatest * f64::from(changes[j][1][k]);
        let change = |k: usize, j: usize| greatest * (f64::from(changes[j][1][k]) - f64::from(changes[j][0][k]));
        let sums = state.region.rows().sum_terms(|k| {
            let mut terms = [0.0; SQUARE + 2 * OTHERS + 1];
            let f = g[k] - s[k];
            for i in 0..known {
                let own = change(k, i);
                terms[SQUARE + i] = own * f;
                terms[SQUARE + OTHERS + i] = of_g(k, i) * f;
                (0..known).for_each(|j| terms[OTHERS * i + j] = own * change(k, j));
            }
            terms[SQUARE + 2 * OTHERS] = f * f;
            Some(terms)
        });
        let gram: [[f64; OTHERS]; OTHERS] = std::array::from_fn(|i| std::array::from_fn(|j| sums[OTHERS * i + j]));
        let weights = solve_normal_equations(&gram, std::array::from_fn(|i| sums[SQUARE + i]), DEPENDENT);
        let along = (0..known).map(|j| weights[j] * sums[SQUARE + OTHERS + j]).sum::<f64>();
        let reversed = along > sums[SQUARE + 2 * OTHERS];
        let sign = if reversed { -1.0 } else { 1.0 };
        for_each_band([next], |first, [next]| {
            for (next, k) in next.iter_mut().zip(first..) {
                let moved = (0..known).map(|j| weights[j] * of_g(k, j)).sum::<f64>();
                *next = (g[k] - sign * moved).clamp(0.0, greatest);
            }
        });
        reversed
    }
}
