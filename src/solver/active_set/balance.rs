//! Balance of force and moments on the active set.

use super::{ActiveSet, RULES, Shape};
use crate::parallel::for_each_band;
use crate::solver::{Problem, ResidualSums, Solution, Solve, balance, cold_start, press_everywhere};

impl ActiveSet {
    /// Fills the shape of corrections on A.
    fn fill_shape(&mut self, shape: Shape, solution: &Solution) {
        self.shape.resize(solution.pressure.len(), 0.0);
        match shape {
            Shape::Pressure => self.shape.copy_from_slice(&solution.pressure),
            Shape::Punch => {
                self.shape.fill(1.0);
                self.preconditioner.gather(&mut self.shape, &self.set);
            }
        }
        // cells that join A before the correction is applied add nothing to it
        for (shape, &member) in self.shape.iter_mut().zip(&self.set.member) {
            *shape = if member { shape.max(0.0) } else { 0.0 };
        }
    }

    /// Makes the pressure on A carry the force and moments of each body: at once, by scaling p and v, where the force
    /// of a single body is the only load; else by the next direction. Where that cannot be, the last step is cut
    /// short, if it was a search, `searched` long; else the body begins again.
    pub(super) fn balance(&mut self, shape: Shape, searched: f64, solve: &mut Solve<'_>) -> Result<(), usize> {
        let problem = solve.problem;
        let single = problem.bodies.len() == 1;
        let pressed: f64 =
            (0..problem.bodies.len()).map(|body| self.set.sum(problem, body, &solve.solution.pressure)).sum();
        let all = if self.changes.leaving { problem.rows().sum(&solve.solution.pressure) } else { pressed };
        self.changes.moves = self.changes.leaving && (all - pressed).abs() < RULES.moved_share * pressed;
        let carried = if self.changes.moves { all } else { pressed };
        if !single || problem.bodies[0].tilts() {
            self.fill_shape(shape, solve.solution);
        }
        self.changes.corrections.fill(None);
        for body in problem.loaded_bodies().filter(|&body| problem.bodies[body].moves()) {
            let modes = problem.modes(body);
            if single && !modes.freedom.tilts() {
                let scale = problem.bodies[body].total / carried;
                if (scale - 1.0).abs() > f64::EPSILON {
                    for_each_band([&mut solve.solution.pressure, &mut solve.solution.potential], |_, [p, v]| {
                        p.iter_mut().for_each(|p| *p *= scale);
                        v.iter_mut().for_each(|v| *v *= scale);
                    });
                }
                continue;
            }
            let solution = &mut *solve.solution;
            let p = |k: usize| solution.pressure[k].max(0.0);
            if let Some(y) = self.set.balance(problem, body, p, |k| self.shape[k]) {
                // pressures that are moved change the moments, and the force of the bodies beside their own
                self.changes.corrections[body] = (self.changes.moves || y != Default::default()).then_some(y);
                continue;
            }
            // the load acts outside the hull of the cells that are left in A
            if searched > 0.0 && self.cut_step(problem, searched, solution) {
                return Ok(());
            }
            // begin again under this body
            for (k, p) in solution.pressure.iter_mut().enumerate() {
                if !self.set.member[k] && problem.owner(k) == body {
                    *p = 0.0;
                }
            }
            if !modes.freedom.translation {
                // the body is held at a pivot, and touches on one side of it only: without pressure it may turn away
                self.set.cells(problem, body).for_each(|k| solution.pressure[k] = 0.0);
            } else if shape == Shape::Punch {
                // the iterations may have begun from a cold start: another one could lead to the same state
                press_everywhere(problem, body, &mut self.set, solution);
            } else {
                cold_start(problem, body, &mut self.set, solution)?;
            }
            self.set.keep_pressed(problem, body, &solution.pressure);
            solve.convolve();
            self.changes.leaving = self.some_leave(problem, solve.solution);
            self.energy = 0.0;
        }
        Ok(())
    }

    /// Removes from a converged pressure the imbalance of force and moments that rounding has left: too little to
    /// change v. False if it is more than rounding.
    pub(super) fn close_balance(&mut self, solve: &mut Solve<'_>) -> bool {
        let Solve { problem, ref stop, ref mut solution, .. } = *solve;
        let is_small = |change: f64, carried: f64| change <= 1e-9 * carried;
        problem.loaded_bodies().all(|body| {
            let modes = problem.modes(body);
            if !modes.freedom.tilts() {
                let sum = |solution: &Solution| self.set.sum(problem, body, &solution.pressure);
                let carried = sum(solution);
                let closed = balance(problem, body, &self.set, solution);
                return !modes.freedom.translation || closed && is_small((sum(solution) - carried).abs(), carried);
            }
            let before = &mut self.buffer;
            before.copy_from_slice(&solution.pressure);
            let closed = balance(problem, body, &self.set, solution);
            let carried = self.set.sum_of(problem, body, |k| before[k]);
            // a pressure that cannot be balanced would have to be removed entirely
            let change = |k: usize| (solution.pressure[k] - before[k]).abs();
            let changed = if closed { self.set.sum_of(problem, body, change) } else { carried };
            if modes.freedom.translation {
                return closed && is_small(changed, carried);
            }
            // without a prescribed force, the whole pressure may be rounding: no cell moves more than by this
            let kernel = problem.kernel;
            let moved = problem.compliance * kernel.whole.self_influence() * kernel.images();
            let [unseen, rounding] = self.unseen(problem, stop.tolerance, solution);
            if moved * carried <= rounding {
                // the body is held by a touch
                self.set.cells(problem, body).for_each(|k| solution.pressure[k] = 0.0);
                if !problem.rows().any(solution.pressure.iter().any(|&p| p != 0.0)) {
                    solution.potential.fill(0.0);
                }
                return true;
            }
            moved * changed <= unseen
        })
    }

    /// The displacement that a residual below the tolerance may hide, and the rounding of the gap in it.
    fn unseen(&self, problem: &Problem<'_>, tolerance: f64, solution: &Solution) -> [f64; 2] {
        let square = self.set.sum_over_all(problem, |k| (problem.compliance * solution.potential[k]).powi(2));
        let cancellation = problem.displacement_rounding(&solution.pressure) + self.guess_rounding;
        let sums = ResidualSums { displacement: square, cancellation, ..ResidualSums::of(&self.set) };
        [tolerance * sums.yielding() + sums.gap_rounding(), sums.gap_rounding()]
    }
}
