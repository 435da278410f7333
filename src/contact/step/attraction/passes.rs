//! What the passes of a step work in, and how they went.

use crate::contact::state::State;
use crate::parallel::for_each_band;
use crate::solver::Solution;

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
    has_last: bool,
    /// By how much both differ from the pass before, over the greatest traction. They are directions: single precision is as good.
    changes: [Vec<f32>; 2],
    pub(super) has_changes: bool,
    /// The change of s in the first pass, over the greatest traction.
    pub(super) first: Vec<f32>,
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
    pub(in crate::contact) const BYTES_PER_CELL: usize = 8 * 5 + 4 * 3;

    pub(super) fn new(cells: usize) -> Passes {
        let field = || vec![0.0; cells];
        Passes {
            image: field(),
            far: field(),
            last: [field(), field()],
            has_last: false,
            changes: [vec![0.0; cells], vec![0.0; cells]],
            has_changes: false,
            first: vec![0.0; cells],
            report: PassReport::default(),
        }
    }

    /// Forgets all passes.
    pub(super) fn forget(&mut self) {
        (self.has_last, self.has_changes) = (false, false);
    }

    /// Keeps a pass from `s` to `g`.
    pub(super) fn keep(&mut self, s: &[f64], g: &[f64], greatest: f64) {
        self.has_changes = std::mem::replace(&mut self.has_last, true);
        for ((change, last), now) in self.changes.iter_mut().zip(&mut self.last).zip([s, g]) {
            let values = change.iter_mut().zip(now.iter().zip(&*last));
            values.for_each(|(change, (now, last))| *change = ((now - last) / greatest) as f32);
            last.copy_from_slice(now);
        }
    }

    /// |z − s| at the end of a step that was solved, at its start, and at the start of the step before.
    pub(in crate::contact) fn weights(&self) -> [&[f64]; 3] {
        [&self.last[0], &self.last[1], &self.far]
    }

    pub(super) fn keep_weights(&mut self, solutions: [&Solution; 3]) {
        let Passes { last: [now, before], far, .. } = self;
        for (weights, Solution { pressure, attraction, .. }) in [now, before, far].into_iter().zip(solutions) {
            for (weight, (z, s)) in weights.iter_mut().zip(pressure.iter().zip(attraction)) {
                // no cell counts as one that the bodies have yet to meet
                *weight = (z - s).abs().max(f64::MIN_POSITIVE);
            }
        }
    }

    /// Writes the next s: from the last pass, which led from s to g, g − γ Δg, where γ makes f = g − s less γ Δf as small as it can, Δ being the
    /// change from the pass before. Against f the energy rises: where this s lies that way, it aims at a state of greatest energy, and the
    /// sign of γ is reversed (saddle-free Newton method, Dauphin et al., NIPS 27, 2014). Returns whether it was.
    pub(super) fn extrapolate(&self, state: &State, greatest: f64, next: &mut [f64]) -> bool {
        let Passes { last: [s, g], changes: [of_s, of_g], .. } = self;
        let [overlap, square, along, remaining] = state.region.rows().sum_terms(|k| {
            let (f, of_g) = (g[k] - s[k], greatest * f64::from(of_g[k]));
            let of_f = of_g - greatest * f64::from(of_s[k]);
            Some([of_f * f, of_f * of_f, of_g * f, f * f])
        });
        let weight = if square > 0.0 { overlap / square } else { 0.0 };
        let reversed = weight * along > remaining;
        let moved = if reversed { -weight } else { weight } * greatest;
        for_each_band([next], |first, [next]| {
            for (next, k) in next.iter_mut().zip(first..) {
                *next = (g[k] - moved * f64::from(of_g[k])).clamp(0.0, greatest);
            }
        });
        reversed
    }
}
