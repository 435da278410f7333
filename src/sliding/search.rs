//! Where the search for a state of contact begins.

use num_complex::Complex64;

use super::contact_problem::{Found, Problem};
use super::operator::MovingBodies;
use crate::Grid;
use crate::error::Result;
use crate::solver::Freedom;

/// Bodies that are periodic along both axes are first solved on half as many cells along each axis, down to so many at least.
const COARSEST: usize = 128;
/// Residual allowed there.
const ROUGHLY: f64 = 1e-3;
/// The skew-symmetric part of the response grows by no less than this.
const LEAST_STEP: f64 = 1e-3;

/// A coarser mesh: what all velocities share of it, and the bodies of the last of them.
#[derive(Debug)]
pub(super) struct Mesh {
    grid: Grid,
    bodies: MovingBodies,
}

impl Mesh {
    /// Meshes of half as many cells along each axis as the mesh before, of bodies that are periodic along both axes. (A body that ends is padded in its response.)
    pub(super) fn coarser(grid: &Grid, periodic: [bool; 2]) -> Result<Vec<Mesh>> {
        let (mut meshes, mut cells) = (Vec::new(), grid.cells());
        while periodic == [true; 2] && cells.iter().all(|n| n % 2 == 0 && n / 2 >= COARSEST) {
            cells = cells.map(|n| n / 2);
            let bodies = MovingBodies::of_waves(cells, Vec::new(), Default::default());
            meshes.push(Mesh { grid: Grid::new(cells, grid.lengths())?, bodies });
        }
        Ok(meshes)
    }
}

impl Problem<'_> {
    /// The state, from the state of a coarser mesh, else from the pressure `before`, else from the state of the symmetric part of the response: in slow
    /// motion a set would grow by one row of cells at a time. Where sets come back, the skew-symmetric part grows in steps.
    pub(super) fn search(&self, bodies: &mut MovingBodies, meshes: &mut [Mesh], before: &[f64]) -> Found {
        let coarse = self.on_coarser(bodies, meshes, before);
        let first = coarse.as_deref().unwrap_or(before);
        let found = first.iter().any(|&p| p > 0.0).then(|| self.solve(bodies, first));
        if let Some(found) = found.filter(|found| found.converged) {
            return found;
        }
        let mut solve = |skew: f64, from: &[f64]| {
            if skew == 1.0 {
                return self.solve(bodies, from);
            }
            let mut less = bodies.with_skew(skew);
            let found = self.solve(&mut less, from);
            bodies.response.pairs += less.transforms();
            found
        };
        let (mut last, mut reached, mut step) = (solve(0.0, before), 0.0, 1.0);
        let mut sets = last.sets;
        loop {
            let skew = f64::min(reached + step, 1.0);
            let found = solve(skew, &last.pressure);
            sets += found.sets;
            if found.converged && skew < 1.0 {
                (last, reached, step) = (found, skew, 2.0 * step);
            } else if found.converged || step <= LEAST_STEP || self.watch.has_ended() {
                return Found { sets, ..found };
            } else {
                step *= 0.25;
            }
        }
    }

    /// The pressure on the first of the coarser `meshes`, spread over the cells of this grid. Its transforms count by their cells.
    fn on_coarser(&self, bodies: &mut MovingBodies, meshes: &mut [Mesh], before: &[f64]) -> Option<Vec<f64>> {
        let (mesh, coarser) = meshes.split_first_mut()?;
        let [_, n2] = self.grid.cells();
        let coarse_of = |k: usize| k / n2 / 2 * (n2 / 2) + k % n2 / 2;
        let mean = |field: &[f64]| {
            let mut coarse = vec![0.0; mesh.grid.len()];
            field.iter().enumerate().for_each(|(k, value)| coarse[coarse_of(k)] += 0.25 * value);
            coarse
        };
        bodies.long_waves(&mut mesh.bodies);
        let (gap, tolerance) = (mean(self.gap), self.tolerance.max(ROUGHLY));
        let free = Freedom { total: 0.25 * self.free.total, ..self.free };
        let problem = Problem { grid: &mesh.grid, gap: &gap, free, tolerance, watch: self.watch };
        let found = problem.search(&mut mesh.bodies, coarser, &mean(before));
        bodies.response.pairs += mesh.bodies.transforms().div_ceil(4);
        Some((0..before.len()).map(|k| found.pressure[coarse_of(k)]).collect())
    }
}

impl MovingBodies {
    /// Writes the long waves of bodies that are periodic along both axes to bodies on half as many cells along each axis.
    fn long_waves(&self, coarse: &mut MovingBodies) {
        let ([n1, _], [m1, m2]) = (self.response.cells, coarse.response.cells);
        let waves = (0..=m2 / 2).flat_map(|k2| (0..m1).map(move |k1| [k1, k2]));
        let factors = waves.map(|[k1, k2]| {
            let factor = self.response.factors[k2 * n1 + if 2 * k1 > m1 { n1 - m1 + k1 } else { k1 }];
            // a wave of alternating cells moves both ways
            let both = 2 * k1 == m1 || 2 * k2 == m2;
            if both { Complex64::from(factor.re) } else { factor }
        });
        coarse.set_waves(factors.collect());
    }
}
