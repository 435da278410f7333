//! Balance of force and moments on the active set.

use super::{ActiveSet, Shape};
use crate::kernel::Workspace;
use crate::solver::cold_start::{balance, cold_start, press_everywhere};
use crate::solver::problem::{Problem, Solution};

/// Change of the force by which a converged pressure may be closed.
const MAX_CLOSING_FORCE_CHANGE: f64 = 1e-9;

impl ActiveSet {
    /// Fills the shape of corrections on A.
    fn fill_shape(&mut self, shape: Shape, solution: &mut Solution) {
        self.shape.resize(self.set.member.len(), 0.0);
        match shape {
            Shape::Pressure => self.shape.copy_from_slice(&solution.pressure),
            Shape::Punch => {
                self.shape
                    .iter_mut()
                    .zip(&self.set.member)
                    .for_each(|(shape, &member)| *shape = f64::from(u8::from(member)));
                self.preconditioner.apply(&mut self.shape);
                solution.counts.preconditioner_applications += 1;
            }
        }
        // cells that join A before the correction is applied add nothing to it
        for (shape, &member) in self.shape.iter_mut().zip(&self.set.member) {
            *shape = if member { shape.max(0.0) } else { 0.0 };
        }
    }

    /// Makes the pressure on A carry the force and moments of each body: at once, by scaling p and v, where the force of a
    /// single body is the only load; else by the next direction.
    pub(super) fn balance(
        &mut self,
        problem: &Problem<'_>,
        shape: Shape,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Result<(), usize> {
        let single = self.set.contacts.len() == 1;
        if !single || problem.modes(0).tilts() {
            self.fill_shape(shape, solution);
        }
        for body in 0..self.set.contacts.len() {
            let (contact, change, modes) = (&mut self.set.contacts[body], &mut self.changes[body], problem.modes(body));
            change.correction = None;
            if problem.released(body) || !(modes.translates() || modes.tilts()) {
                continue;
            }
            if single && !modes.tilts() {
                let scale = problem.bodies[body].total / self.passes.runs.sum(&solution.pressure);
                if scale != 1.0 {
                    solution.pressure.iter_mut().for_each(|p| *p *= scale);
                    solution.potential.iter_mut().for_each(|v| *v *= scale);
                }
                continue;
            }
            let p = |k: usize| solution.pressure[k].max(0.0);
            if let Some(y) = modes.balance(&contact.cells, p, |k| self.shape[k]) {
                change.correction = (y != Default::default()).then_some(y);
                continue;
            }
            // the load acts outside the hull of what is left of A: begin again under this body
            contact.cells.iter().for_each(|&k| self.set.member[k as usize] = false);
            change.leaving.drain(..).for_each(|k| solution.pressure[k as usize] = 0.0);
            if !modes.translates() {
                // held at a pivot, and touching on one side of it only: unloaded, it may turn away
                contact.cells.iter().for_each(|&k| solution.pressure[k as usize] = 0.0);
            } else if shape == Shape::Punch {
                // the iterations may have begun from a cold start: another one could lead to the same state
                press_everywhere(problem, body, &mut contact.cells, solution);
            } else if !cold_start(problem, body, &mut contact.cells, solution, |_, _| ()) {
                return Err(body);
            }
            contact.keep_pressed(modes, &solution.pressure);
            contact.cells.iter().for_each(|&k| self.set.member[k as usize] = true);
            self.find_runs(problem);
            solution.convolve(problem, work);
        }
        Ok(())
    }

    /// Removes from a converged pressure the imbalance of force and moments that rounding has left: too little to show in v.
    /// False if it is more than rounding.
    pub(super) fn close_balance(&self, problem: &Problem<'_>, solution: &mut Solution) -> bool {
        if self.is_upright(problem) {
            if problem.modes(0).translates() {
                let scale = problem.bodies[0].total / self.passes.runs.sum(&solution.pressure);
                for run in self.passes.runs.ranges() {
                    solution.pressure[run].iter_mut().for_each(|p| *p *= scale);
                }
                return (scale - 1.0).abs() <= MAX_CLOSING_FORCE_CHANGE;
            }
            return true;
        }
        for (body, contact) in self.set.contacts.iter().enumerate().filter(|(body, _)| !problem.released(*body)) {
            let sum = |solution: &Solution| contact.cells.iter().map(|&k| solution.pressure[k as usize]).sum::<f64>();
            let before = sum(solution);
            let closed = balance(problem, body, &contact.cells, solution);
            // where no force is prescribed, the pressure may be rounding itself
            let forced = problem.modes(body).translates();
            if forced && (!closed || (sum(solution) - before).abs() > MAX_CLOSING_FORCE_CHANGE * before) {
                return false;
            }
        }
        true
    }
}
