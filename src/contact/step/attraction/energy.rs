//! The energy of a pass, of an iteration in the gap, of the state before the step, and how the surfaces respond.

use super::descent::Descent;
use super::passes::InPasses;
use super::{Attracted, AttractedStep};
use crate::equilibrium::Equilibrium;
use crate::equilibrium::Trial;
use crate::load::Load;
use crate::parallel::for_each_band;
use crate::solver::{RigidMotion, Solution};

/// Jumps release more than this part of the energy, and of the work of separation of so many cells.
const LEAST_RELEASED: f64 = 1e-3;
const CELLS: f64 = 10.0;

/// Sums over the cells of a pass.
pub(super) struct Found {
    /// Energy over the area of a cell.
    pub(super) energy: f64,
    /// The sum of its parts, and of c z K z.
    pub(super) scale: f64,
    /// The greatest change of s over the greatest traction.
    pub(super) change: f64,
    /// The root mean square of c K z in contact.
    pub(super) displaced: f64,
}

impl AttractedStep<'_> {
    /// Energy and change of the pass; writes s at the gap that it led to in place of the gap of its problem. The
    /// energy is the value of the Lagrangian, in which the error of the pass enters with its square; the far field is
    /// a part of the gap.
    pub(super) fn find(&self, own: &mut Attracted, trial: &mut Trial) -> Found {
        let AttractedStep { state, law, given: [c, _], .. } = *self;
        let (rows, solution, gap) = (state.held.region.rows(), &trial.solution, &mut trial.gap);
        let (modes, motion) = (state.held.region.modes(trial.free[0]), solution.motions[0]);
        let height = |gap: f64, k: usize| gap + c * solution.potential[k] - modes.displacement(motion, k);
        let (s, InPasses { image, .. }) = (&solution.attraction, own.in_passes());
        let cell = |k: usize| {
            let (z, h) = (solution.pressure[k], height(gap[k], k));
            let [open, wall] = if z > 0.0 { [0.0, z * h] } else { [h.max(0.0), 0.0] };
            [z - s[k], solution.potential[k] - image[k], open, wall]
        };
        let [energy, parts] = self.energy(modes.physical(motion), cell);
        let [pressed, square, touching] = rows.sum_terms(|k| {
            let (z, u) = (solution.pressure[k], c * solution.potential[k]);
            (z > 0.0).then_some([z * u, u * u, 1.0])
        });
        for_each_band([&mut *gap], |first, [gap]| {
            for (gap, k) in gap.iter_mut().zip(first..) {
                let h = if solution.pressure[k] > 0.0 { 0.0 } else { height(*gap, k).max(0.0) };
                *gap = if h.is_finite() { law.traction(h) } else { 0.0 };
            }
        });
        let changes = s.iter().zip(&*gap).map(|(s, g)| (g - s).abs());
        let change = changes.fold(0.0, f64::max) / law.traction(0.0);
        let displaced = (square / touching.max(1.0)).sqrt();
        Found { energy, scale: parts + pressed.abs() + f64::MIN_POSITIVE, change, displaced }
    }

    /// The energy over the area of a cell, and the sum of its parts, of a state with the free motion `motion`, from
    /// z − s, K (z − s), the gap and the work of the wall of a cell.
    fn energy(&self, motion: RigidMotion, cell: impl Fn(usize) -> [f64; 4] + Sync) -> [f64; 2] {
        let AttractedStep { state, wanted, law, given: [c, _], .. } = *self;
        let [elastic, attracted, wall] = state.held.region.rows().sum_terms(|k| {
            let [traction, potential, open, wall] = cell(k);
            open.is_finite().then(|| [0.5 * c * traction * potential, law.energy(open), wall])
        });
        let of_load = match self.step.loads[0] {
            Load::Force { .. } => -wanted.total * motion.at(wanted.point),
            Load::Spring { stiffness, drive, .. } => {
                let extended = drive - self.step.indenter.gap().datum - motion.approach;
                0.5 * stiffness * extended * extended / self.state.held.region.cell_area()
            }
            Load::Approach { .. } => 0.0,
        };
        [elastic - attracted - wall + of_load, elastic.abs() + attracted + of_load.abs()]
    }

    /// The free part of the motion of a state before the step.
    fn free_motion(&self, state: &Equilibrium) -> RigidMotion {
        let (RigidMotion { approach, tilt }, step) = (state.motions[0], self.step);
        let prescribed = step.request().prescribed(0);
        let free = |is_free: bool, value: f64| if is_free { value } else { 0.0 };
        RigidMotion {
            approach: free(self.wanted.translation, approach - step.indenter.gap().datum - prescribed.approach),
            tilt: [0, 1].map(|axis| free(self.wanted.tilt[axis], tilt[axis] - prescribed.tilt[axis])),
        }
    }

    /// The energy over the area of a cell, and the sum of its parts, of a state with the potential K (z − s), in the
    /// gap before any traction: the wall holds its cells while this gap changes by what a step begins with.
    fn energy_of(&self, solution: &Solution, motion: RigidMotion, gap: &[f64]) -> [f64; 2] {
        let (state, c) = (self.state, self.given[0]);
        let Solution { pressure, attraction, potential, .. } = solution;
        let cell = |k: usize| {
            let h = gap[k] + c * potential[k] - motion.at(state.held.region.center(k));
            let traction = pressure[k] - attraction[k];
            let [open, wall] = if pressure[k] > 0.0 { [0.0, traction * h] } else { [h.max(0.0), 0.0] };
            [traction, potential[k], open, wall]
        };
        self.energy(motion, cell)
    }

    /// Whether the contact was in no state before: without the attraction that its gap has.
    fn is_first(&self, trial: &Trial) -> bool {
        let AttractedStep { state, step, law, given: [c, _], .. } = *self;
        let Equilibrium { sum, ref motions, ref solution, .. } = state.held.current;
        let back = step.request().prescribed(0) + RigidMotion { approach: step.indenter.gap().datum, tilt: [0.0; 2] };
        let pulls = |k: usize| {
            let at = state.held.region.center(k);
            let h = trial.gap[k] + c * solution.potential[k] + back.at(at) - motions[0].at(at);
            h.is_finite() && law.traction(h.max(0.0)) > 0.0
        };
        sum == 0.0 && (0..trial.gap.len()).any(pulls)
    }

    /// What the energy bends up on the straight way between two states, in the gap of the trial: Σ(Δq cKΔq + k Δω²),
    /// and ΣΔs Δh of the attraction, over the area of a cell.
    fn bends_up(&self, gap: &[f64], [before, now]: [(&Solution, RigidMotion); 2]) -> [f64; 2] {
        let (state, law, c) = (self.state, self.law, self.given[0]);
        let [convex, softened] = state.held.region.rows().sum_terms(|k| {
            let at = state.held.region.center(k);
            let [h0, h1] = [before, now].map(|(solution, motion)| gap[k] + c * solution.potential[k] - motion.at(at));
            let attraction = |h: f64| law.traction(h.max(0.0));
            let [q0, q1] = [before, now].map(|(solution, _)| solution.pressure[k] - solution.attraction[k]);
            h0.is_finite().then(|| {
                let displaced = c * (now.0.potential[k] - before.0.potential[k]);
                [(q1 - q0) * displaced, (attraction(h1) - attraction(h0)) * (h1 - h0)]
            })
        });
        [convex + self.of_spring(now.1.approach - before.1.approach), softened]
    }

    /// By what part of its convex part the energy bends up in the direction of the last step. Beside a fold surfaces
    /// move along the mode that is soft, in which a small residual is a great error.
    pub(super) fn softness(&self, trial: &Trial) -> f64 {
        let ends = [&self.state.previous, &self.state.held.current];
        let [convex, softened] = self.bends_up(&trial.gap, ends.map(|at| (&at.solution, self.free_motion(at))));
        if convex > 0.0 { 1.0 + softened / convex } else { 1.0 }
    }

    /// The work of the spring on a way, over the area of a cell.
    fn of_spring(&self, moved: f64) -> f64 {
        if let Load::Spring { stiffness, .. } = self.step.loads[0] {
            stiffness / self.state.held.region.cell_area() * moved * moved
        } else {
            0.0
        }
    }

    /// Writes to the report what the step released, and whether the surfaces may have snapped.
    pub(super) fn report_release(&self, own: &mut Attracted, trial: &Trial) {
        let current = &self.state.held.current;
        let motion = self.state.held.region.modes(trial.free[0]).physical(trial.solution.motions[0]);
        let ends = [(&current.solution, self.free_motion(current)), (&trial.solution, motion)];
        let [[before, _], [now, scale]] = ends.map(|(solution, motion)| self.energy_of(solution, motion, &trial.gap));
        let [convex, softened] = self.bends_up(&trial.gap, ends);
        let report = &mut own.report;
        report.released = self.state.held.region.cell_area() * (before - now);
        report.unaccounted = report.released - 0.5 * self.state.held.region.cell_area() * (convex + softened);
        report.bend = 1.0 + softened / convex;
        let much = LEAST_RELEASED * scale.max(CELLS * self.law.energy(0.0));
        report.suspected = report.may_jump(self.state.held.region.cell_area() * much) && !self.is_first(trial);
    }
}

impl Descent<'_> {
    /// E over the area of a cell, and the sum of its parts.
    pub(super) fn energy(&self) -> [f64; 2] {
        let Descent { problem, balance, window, trial, .. } = self;
        let (x, q, gap) = (&trial.solution.potential, &trial.solution.attraction, &trial.gap);
        window.kernel.rows().sum_terms(|k| {
            let (h, stored) = (gap[k] + x[k], 0.5 * x[k] * (q[k] + balance.offset));
            let attracted = if h.is_finite() { problem.law.energy(h.max(0.0)) } else { 0.0 };
            Some([stored - attracted, stored.abs() + attracted + f64::MIN_POSITIVE])
        })
    }
}
