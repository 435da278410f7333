//! The energy of an iteration in the gap and of the state before the step.

use super::balance::Operators;
use super::descent::{Descent, Energy};
use super::{Attracted, AttractedStep, PassReport};
use crate::equilibrium::Equilibrium;
use crate::equilibrium::Trial;
use crate::load::Load;
use crate::solver::{RigidMotion, Solution};

impl AttractedStep<'_> {
    /// The energy of a state with the free motion `motion`, from z − s, K (z − s), the gap and the work of the wall of
    /// a cell.
    fn energy(&self, motion: RigidMotion, cell: impl Fn(usize) -> [f64; 4] + Sync) -> Energy {
        let AttractedStep { state, wanted, law, compliance: c, .. } = *self;
        let [elastic, attracted, wall] = state.held.region.rows().sum_terms(|k| {
            let [traction, potential, open, wall] = cell(k);
            open.is_finite().then(|| [0.5 * c * traction * potential, law.energy(open), wall])
        });
        let of_load = match self.step.loads[0] {
            Load::Force { .. } => -wanted.total * motion.at(wanted.point),
            Load::Spring { stiffness, drive, .. } => {
                let extended = drive - self.step.indenter.gap().datum - motion.at(wanted.point);
                0.5 * stiffness * extended * extended / self.state.held.region.cell_area()
            }
            Load::Approach { .. } => 0.0,
        };
        let scale = elastic.abs() + attracted + of_load.abs();
        Energy { value: elastic - attracted - wall + of_load, scale }
    }

    /// The free part of the motion of a state before the step.
    pub(super) fn free_motion(&self, state: &Equilibrium) -> RigidMotion {
        let (RigidMotion { approach, tilt }, step) = (state.motions[0], self.step);
        let prescribed = step.request().prescribed(0);
        let free = |axis: usize| if self.wanted.tilt[axis] { tilt[axis] - prescribed.tilt[axis] } else { 0.0 };
        let tilt = [free(0), free(1)];
        let approach = if self.wanted.translation {
            approach - step.indenter.gap().datum - prescribed.approach
        } else {
            // about the load point, which stays where it is
            -(tilt[0] * self.wanted.point[0] + tilt[1] * self.wanted.point[1])
        };
        RigidMotion { approach, tilt }
    }

    /// The energy of a state with the potential K (z − s), in the gap before any traction: the wall holds its cells while this gap changes by what a step begins with.
    fn energy_of(&self, solution: &Solution, motion: RigidMotion, gap: &[f64]) -> Energy {
        let (state, c) = (self.state, self.compliance);
        let Solution { pressure, attraction, potential, .. } = solution;
        let cell = |k: usize| {
            let h = gap[k] + c * potential[k] - motion.at(state.held.region.center(k));
            let traction = pressure[k] - attraction[k];
            let [open, wall] = if pressure[k] > 0.0 { [0.0, traction * h] } else { [h.max(0.0), 0.0] };
            [traction, potential[k], open, wall]
        };
        self.energy(motion, cell)
    }

    /// Whether the attraction of the gap has never acted: a first step of bodies within its range, which is no jump
    /// whatever it releases.
    fn is_first(&self, trial: &Trial) -> bool {
        let AttractedStep { state, step, law, compliance: c, .. } = *self;
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
        let (state, law, c) = (self.state, self.law, self.compliance);
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
        let at_spring = |motion: RigidMotion| motion.at(self.wanted.point);
        [convex + self.of_spring(at_spring(now.1) - at_spring(before.1)), softened]
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
        let [before, now] = ends.map(|(solution, motion)| self.energy_of(solution, motion, &trial.gap));
        let [convex, softened] = self.bends_up(&trial.gap, ends);
        let report = &mut own.report;
        report.released = self.state.held.region.cell_area() * (before.value - now.value);
        report.unaccounted = report.released - 0.5 * self.state.held.region.cell_area() * (convex + softened);
        report.bend = 1.0 + softened / convex;
        let much = PassReport::noticed(now.scale, self.law.energy(0.0));
        report.suspected = report.may_jump(self.state.held.region.cell_area() * much) && !self.is_first(trial);
    }
}

impl Descent<'_> {
    /// E of the trial.
    pub(super) fn energy(&self) -> Energy {
        let Descent { problem, operators: Operators { balance, window, .. }, trial, .. } = self;
        let (x, q, gap) = (&trial.solution.potential, &trial.solution.attraction, &trial.gap);
        let [value, scale] = window.kernel.rows().sum_terms(|k| {
            let (h, stored) = (gap[k] + x[k], 0.5 * x[k] * (q[k] + balance.offset_at(k)));
            let attracted = if h.is_finite() { problem.law.energy(h.max(0.0)) } else { 0.0 };
            Some([stored - attracted, stored.abs() + attracted + f64::MIN_POSITIVE])
        });
        Energy { value, scale }
    }
}
