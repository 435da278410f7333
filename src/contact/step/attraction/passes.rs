//! What the passes of a step work in, and how they went.

use crate::contact::state::State;
use crate::linalg::solve_normal_equations;
use crate::parallel::for_each_band;
use crate::solver::Solution;

/// Passes that are extrapolated from.
pub(super) const KEPT: usize = 3;
/// Share of the square of a change, independent of the other changes, that counts as zero.
const DEPENDENT: f64 = 1e-10;
/// Between the [response](PassReport::response) to a smooth change, on spheres at Tabor's numbers 0.5 to 3 at most 13, and to a jump, at least
/// 19.
const LEAST_OF_JUMP: f64 = 15.0;

/// What the passes of a step work in, besides the trial, and how the last step went.
#[derive(Debug, Clone)]
pub(in crate::contact) struct Passes {
    /// K s.
    pub(super) image: Vec<f64>,
    /// The gap before any traction.
    pub(super) open: Vec<f64>,
    /// s of passes that were kept, and s at the gaps that they led to, the last first.
    pub(super) kept: [[Vec<f64>; 2]; KEPT],
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
    /// Fields for each cell, with s of the trial.
    pub(in crate::contact) const FIELDS: usize = 3 + 2 * KEPT + 1;

    pub(super) fn new(cells: usize) -> Passes {
        let field = || vec![0.0; cells];
        let kept = std::array::from_fn(|_| [field(), field()]);
        Passes { image: field(), open: field(), kept, known: 0, first: field(), report: PassReport::default() }
    }

    /// |z − s| at the end of a step that was solved, at its start, and at the start of the step before.
    pub(in crate::contact) fn weights(&self) -> [&[f64]; 3] {
        self.kept.each_ref().map(|[weights, _]| &weights[..])
    }

    pub(super) fn keep_weights(&mut self, solutions: [&Solution; 3]) {
        for ([weights, _], Solution { pressure, attraction, .. }) in self.kept.iter_mut().zip(solutions) {
            for (weight, (z, s)) in weights.iter_mut().zip(pressure.iter().zip(attraction)) {
                // no cell counts as one that the bodies have yet to meet
                *weight = (z - s).abs().max(f64::MIN_POSITIVE);
            }
        }
    }

    /// Writes the next s: from the kept passes, the last of which led from s to g, g − Σ γ (g − g′), where γ makes the change f = g − s
    /// less Σ γ (f − f′) as small as it can. Against f the energy rises: where this s lies that way, it aims at a state of greatest energy, and
    /// the signs of γ are reversed (saddle-free Newton method, Dauphin et al., NIPS 27, 2014). Returns whether they were.
    pub(super) fn extrapolate(&self, state: &State, greatest: f64, next: &mut [f64]) -> bool {
        const OTHERS: usize = KEPT - 1;
        const SQUARE: usize = OTHERS * OTHERS;
        let [[s, g], others @ ..] = &self.kept;
        let known = self.known - 1;
        let change = |k: usize, j: usize| (g[k] - s[k]) - (others[j][1][k] - others[j][0][k]);
        let sums = state.region.rows().sum_terms(|k| {
            let mut terms = [0.0; SQUARE + 2 * OTHERS + 1];
            let f = g[k] - s[k];
            for i in 0..known {
                let own = change(k, i);
                terms[SQUARE + i] = own * f;
                terms[SQUARE + OTHERS + i] = (g[k] - others[i][1][k]) * f;
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
                let moved = (0..known).map(|j| weights[j] * (g[k] - others[j][1][k])).sum::<f64>();
                *next = (g[k] - sign * moved).clamp(0.0, greatest);
            }
        });
        reversed
    }
}
