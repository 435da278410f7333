//! The energy of a pass, of the state before the step, and how the surfaces respond.

use super::{AttractedStep, Passes};
use crate::contact::step::request::Trial;
use crate::load::Load;
use crate::parallel::for_each_band;
use crate::solver::{RigidMotion, Solution};

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
    /// Energy and change of the pass; writes s at the gap that it led to in place of the gap of its problem. The energy is the value of the Lagrangian, in which
    /// the error of the pass enters with its square; the far field is a part of the gap.
    pub(super) fn find(&self, own: &Passes, trial: &mut Trial) -> Found {
        let AttractedStep { state, law, given: [c, _], .. } = *self;
        let (rows, solution, gap) = (state.region.rows(), &trial.solution, &mut trial.gap);
        let (modes, motion) = (state.region.modes(trial.free[0]), solution.motions[0]);
        let height = |gap: f64, k: usize| gap + c * solution.potential[k] - modes.displacement(motion, k);
        let (s, image) = (&solution.attraction, &own.image);
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

    /// The energy over the area of a cell, and the sum of its parts, of a state with the free motion `motion`, from z − s, K (z − s), the gap and the
    /// work of the wall of a cell.
    fn energy(&self, motion: RigidMotion, cell: impl Fn(usize) -> [f64; 4] + Sync) -> [f64; 2] {
        let AttractedStep { state, wanted, law, given: [c, _], .. } = *self;
        let [elastic, attracted, wall] = state.region.rows().sum_terms(|k| {
            let [traction, potential, open, wall] = cell(k);
            open.is_finite().then(|| [0.5 * c * traction * potential, law.energy(open), wall])
        });
        let of_load = match self.step.loads[0] {
            Load::Force { .. } => -wanted.total * motion.at(wanted.point),
            Load::Spring { stiffness, drive, .. } => {
                let extended = drive - self.step.indenter.gap().datum - motion.approach;
                0.5 * stiffness * extended * extended / self.area()
            }
            Load::Approach { .. } => 0.0,
        };
        [elastic - attracted - wall + of_load, elastic.abs() + attracted + of_load.abs()]
    }

    /// The energy over the area of a cell of the state before the step, under the load and the creep of its end.
    pub(super) fn energy_at_start(&self, trial: &Trial) -> f64 {
        let (state, step) = (self.state, self.step);
        let (RigidMotion { approach, tilt }, prescribed) = (state.current.motions[0], step.prescribed(0));
        let free = |is_free: bool, value: f64| if is_free { value } else { 0.0 };
        let motion = RigidMotion {
            approach: free(self.wanted.translation, approach - step.indenter.gap().datum - prescribed.approach),
            tilt: [0, 1].map(|axis| free(self.wanted.tilt[axis], tilt[axis] - prescribed.tilt[axis])),
        };
        // the wall of the state before holds its cells while the gap changes by what the step begins with
        self.energy_of(&state.current.solution, motion, &trial.gap)
    }

    /// The energy over the area of a cell at the end of the step.
    pub(super) fn energy_at_end(&self, trial: &Trial) -> f64 {
        let motion = self.state.region.modes(trial.free[0]).physical(trial.solution.motions[0]);
        self.energy_of(&trial.solution, motion, &trial.gap)
    }

    /// The energy of a state with the potential K (z − s), in the gap before any traction.
    fn energy_of(&self, solution: &Solution, motion: RigidMotion, gap: &[f64]) -> f64 {
        let (state, c) = (self.state, self.given[0]);
        let Solution { pressure, attraction, potential, .. } = solution;
        let cell = |k: usize| {
            let h = gap[k] + c * potential[k] - motion.at(state.region.center(k));
            let traction = pressure[k] - attraction[k];
            let [open, wall] = if pressure[k] > 0.0 { [0.0, traction * h] } else { [h.max(0.0), 0.0] };
            [traction, potential[k], open, wall]
        };
        self.energy(motion, cell)[0]
    }

    /// How the surfaces respond: of the change e of s from its guess, a first pass finds r, and e·e/(e·r) is 1/(1 − λ) for the rate λ of the
    /// passes.
    pub(super) fn response(&self, own: &Passes, trial: &Trial) -> f64 {
        let (state, reach, greatest) = (self.state, trial.reach, self.law.traction(0.0));
        if state.is_undisturbed() {
            return 1.0;
        }
        let [now, before] = [&state.current.solution.attraction, &state.previous.solution.attraction];
        let [square, first] = state.region.rows().sum_terms(|k| {
            let change = trial.solution.attraction[k] - (now[k] + reach * (now[k] - before[k]));
            Some([change * change, change * greatest * f64::from(own.first[k])])
        });
        let ratio = square / first;
        // no change has no ratio
        if ratio < 0.0 { f64::INFINITY } else { ratio.max(1.0) }
    }
}
