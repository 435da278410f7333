//! Where the search for a state of contact begins.

use super::contact_problem::{Found, Problem};
use super::operator::MovingBodies;
use crate::Grid;
use crate::solver::Freedom;

/// Bodies that are periodic along both axes are first solved on half as many cells along each axis, down to so many at least. (A body that ends is padded in its
/// response.)
const COARSEST: usize = 128;
/// Residual allowed there.
const ROUGHLY: f64 = 1e-3;
/// The skew-symmetric part of the response grows by no less than this.
const LEAST_STEP: f64 = 1e-3;

impl Problem<'_> {
    /// The state, from the state of a coarser mesh, else from the pressure `before`, else from the state of the symmetric part of the response: in slow
    /// motion a set would grow by one row of cells at a time. Where sets come back, the skew-symmetric part grows in steps.
    pub(super) fn search(&self, bodies: &mut MovingBodies, before: &[f64]) -> Found {
        let coarse = self.on_coarser(bodies, before);
        let first = coarse.as_deref().unwrap_or(before);
        let found = first.iter().any(|&p| p > 0.0).then(|| self.solve(bodies, first));
        let mut sets = match found {
            Some(found) if found.converged => return found,
            found => found.map_or(0, |found| found.sets),
        };
        let mut solve = |skew: f64, from: &[f64]| {
            if skew == 1.0 {
                return self.solve(bodies, from);
            }
            let mut less = bodies.with_skew(skew);
            let found = self.solve(&mut less, from);
            bodies.transforms += less.transforms;
            found
        };
        // not from the state before: a start that fails is left
        let (mut last, mut reached, mut step) = (solve(0.0, &vec![0.0; before.len()]), 0.0, 1.0);
        sets += last.sets;
        loop {
            let skew = f64::min(reached + step, 1.0);
            let found = solve(skew, &last.pressure);
            sets += found.sets;
            if found.converged && skew < 1.0 {
                (last, reached, step) = (found, skew, 2.0 * step);
            } else if found.converged || step <= LEAST_STEP || self.is_cancelled() {
                return Found { sets, ..found };
            } else {
                step *= 0.25;
            }
        }
    }

    /// The pressure on a coarser mesh, spread over the cells of this grid. Its transforms count by their cells.
    fn on_coarser(&self, bodies: &mut MovingBodies, before: &[f64]) -> Option<Vec<f64>> {
        let cells @ [_, n2] = self.grid.cells();
        if !bodies.are_periodic() || cells.iter().any(|n| n % 2 == 1 || n / 2 < COARSEST) {
            return None;
        }
        let grid = Grid::of_spacing(cells.map(|n| n / 2), self.grid.spacing().map(|side| 2.0 * side));
        let coarse_of = |k: usize| k / n2 / 2 * (n2 / 2) + k % n2 / 2;
        let mean = |field: &[f64]| {
            let mut coarse = vec![0.0; grid.len()];
            field.iter().enumerate().for_each(|(k, value)| coarse[coarse_of(k)] += 0.25 * value);
            coarse
        };
        let (mut coarser, gap) = (bodies.coarser(), mean(self.gap));
        let free = Freedom { total: 0.25 * self.free.total, ..self.free };
        let problem = Problem { grid: &grid, gap: &gap, free, tolerance: self.tolerance.max(ROUGHLY), ..*self };
        let found = problem.search(&mut coarser, &mean(before));
        bodies.transforms += coarser.transforms.div_ceil(4);
        Some((0..before.len()).map(|k| found.pressure[coarse_of(k)]).collect())
    }
}
