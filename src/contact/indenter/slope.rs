//! Slopes of the undeformed bodies in contact.

use crate::Grid;
use crate::contact::{Indenter, Region};

/// Slopes beyond this are not small. Where the paraboloid of a sphere is this steep, the sphere itself is 7 % deeper.
const STEEP: f64 = 0.5;

impl Indenter {
    /// Greatest slope of the gap on the cells of a region that carry `pressure`, if it is steep. `None` on ranks, which have no
    /// neighbours beyond their rows.
    pub(crate) fn steepest(&self, grid: &Grid, region: &Region, pressure: &[f64]) -> Option<f64> {
        let n2 = grid.cells()[1];
        let is_steep = || (0..grid.len()).any(|k| self.squared_slope(grid, [k / n2, k % n2]) > STEEP * STEEP);
        // most indenters are steep nowhere, and steps need not look again
        if self.is_local || !*self.is_steep.get_or_init(is_steep) {
            return None;
        }
        let in_contact = (0..pressure.len()).filter(|&k| pressure[k] > 0.0);
        let greatest = in_contact.map(|k| self.squared_slope(grid, region.cell(k))).fold(0.0, f64::max);
        (greatest > STEEP * STEEP).then(|| greatest.sqrt())
    }

    /// Square of the slope of the gap in a cell: along each axis the lesser of the slopes to both neighbours on the same body.
    fn squared_slope(&self, grid: &Grid, cell: [usize; 2]) -> f64 {
        let ([_, n2], gap) = (grid.cells(), &self.gap);
        let k = cell[0] * n2 + cell[1];
        let along = |axis: usize| {
            let stride = [n2, 1][axis];
            let back = (cell[axis] > 0).then(|| k - stride);
            let on = (cell[axis] + 1 < grid.cells()[axis]).then(|| k + stride);
            let sides = [back, on].into_iter().flatten().filter(|&side| gap.owner(side) == gap.owner(k));
            let rises = sides.map(|side| (gap.above[side] - gap.above[k]).abs()).filter(|rise| rise.is_finite());
            rises.reduce(f64::min).unwrap_or(0.0) / grid.spacing()[axis]
        };
        along(0).powi(2) + along(1).powi(2)
    }
}
