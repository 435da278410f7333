//! From the state before a step to the guess of a descent in the gap, to its lift, and back to pressure and motion.

use super::AttractedStep;
use super::balance::Operators;
use super::descent::Descent;
use crate::equilibrium::Trial;
use crate::equilibrium::window::Window;
use crate::load::Load;
use crate::parallel::for_each_band;
use crate::solver::{ModeCoefficients, Solution};

impl AttractedStep<'_> {
    /// Writes z, s, K (z − s) and the motion of the guess of a descent: extrapolated, or of undeformed bodies, which
    /// just touch under a force.
    pub(super) fn begin_in_gap(&self, window: &Window, trial: &mut Trial) {
        let (state, step, rows) = (self.state, self.step, self.state.held.region.rows());
        self.open_gap(window, trial);
        trial.free[0] = self.wanted;
        self.extrapolate(trial);
        let datum = step.indenter.gap().datum;
        let motion = if state.is_undisturbed() {
            let lowest = rows.least(trial.gap.iter().fold(f64::INFINITY, |low, &h| low.min(h)));
            if let Load::Spring { drive, .. } = step.loads[0] { lowest.min(drive - datum) } else { lowest }
        } else {
            let [now, before] = [&state.held.current, &state.previous].map(|state| state.motions[0].approach);
            now + trial.reach * (now - before) - datum
        };
        trial.solution.motions[0] = ModeCoefficients([if self.wanted.translation { motion } else { 0.0 }, 0.0, 0.0]);
        if self.wanted.tilts() && !state.is_undisturbed() {
            let modes = state.held.region.modes(self.wanted);
            let [now, before] =
                [&state.held.current, &state.previous].map(|at| modes.coefficients(self.free_motion(at)));
            trial.solution.motions[0] = now.plus(trial.reach, now.plus(-1.0, before));
        }
    }
}

impl Descent<'_> {
    /// Writes the lift x of z, s, K (z − s) and the motion of the trial, and its q but for what the wall changes;
    /// returns whether that is so.
    pub(super) fn lift(&mut self) -> bool {
        let Descent { problem, operators: Operators { balance, .. }, trial, .. } = self;
        let (rows, Trial { gap, solution, .. }) = (problem.state.held.region.rows(), &mut **trial);
        let Solution { pressure, attraction: q, potential: x, motions, .. } = solution;
        let (c, motion, modes) = (balance.compliance, motions[0], problem.state.held.region.modes(problem.wanted));
        for_each_band([&mut *x, &mut *q], |first, [x, q]| {
            for (((x, q), z), k) in x.iter_mut().zip(q).zip(&pressure[first..]).zip(first..) {
                (*x, *q) = (c * *x - modes.displacement(motion, k), z - *q);
            }
        });
        let [of_x, of_q] = [&*x, &*q].map(|field| rows.sum(field) / field.len() as f64);
        let shift = balance.of_mean * of_x + balance.offset - of_q;
        q.iter_mut().for_each(|q| *q += shift);
        let mut opens = balance.tilts.is_some();
        // cells under pressure stay in contact
        for ((x, _), gap) in x.iter_mut().zip(&*pressure).zip(&*gap).filter(|((_, z), _)| **z > 0.0) {
            opens |= gap + *x != 0.0;
            *x = -gap;
        }
        balance.project(&rows, gap, x) || opens
    }

    /// From x and q of the trial its z, s and K (z − s), and its motion.
    pub(super) fn finish(&mut self, multiplier: f64) {
        let Descent { problem, operators: Operators { balance, .. }, trial, .. } = self;
        let (c, cells) = (balance.compliance, trial.gap.len() as f64);
        let rows = problem.state.held.region.rows();
        let Trial { solution, gap, .. } = &mut **trial;
        let (x, q) = (&mut solution.potential, &mut solution.attraction);
        q.iter_mut().for_each(|q| *q -= multiplier);
        let mean = |field: &[f64]| rows.sum(field) / cells;
        let motion = if problem.wanted.translation { c * balance.mean.compliance * mean(q) - mean(x) } else { 0.0 };
        let upright = ModeCoefficients([motion, 0.0, 0.0]);
        let motion = balance.tilts.as_ref().map_or(upright, |tilts| ModeCoefficients(tilts.motion(&rows, x, false)));
        let modes = problem.state.held.region.modes(problem.wanted);
        let greatest = problem.law.traction(0.0);
        for ((((x, q), z), gap), k) in x.iter_mut().zip(q).zip(&mut solution.pressure).zip(gap).zip(0..) {
            *z = if *gap + *x <= 0.0 { (*q + greatest).max(0.0) } else { 0.0 };
            (*x, *q) = ((*x + modes.displacement(motion, k)) / c, *z - *q);
        }
        solution.motions[0] = motion;
    }
}
