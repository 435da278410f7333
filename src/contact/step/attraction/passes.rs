//! What a step of surfaces that attract each other works in, and how it went.

use crate::contact::state::State;
use crate::equilibrium::window::Window;
use crate::kernel::{LocalKernel, PeriodInverse, Workspace};
use crate::solver::Solution;

/// What tells a jump, chosen on `ADHESION_JUMPS`.
pub(super) struct Jumps {
    /// It releases more than this part of the energy, and of the work of separation of so many cells.
    noticed: f64,
    cells: f64,
    /// In it the energy bends up on the way by less than this part of what it would without attraction, and at least
    /// this part of what is released is unaccounted for.
    bend: f64,
    unaccounted: f64,
    /// Each half of a smooth step releases a quarter of what the whole does, and one half a jump.
    in_a_half: f64,
    /// Besides what is smooth, a part of a step with a jump releases more than this share of what the step released.
    pub(super) in_a_part: f64,
    /// The shortest parts of a step.
    pub(super) shortest: f64,
    /// Tolerance of parts, of which the energy alone is asked.
    pub(super) tolerance: f64,
}

pub(super) const JUMPS: Jumps = Jumps {
    noticed: 1e-3,
    cells: 10.0,
    bend: 0.4,
    unaccounted: 0.3,
    in_a_half: 0.4,
    in_a_part: 0.16,
    shortest: 0.25,
    tolerance: 1e-2,
};

/// What a step works in, besides the trial, and how the last step went.
#[derive(Debug, Clone)]
pub(crate) struct Attracted {
    /// Between two steps the first three hold the [weights](Attracted::weights).
    pub(super) in_gap: InGap,
    /// F (z − s) of the [far field](super::near_field).
    pub(super) far: Vec<f64>,
    /// What it lacks after the last round.
    pub(super) change: Vec<f64>,
    /// The least curvature of the energy over the curvature of its convex part, among the last directions of the last
    /// descent and the softest one.
    pub(super) softness: f64,
    /// Whether a state is looked at for a direction along which the energy bends down, and the least curvature that
    /// this step has found so.
    pub(super) looks: bool,
    pub(super) softest: Option<f64>,
    pub(crate) report: PassReport,
    /// The near field of the kernel, and its work space; `None` of periodic bodies.
    pub(super) near: Option<(LocalKernel, Workspace)>,
    /// The inverse of the near field, or of the kernel of periodic bodies.
    pub(super) inverse: Option<PeriodInverse>,
    /// The end of a step that was [split](super::jump_search).
    pub(super) end: Option<Box<State>>,
}

/// The fields of a [descent](super::descent) in the gap.
#[derive(Debug, Clone)]
pub(super) struct InGap {
    /// The direction d, and M d/c.
    pub(super) direction: Vec<f64>,
    pub(super) image: Vec<f64>,
    /// Lift and traction that are tried; between two trials K r, and r of the iteration before.
    pub(super) lift: Vec<f64>,
    pub(super) traction: Vec<f64>,
}

impl InGap {
    /// Turns the direction round.
    pub(super) fn reverse(&mut self) {
        self.direction.iter_mut().chain(&mut self.image).for_each(|value| *value = -*value);
    }
}

/// How a step of surfaces that attract each other went
/// ([`ViscoelasticContact::passes`](crate::ViscoelasticContact::passes)).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct PassReport {
    /// Passes over the gap: iterations.
    pub passes: usize,
    /// Trials of an iteration that raised the energy, and were given up.
    pub rejected: usize,
    /// The maximum rise of the energy in a pass, over the sum of its parts, beyond rounding.
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

impl PassReport {
    /// What counts beside an energy of bodies of this work of separation of a cell.
    pub(crate) fn noticed(energy: f64, of_cell: f64) -> f64 {
        JUMPS.noticed * energy.max(JUMPS.cells * of_cell)
    }

    /// Whether the surfaces may have jumped and released more than this \[J\].
    pub(crate) fn may_jump(&self, least: f64) -> bool {
        self.released > least && self.bend < JUMPS.bend && self.unaccounted > JUMPS.unaccounted * self.released
    }

    /// The report of a step in two halves, of which this is the second, and of a `whole` that was tried before.
    pub(crate) fn after(self, first: PassReport, whole: PassReport) -> PassReport {
        PassReport {
            passes: first.passes + self.passes,
            rejected: first.rejected + self.rejected,
            rise: first.rise.max(self.rise),
            released: first.released + self.released,
            jumped: whole.suspected && first.released.max(self.released) > JUMPS.in_a_half * whole.released,
            suspected: false,
            unaccounted: first.unaccounted + self.unaccounted,
            bend: self.bend,
            beyond_edge: self.beyond_edge,
        }
    }
}

impl Attracted {
    /// Bytes for each cell, with s of the trial.
    pub(in crate::contact) fn bytes_per_cell() -> usize {
        8 * 7
    }

    pub(super) fn new(cells: usize, kernel: &LocalKernel) -> Attracted {
        let field = || vec![0.0; cells];
        Attracted {
            in_gap: InGap { direction: field(), image: field(), lift: field(), traction: field() },
            far: field(),
            change: field(),
            softness: 0.0,
            looks: true,
            softest: None,
            report: PassReport::default(),
            near: kernel.near(),
            inverse: Some(kernel.period_inverse()),
            end: None,
        }
    }

    /// K (z − s), or N (z − s) in a window that has traded its kernel, and the far field.
    pub(super) fn image_of_net<'a>(
        &'a mut self,
        solution: &Solution,
        window: &mut Window,
    ) -> (&'a [f64], &'a mut Vec<f64>, &'a mut Vec<f64>) {
        let Attracted { in_gap: InGap { direction: net, image, .. }, far, change, .. } = self;
        let tractions = solution.pressure.iter().zip(&solution.attraction);
        net.iter_mut().zip(tractions).for_each(|(net, (z, s))| *net = z - s);
        window.kernel.apply(net, image, &mut window.work);
        (image, far, change)
    }

    /// Takes a part of the last change into the far field.
    pub(super) fn relax(&mut self, part: f64) {
        self.far.iter_mut().zip(&self.change).for_each(|(far, change)| *far += part * change);
    }

    /// Exchanges the kernel of the window for the near field, if there is one, and back.
    pub(super) fn swap_near_field(&mut self, window: &mut Window) {
        if let Some((kernel, work)) = &mut self.near {
            std::mem::swap(&mut window.kernel, kernel);
            window.work.swap(work);
        }
    }

    /// Whether surfaces snapped within the last step, and whether they may have.
    pub(in crate::contact::step) fn jumped(&self) -> bool {
        self.report.jumped
    }

    pub(in crate::contact::step) fn suspects_jump(&self) -> bool {
        self.report.suspected
    }

    /// |z − s| at the end of a step that was solved, at its start, and at the start of the step before.
    pub(in crate::contact) fn weights(&self) -> [&[f64]; 3] {
        let InGap { direction: now, image: start, lift: before, .. } = &self.in_gap;
        [now, start, before]
    }

    pub(super) fn keep_weights(&mut self, solutions: [&Solution; 3]) {
        let InGap { direction, image, lift, .. } = &mut self.in_gap;
        for (weights, Solution { pressure, attraction, .. }) in [direction, image, lift].into_iter().zip(solutions) {
            for (weight, (z, s)) in weights.iter_mut().zip(pressure.iter().zip(attraction)) {
                // no cell counts as one that the bodies have yet to meet
                *weight = (z - s).abs().max(f64::MIN_POSITIVE);
            }
        }
    }
}
