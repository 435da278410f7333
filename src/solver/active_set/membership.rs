//! Cells that enter and leave the active set.

use std::ops::Range;

use super::{ActiveSet, RULES, Shape};
use crate::parallel::for_each_band;
use crate::solver::{ContactSet, Passes, Problem, ResidualSums, Search, Solution, Solve, Stop, add, cold_start};

impl ActiveSet {
    /// Sets A to {p > 0}, or to the cells that are likely to be in contact, and balances the pressure on A. Other
    /// cells that carry pressure are to leave. Fails with the body whose load no pressure can balance.
    pub(super) fn start(&mut self, solve: &mut Solve<'_>) -> Result<(), usize> {
        let Solve { problem, solution, .. } = solve;
        (self.energy, self.search_length, self.was_cut) = (0.0, f64::INFINITY, false);
        for_each_band([&mut self.set.member], |first, [member]| {
            for (k, member) in (first..).zip(member) {
                let p = solution.pressure[k];
                *member = problem.possible(k) && problem.likely.map_or(p > 0.0, |likely| likely[k] && p >= 0.0);
            }
        });
        self.set.update(problem);
        let mut reset = false;
        for body in problem.loaded_bodies() {
            // cells that are likely to touch may carry no pressure yet
            let pressed = || self.set.sum(problem, body, &solution.pressure) > 0.0;
            let unloaded = self.set.count_under(body) == 0 || problem.likely.is_some() && !pressed();
            if !unloaded {
                continue;
            }
            // a guess without positive pressure may hold negative ones, which v includes
            reset |= problem.rows().any(solution.pressure.iter().any(|&p| p != 0.0));
            cold_start(problem, body, &mut self.set, solution)?;
            self.set.keep_pressed(problem, body, &solution.pressure);
            reset |= self.set.count_under(body) > 0;
        }
        if reset {
            solve.convolve();
        }
        self.changes.clear();
        self.changes.leaving = self.some_leave(solve.problem, solve.solution);
        self.balance(Shape::Pressure, 0.0, solve)
    }

    /// Whether cells outside A carry pressure.
    pub(super) fn some_leave(&self, problem: &Problem<'_>, solution: &Solution) -> bool {
        let pressed = |cells: Range<usize>| solution.pressure[cells].iter().any(|&p| p != 0.0);
        problem.rows().any(self.set.segments.outside(solution.pressure.len()).any(pressed))
    }

    /// Takes cells into A that penetrate deeper than `least`, except cells that are about to leave: their negative
    /// pressure would change the force.
    pub(super) fn add_penetrating_cells(&mut self, problem: &Problem<'_>, least: f64, solution: &Solution) {
        let ContactSet { member, segments, .. } = &mut self.set;
        Passes { problem, segments, bands: &mut self.bands }.add_penetrating(least, solution, member);
        self.set.update(problem);
    }

    /// Whether to remove cells of negative pressure: they dominate the residual, or (when `aggressive`) contribute a
    /// large share.
    pub(super) fn should_remove_tensile(
        &self,
        problem: &Problem<'_>,
        stop: Stop<'_>,
        state: ResidualSums,
        aggressive: bool,
    ) -> bool {
        let equivalent_gap = problem.compliance / self.preconditioner.diagonal;
        let solved = state.square <= stop.tolerance * stop.tolerance * state.displacement;
        let least = RULES.leave_over_rms * RULES.leave_over_rms * state.square;
        let large = equivalent_gap * equivalent_gap * state.negative > least;
        solved || aggressive && large
    }

    /// Takes cells with negative pressure out of A, and cells whose pressure becomes negative by the pressure that is
    /// moved to them. Where the others cannot carry the load, the last step is cut short instead, if it was a search,
    /// `searched` long.
    pub(super) fn remove_tensile_cells(&mut self, searched: f64, solve: &mut Solve<'_>) -> Result<(), usize> {
        let Solve { problem, solution, .. } = solve;
        self.changes.leaving = true;
        let ActiveSet { set, preconditioner, buffer: moved, .. } = self;
        set.segments.cells().for_each(|k| set.member[k] = solution.pressure[k] >= 0.0);
        set.update(problem);
        preconditioner.gather_outside(&solution.pressure, set, moved);
        set.segments.cells().for_each(|k| set.member[k] = solution.pressure[k] + moved[k] >= 0.0);
        set.update(problem);
        self.balance(Shape::Punch, searched, solve)
    }

    /// Goes back along the last direction, `step` long, to where the first pressure became zero: before that all
    /// pressures were in balance. False if some were negative all the while.
    pub(super) fn cut_step(&mut self, problem: &Problem<'_>, step: f64, solution: &mut Solution) -> bool {
        let Search { direction, image } = &self.search;
        let beyond = |p: f64, d: f64| if p < 0.0 { if d < 0.0 { p / d } else { f64::INFINITY } } else { 0.0 };
        let pairs = solution.pressure.iter().zip(direction);
        let back = problem.rows().greatest(pairs.fold(0.0_f64, |back, (&p, &d)| back.max(beyond(p, d))));
        if back > step * (1.0 + f64::EPSILON) {
            return false;
        }
        for ((p, &d), member) in solution.pressure.iter_mut().zip(direction).zip(&mut self.set.member) {
            let blocked = back > 0.0 && beyond(*p, d) == back;
            *member = (*member || *p != 0.0) && !blocked;
            *p = if blocked { 0.0 } else { *p - back * d };
        }
        add(&mut solution.potential, -back, image);
        self.energy = 0.0;
        self.changes.clear();
        self.was_cut = true;
        self.set.update(problem);
        true
    }
}
