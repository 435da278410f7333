//! Which cells are in the active set.

use std::ops::Range;

use super::{ActiveSet, LEAVE_OVER_RMS, Search, Shape};
use crate::kernel::Workspace;
use crate::parallel::for_each_band;
use crate::solver::cold_start::cold_start;
use crate::solver::contact_set::ContactSet;
use crate::solver::outcome::{ResidualSums, Stop};
use crate::solver::passes::{NUMBERS, add};
use crate::solver::problem::{Problem, Solution};
use crate::solver::row_segments::Piece;

impl ActiveSet {
    /// A = {p > 0}, or the cells that are likely to be in contact; other cells that carry pressure are to leave; the pressure
    /// on A is in balance. Fails with the body whose load no pressure can balance.
    pub(super) fn start(
        &mut self,
        problem: &Problem<'_>,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Result<(), usize> {
        (self.search.energy, self.search.length, self.was_cut) = (0.0, f64::INFINITY, false);
        for_each_band([&mut self.set.member], |first, [member]| {
            let fields = member.iter_mut().zip(solution.pressure[first..].iter().zip(&problem.gap[first..]));
            match problem.likely {
                None => fields.for_each(|(member, (&p, &gap))| *member = (p > 0.0) & (gap < f64::INFINITY)),
                Some(likely) => fields.zip(&likely[first..]).for_each(|((member, (&p, &gap)), &likely)| {
                    *member = likely & (p >= 0.0) & (gap < f64::INFINITY);
                }),
            }
        });
        if (0..problem.bodies.len()).any(|body| problem.released(body)) {
            let members = self.set.member.iter_mut().enumerate();
            members.for_each(|(k, member)| *member &= !problem.released(problem.owner(k)));
        }
        self.set.update(problem);
        let mut fresh = false;
        for body in 0..problem.bodies.len() {
            // cells that are likely to touch may carry nothing yet
            let pressed = || self.set.sum(problem, body, &solution.pressure) > 0.0;
            let bare = self.set.count_under(body) == 0 || problem.likely.is_some() && !pressed();
            if bare && !problem.released(body) {
                // a guess without positive pressure may hold negative ones, which v includes
                fresh |= problem.rows().any(solution.pressure.iter().any(|&p| p != 0.0));
                // K⁻¹ of a uniform displacement, but for its scale, is the pressure under a flat punch
                let sharpen = |set: &ContactSet, solution: &mut Solution| {
                    let shape = &mut self.preconditioned;
                    shape.fill(0.0);
                    let cells = || set.cells(problem, body);
                    cells().for_each(|k| shape[k] = solution.pressure[k]);
                    self.preconditioner.filter(shape, work);
                    solution.counts.preconditioner_applications += 1;
                    let sum = |field: &[f64]| set.sum_of(problem, body, |k| field[k].max(0.0));
                    let scale = sum(&solution.pressure) / sum(shape);
                    cells().for_each(|k| solution.pressure[k] = scale * shape[k].max(0.0));
                };
                if !cold_start(problem, body, &mut self.set, solution, sharpen) {
                    return Err(body);
                }
                self.set.keep_pressed(problem, body, &solution.pressure);
                fresh |= self.set.count_under(body) > 0;
            }
        }
        if fresh {
            solution.convolve(problem, work);
        }
        self.changes.clear();
        self.changes.leaving = self.some_leave(problem, solution);
        self.balance(problem, Shape::Pressure, 0.0, solution, work)
    }

    /// Whether cells outside A carry pressure.
    pub(super) fn some_leave(&self, problem: &Problem<'_>, solution: &Solution) -> bool {
        let pressed = |cells: Range<usize>| solution.pressure[cells].iter().any(|&p| p != 0.0);
        problem.rows().any(self.set.runs.outside(solution.pressure.len()).any(pressed))
    }

    /// Takes cells into A that penetrate deeper than `least`, except cells that are about to leave: they would bring a
    /// negative pressure with them, and change the force.
    pub(super) fn add_penetrating_cells(&mut self, problem: &Problem<'_>, least: f64, solution: &Solution) {
        let c = problem.compliance;
        let ContactSet { member, runs, .. } = &mut self.set;
        let joins = |p: f64, v: f64, h: f64, motion: f64| (p == 0.0) & (motion - (c * v + h) > least);
        for_each_band([member], |first, [member]| {
            runs.walk(&(first..first + member.len()), problem.cut(), |Piece { cells, body }, inside| {
                if inside || problem.released(body) {
                    return;
                }
                let [start, slope] = problem.line(body, cells.start).of(solution.motions[body]);
                let member = &mut member[cells.start - first..cells.end - first];
                let fields = solution.potential[cells.clone()].iter().zip(&problem.gap[cells.clone()]);
                let values = member.iter_mut().zip(&solution.pressure[cells]).zip(fields);
                if slope == 0.0 {
                    values.for_each(|((member, &p), (&v, &h))| *member = joins(p, v, h, start));
                } else {
                    let values = values.zip(&NUMBERS);
                    values.for_each(|(((member, &p), (&v, &h)), &j)| *member = joins(p, v, h, start + slope * j));
                }
            });
        });
        self.set.update(problem);
    }

    /// Whether negative pressures are all that is left of the error, or, unless it is `hasty` to remove them, a large part of it.
    pub(super) fn should_remove_tensile(
        &self,
        problem: &Problem<'_>,
        stop: Stop,
        state: ResidualSums,
        hasty: bool,
    ) -> bool {
        let equivalent_gap = problem.compliance / self.preconditioner.diagonal();
        let solved = state.square <= stop.tolerance * stop.tolerance * state.displacement;
        let large = equivalent_gap * equivalent_gap * state.negative > LEAVE_OVER_RMS * LEAVE_OVER_RMS * state.square;
        solved || !hasty && large
    }

    /// Takes cells with negative pressure out of A, and those whose pressure becomes negative by what the first leave to them.
    /// Where the others cannot carry the load, the last step is cut short instead, if it was a search, `searched` long.
    pub(super) fn remove_tensile_cells(
        &mut self,
        problem: &Problem<'_>,
        searched: f64,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Result<(), usize> {
        self.changes.leaving = true;
        self.set.runs.cells().for_each(|k| self.set.member[k] = solution.pressure[k] >= 0.0);
        self.set.update(problem);
        self.move_leaving(solution);
        let next = |k: usize| solution.pressure[k] + self.preconditioned[k];
        self.set.runs.cells().for_each(|k| self.set.member[k] = next(k) >= 0.0);
        self.set.update(problem);
        self.balance(problem, Shape::Punch, searched, solution, work)
    }

    /// Goes back along the last direction, `step` long, to where the first pressure became zero: before that all pressures
    /// were in balance. False if some were negative all the while.
    pub(super) fn cut_step(&mut self, problem: &Problem<'_>, step: f64, solution: &mut Solution) -> bool {
        let Search { direction, image, energy, .. } = &mut self.search;
        let beyond = |p: f64, d: f64| if p < 0.0 { if d < 0.0 { p / d } else { f64::INFINITY } } else { 0.0 };
        let pairs = solution.pressure.iter().zip(&*direction);
        let back = problem.rows().greatest(pairs.fold(0.0_f64, |back, (&p, &d)| back.max(beyond(p, d))));
        if back > step * (1.0 + f64::EPSILON) {
            return false;
        }
        for ((p, &d), member) in solution.pressure.iter_mut().zip(&*direction).zip(&mut self.set.member) {
            let blocked = back > 0.0 && beyond(*p, d) == back;
            *member = (*member || *p != 0.0) && !blocked;
            *p = if blocked { 0.0 } else { *p - back * d };
        }
        add(&mut solution.potential, -back, image);
        *energy = 0.0;
        self.changes.clear();
        self.was_cut = true;
        self.set.update(problem);
        true
    }

    /// Writes what the pressures that leave bring to the cells of A around to `preconditioned`.
    pub(super) fn move_leaving(&mut self, solution: &Solution) {
        self.preconditioned.copy_from_slice(&solution.pressure);
        self.set.runs.cells().for_each(|k| self.preconditioned[k] = 0.0);
        self.preconditioner.gather(&mut self.preconditioned, &self.set);
    }
}
