//! Which cells are in the active set.

use super::{ActiveSet, LEAVE_OVER_RMS, Shape};
use crate::kernel::Workspace;
use crate::solver::cold_start::cold_start;
use crate::solver::contact_cells;
use crate::solver::outcome::{ResidualSums, Stop};
use crate::solver::problem::{Problem, Solution};

impl ActiveSet {
    /// A = {p > 0}; other cells that carry pressure are to leave; the pressure on A is in balance. Fails with the body whose
    /// load no pressure can balance.
    pub(super) fn start(
        &mut self,
        problem: &Problem<'_>,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Result<(), usize> {
        self.search.energy = 0.0;
        let upright = self.is_upright(problem);
        if upright {
            let fields = solution.pressure.iter().zip(problem.gap);
            for (member, (&p, &gap)) in self.set.member.iter_mut().zip(fields) {
                *member = (p > 0.0) & (gap < f64::INFINITY);
            }
        } else {
            self.search.direction.fill(0.0);
            self.search.image.fill(0.0);
            for (k, (member, &p)) in self.set.member.iter_mut().zip(&solution.pressure).enumerate() {
                *member = p > 0.0 && problem.possible(k);
            }
        }
        self.list_cells(problem);
        let mut fresh = false;
        for (body, contact) in self.set.contacts.iter_mut().enumerate() {
            if contact.cells.is_empty() && (!upright || self.passes.runs.count() == 0) && !problem.released(body) {
                // a guess without positive pressure may hold negative ones, which v includes
                fresh |= solution.pressure.iter().any(|&p| p != 0.0);
                // K⁻¹ of a uniform displacement, but for its scale, is the pressure under a flat punch
                let sharpen = |cells: &[u32], solution: &mut Solution| {
                    let shape = &mut self.preconditioned;
                    shape.fill(0.0);
                    cells.iter().for_each(|&k| shape[k as usize] = solution.pressure[k as usize]);
                    self.preconditioner.apply(shape);
                    solution.counts.preconditioner_applications += 1;
                    let sum = |field: &[f64]| cells.iter().map(|&k| field[k as usize].max(0.0)).sum::<f64>();
                    let scale = sum(&solution.pressure) / sum(shape);
                    cells.iter().for_each(|&k| solution.pressure[k as usize] = scale * shape[k as usize].max(0.0));
                };
                if !cold_start(problem, body, &mut contact.cells, solution, sharpen) {
                    return Err(body);
                }
                contact.keep_pressed(problem.modes(body), &solution.pressure);
                contact.cells.iter().for_each(|&k| self.set.member[k as usize] = true);
                fresh |= !contact.cells.is_empty();
            }
        }
        if fresh {
            self.find_runs(problem);
            solution.convolve(problem, work);
        }
        self.changes.iter_mut().for_each(|change| change.leaving.clear());
        for (k, (&p, &member)) in solution.pressure.iter().zip(&self.set.member).enumerate() {
            if (p != 0.0) & !member {
                self.changes[problem.owner(k)].leaving.push(k as u32);
            }
        }
        self.balance(problem, Shape::Pressure, solution, work)
    }

    /// Whether the next direction has pressures to bring to zero or into balance.
    pub(super) fn pending(&self) -> bool {
        self.changes.iter().any(|change| !change.leaving.is_empty() || change.correction.is_some())
    }

    /// Finds the runs of cells in A.
    pub(super) fn find_runs(&mut self, problem: &Problem<'_>) {
        self.passes.runs.find(&self.set.member);
        self.set.greatest_gap = self.passes.runs.greatest(problem.gap);
    }

    /// Finds the runs of cells in A, and lists its cells unless the runs say it all.
    fn list_cells(&mut self, problem: &Problem<'_>) {
        if self.is_upright(problem) {
            self.find_runs(problem);
            self.set.contacts[0].cells.clear();
        } else {
            self.list_all_cells(problem);
        }
    }

    /// Finds the runs of cells in A, and lists its cells.
    pub(super) fn list_all_cells(&mut self, problem: &Problem<'_>) {
        self.find_runs(problem);
        contact_cells::list(problem, &mut self.set.contacts, self.passes.runs.ranges().flatten());
    }

    /// Takes cells into A that penetrate deeper than `least`, but for those that are about to leave: they would bring a
    /// negative pressure with them, and change the force.
    pub(super) fn add_penetrating_cells(&mut self, problem: &Problem<'_>, least: f64, solution: &Solution) {
        let upright = self.is_upright(problem);
        let (c, motion) = (problem.compliance, solution.motions[0].0[0]);
        for k in 0..self.set.member.len() {
            self.set.member[k] |= solution.pressure[k] == 0.0
                && if upright {
                    motion - (c * solution.potential[k] + problem.gap[k]) > least
                } else {
                    problem.possible(k) && problem.depth(solution, k) > least
                };
        }
        self.list_cells(problem);
    }

    /// Whether negative pressures are the larger part of the error, or all that is left of it.
    pub(super) fn should_remove_tensile(&self, problem: &Problem<'_>, stop: Stop, state: ResidualSums) -> bool {
        let equivalent_gap = problem.compliance / self.preconditioner.diagonal();
        let solved = state.square <= stop.tolerance * stop.tolerance * state.displacement;
        solved || equivalent_gap * equivalent_gap * state.negative > LEAVE_OVER_RMS * LEAVE_OVER_RMS * state.square
    }

    /// Takes cells with negative pressure out of A.
    pub(super) fn remove_tensile_cells(
        &mut self,
        problem: &Problem<'_>,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Result<(), usize> {
        if self.is_upright(problem) {
            for k in self.passes.runs.ranges().flatten().filter(|&k| solution.pressure[k] < 0.0) {
                self.set.member[k] = false;
                self.changes[0].leaving.push(k as u32);
            }
        } else {
            for (contact, change) in self.set.contacts.iter().zip(&mut self.changes) {
                for &k in contact.cells.iter().filter(|&&k| solution.pressure[k as usize] < 0.0) {
                    self.set.member[k as usize] = false;
                    change.leaving.push(k);
                }
            }
        }
        self.list_cells(problem);
        self.balance(problem, Shape::Punch, solution, work)
    }
}
