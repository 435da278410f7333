//! What a step of surfaces that attract each other works in, and how it went.

use crate::contact::state::State;
use crate::equilibrium::window::Window;
use crate::parallel::for_each_band;
use crate::solver::Solution;

/// Each half of a smooth step releases a quarter of what the whole does, and one half a jump.
const LEFT_IN_A_HALF: f64 = 0.4;

/// What a step works in, besides the trial, and how the last step went.
#[derive(Debug, Clone)]
pub(crate) struct Attracted {
    fields: [Vec<f64>; 4],
    /// F (z − s) of the [far field](super::near_field).
    pub(super) far: Vec<f64>,
    /// The least curvature of the energy over the curvature of its convex part, among the directions of the last
    /// descent.
    pub(super) softness: f64,
    /// The greatest residual of a descent, over what its softness asks for.
    pub(super) exactness: f64,
    /// Whether a state is looked at for a direction along which the energy bends down, and the least curvature that
    /// this step has found so.
    pub(super) looks: bool,
    pub(super) softest: Option<f64>,
    /// Whether there is a pass before.
    pub(super) has_last: bool,
    /// The error of s after a pass, over what the pass changed, at the rate of the passes, which the last step shows
    /// before they do.
    pub(super) error: f64,
    pub(crate) report: PassReport,
    /// The end of a step that was [split](super::split).
    pub(super) end: Option<Box<State>>,
}

/// The fields of a [descent](super::descent) in the gap.
pub(super) struct InGap<'a> {
    /// The direction d, and M d/c.
    pub(super) direction: &'a mut Vec<f64>,
    pub(super) image: &'a mut Vec<f64>,
    /// Lift and traction that are tried; between two trials K r, and r of the iteration before.
    pub(super) lift: &'a mut Vec<f64>,
    pub(super) traction: &'a mut Vec<f64>,
}

/// The fields of passes.
pub(super) struct InPasses<'a> {
    /// K s.
    pub(super) image: &'a mut Vec<f64>,
    /// s of the last pass that was kept, and s at the gap that it led to.
    pub(super) last_s: &'a mut Vec<f64>,
    pub(super) last_g: &'a mut Vec<f64>,
}

/// How the passes of a step of surfaces that attract each other went: contact problems, each with the attraction at
/// the gap that the one before it led to ([`ViscoelasticContact::passes`](crate::ViscoelasticContact::passes)).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct PassReport {
    /// Passes, or iterations in the gap.
    pub passes: usize,
    /// Passes that began with an extrapolated attraction under which the energy did not fall, and that were given up;
    /// trials of an iteration that raised it.
    pub rejected: usize,
    /// The greatest rise of the energy from pass to pass, over the sum of its parts, beyond the exactness of the
    /// passes.
    pub rise: f64,
    /// The energy of the state before the step, under the load and the creep of its end, less the energy of the state
    /// at its end \[J\]: the loss of a jump. Where nothing jumps, it is of second order in the length of the step, of
    /// either sign.
    pub released: f64,
    /// Whether the surfaces snapped together or apart ([`Warnings::JUMP`](crate::contact::Warnings::JUMP)):
    /// `released` stays however the step is split, where each half of a smooth step releases a quarter.
    pub jumped: bool,
    /// Whether this may be so: much is [released](PassReport::may_jump).
    pub(crate) suspected: bool,
    /// What is released beyond what the forces at both ends of the step would, by the trapezium rule, do along its
    /// way \[J\]: the loss of a jump, and the error of the rule, of third order in the length of the step.
    pub(crate) unaccounted: f64,
    /// By what part of its convex part the energy bends up on the straight way between the states at both ends.
    pub(crate) bend: f64,
    /// The force that the attraction beyond the edge of the grid would add, over that on it; 0 where
    /// [`Edge::Allow`](crate::contact::Edge::Allow) lets it be.
    pub(crate) beyond_edge: f64,
}

/// How the next s follows from a pass and the one before.
#[derive(Clone, Copy)]
pub(super) struct Extrapolation {
    /// γ; zero without a last pass.
    pub(super) weight: f64,
    /// Whether its sign is reversed.
    pub(super) reversed: bool,
    /// The error of s after the pass, over what the pass changed, at the rate of the passes; at least one.
    pub(super) error: f64,
}

/// In a jump the energy bends up on the way by less than this part of what it would without attraction, and at least
/// this part of what is released is unaccounted for.
const LEAST_BEND: f64 = 0.4;
const UNACCOUNTED: f64 = 0.3;

impl PassReport {
    /// Whether the surfaces may have jumped and released more than this \[J\].
    pub(crate) fn may_jump(&self, least: f64) -> bool {
        self.released > least && self.bend < LEAST_BEND && self.unaccounted > UNACCOUNTED * self.released
    }

    /// The report of a step in two halves, of which this is the second, and of a `whole` that was tried before.
    pub(crate) fn after(self, first: PassReport, whole: PassReport) -> PassReport {
        PassReport {
            passes: first.passes + self.passes,
            rejected: first.rejected + self.rejected,
            rise: first.rise.max(self.rise),
            released: first.released + self.released,
            jumped: whole.suspected && first.released.max(self.released) > LEFT_IN_A_HALF * whole.released,
            suspected: false,
            unaccounted: first.unaccounted + self.unaccounted,
            bend: self.bend,
            beyond_edge: self.beyond_edge,
        }
    }
}

impl Attracted {
    /// Bytes for each cell, with s of the trial.
    pub(in crate::contact) const BYTES_PER_CELL: usize = 8 * 6;

    pub(super) fn new(cells: usize) -> Attracted {
        let field = || vec![0.0; cells];
        Attracted {
            fields: [field(), field(), field(), field()],
            far: field(),
            softness: 0.0,
            exactness: 1.0,
            looks: true,
            softest: None,
            has_last: false,
            error: 1.0,
            report: PassReport::default(),
            end: None,
        }
    }

    pub(super) fn in_gap(&mut self) -> InGap<'_> {
        let [direction, image, lift, traction] = &mut self.fields;
        InGap { direction, image, lift, traction }
    }

    /// K (z − s), or N (z − s) in a window that has traded its kernel, and the far field.
    pub(super) fn image_of_net<'a>(
        &'a mut self,
        solution: &Solution,
        window: &mut Window,
    ) -> (&'a [f64], &'a mut Vec<f64>) {
        let Attracted { fields: [net, image, ..], far, .. } = self;
        let tractions = solution.pressure.iter().zip(&solution.attraction);
        net.iter_mut().zip(tractions).for_each(|(net, (z, s))| *net = z - s);
        window.kernel.apply(net, image, &mut window.work);
        (image, far)
    }

    pub(super) fn in_passes(&mut self) -> InPasses<'_> {
        let [image, last_s, last_g, _] = &mut self.fields;
        InPasses { image, last_s, last_g }
    }

    /// |z − s| at the end of a step that was solved, at its start, and at the start of the step before.
    pub(in crate::contact) fn weights(&self) -> [&[f64]; 3] {
        let [now, start, before, _] = &self.fields;
        [now, start, before]
    }

    pub(super) fn keep_weights(&mut self, solutions: [&Solution; 3]) {
        for (weights, Solution { pressure, attraction, .. }) in self.fields.iter_mut().zip(solutions) {
            for (weight, (z, s)) in weights.iter_mut().zip(pressure.iter().zip(attraction)) {
                // no cell counts as one that the bodies have yet to meet
                *weight = (z - s).abs().max(f64::MIN_POSITIVE);
            }
        }
    }

    /// Of a pass from s to g the γ that makes f = g − s less γ Δf as small as it can, Δ being the change from the
    /// last pass: the next s is g − γ Δg. Against f the energy rises: where this s lies that way, it aims at a state
    /// of greatest energy, and the sign of γ is reversed (saddle-free Newton method, Dauphin et al., NIPS 27, 2014).
    pub(super) fn extrapolation(&mut self, state: &State, s: &[f64], g: &[f64]) -> Extrapolation {
        if !self.has_last {
            return Extrapolation { weight: 0.0, reversed: false, error: 1.0 };
        }
        let InPasses { last_s, last_g, .. } = self.in_passes();
        let [overlap, square, along, remaining, together] = state.held.region.rows().sum_terms(|k| {
            let (f, of_g) = (g[k] - s[k], g[k] - last_g[k]);
            let of_f = of_g - (s[k] - last_s[k]);
            Some([of_f * f, of_f * of_f, of_g * f, f * f, of_g * of_f])
        });
        let over_square = |sum: f64| if square > 0.0 { sum / square } else { 0.0 };
        let weight = over_square(overlap);
        let reversed = weight * along > remaining;
        // at the rate λ of plain passes Δg = −λ/(1 − λ) Δf
        let error = (-over_square(together)).max(1.0);
        Extrapolation { weight: if reversed { -weight } else { weight }, reversed, error }
    }

    /// Keeps the pass from s to g, and writes the next s, g − γ Δg between 0 and the greatest.
    pub(super) fn go_on(&mut self, weight: f64, greatest: f64, s: &mut [f64], g: &[f64]) {
        self.has_last = true;
        let InPasses { last_s, last_g, .. } = self.in_passes();
        for_each_band([s, last_s, last_g], |first, [s, last_s, last_g]| {
            for (((s, last_s), last_g), g) in s.iter_mut().zip(last_s).zip(last_g).zip(&g[first..]) {
                let next = if weight == 0.0 { *g } else { (g - weight * (g - *last_g)).clamp(0.0, greatest) };
                (*last_s, *last_g, *s) = (*s, *g, next);
            }
        });
    }
}
