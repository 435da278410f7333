//! Where the search for a state of contact begins.

use super::contact_problem::{FoundMotion, SlidingProblem};
use super::operator::MovingBodies;
use crate::Grid;
use crate::solver::Freedom;

/// Bodies that are periodic along both axes are first solved on half as many cells along each axis, down to so many
/// at least. (A body that ends is padded in its response.)
const COARSEST: usize = 128;
/// Residual allowed there.
const ROUGHLY: f64 = 1e-3;

impl SlidingProblem<'_> {
    /// The state, from the state of a coarser mesh, else from the pressure `before`, else from the state of the
    /// symmetric part of the response: in slow motion a set would grow by one row of cells at a time.
    pub(super) fn search(&self, bodies: &mut MovingBodies, before: &[f64]) -> FoundMotion {
        let coarse = self.on_coarser(bodies, before);
        let first = coarse.as_deref().unwrap_or(before);
        let mut sets = 0;
        if first.iter().any(|&p| p > 0.0) {
            let found = self.solve(bodies, first);
            if found.converged {
                return found;
            }
            sets += found.sets;
        }
        // not from the state before: a start that fails is left
        let mut symmetric = bodies.symmetric();
        let start = self.solve(&mut symmetric, &vec![0.0; before.len()]);
        bodies.transforms += symmetric.transforms;
        let found = self.solve(bodies, &start.pressure);
        FoundMotion { sets: sets + start.sets + found.sets, ..found }
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
        let problem = SlidingProblem { grid: &grid, gap: &gap, free, tolerance: self.tolerance.max(ROUGHLY), ..*self };
        let found = problem.search(&mut coarser, &mean(before));
        bodies.transforms += coarser.transforms.div_ceil(4);
        Some((0..before.len()).map(|k| found.pressure[coarse_of(k)]).collect())
    }
}
