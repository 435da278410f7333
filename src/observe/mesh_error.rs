//! Error due to the mesh.

use std::fmt;
use std::ops::Range;

use crate::contact::Extent;
use crate::observe::area::Pressed;
use crate::sum::sum;

/// Estimated relative errors of a state due to the width of its cells, made by
/// [`ViscoelasticContact::mesh_error`](crate::ViscoelasticContact::mesh_error). Typical sizes, not bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshError {
    /// Of the approach, or of the force where the approach is given.
    pub approach: f64,
    /// Of the greatest pressure of a smooth contact; the pressure at the rim of a punch is infinite and has none.
    pub max_pressure: f64,
    /// Of the contact area.
    pub area: f64,
    /// The part of the approach's error that is of first order in the cell width: that of singular edges. The rest is of
    /// second order.
    pub singular: f64,
}

/// The share of the force on the rim of a smooth contact is this times (rim cells/2 cells)^(3/2): 2.3 for spheres, 1.6
/// for cones.
const SMOOTH_SHARE: f64 = 2.3;
/// Errors over (share of the rim)·√(rim cells/2 cells), as measured on spheres, ellipsoids, cones and punches of 12 to 200
/// cells across: approach of smooth contacts (0.02 … 0.04), of singular ones (0.10 … 0.15), peak pressure (0.11 … 0.14 below 24 cells).
const SMOOTH_APPROACH: f64 = 0.035;
const SINGULAR_APPROACH: f64 = 0.13;
const PEAK: f64 = 0.12;
/// Pressure of the rim over that of the mean cell, above which the edge counts as singular: 1.8 and more under punches.
const SINGULAR: f64 = 1.4;
/// Error of the area, 0.13 (rim cells/2 cells)^1.2 on spheres.
const AREA: f64 = 0.13;
const AREA_ORDER: f64 = 1.2;

/// So many cells of a row are looked at together.
const PIECE: usize = 16;

impl MeshError {
    /// The greater of each error.
    pub(crate) fn max(self, other: MeshError) -> MeshError {
        MeshError {
            approach: self.approach.max(other.approach),
            max_pressure: self.max_pressure.max(other.max_pressure),
            area: self.area.max(other.area),
            singular: self.singular.max(other.singular),
        }
    }
}

/// One line: `approach 1.0e-3, pressure 3.4e-3, area 2.1e-3`.
impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MeshError { approach, max_pressure, area, .. } = self;
        write!(f, "approach {approach:.1e}, pressure {max_pressure:.1e}, area {area:.1e}")
    }
}

impl Pressed<'_> {
    /// The errors due to the mesh, estimated from the cells on the rim of a contact of so many cells; none without a rim.
    pub(crate) fn mesh_error(&self, contact_cells: usize) -> Option<MeshError> {
        let Extent { low, high } = self.extent?;
        let n2 = self.grid.cells()[1];
        let row = |i: usize| &self.pressure[i * n2 + low[1]..=i * n2 + high[1]];
        let total: f64 = (low[0]..=high[0]).map(|i| sum(row(i))).sum();
        let (rim_cells, rim) = self.rim(low, high);
        if total == 0.0 || rim_cells == 0 {
            return None;
        }
        let (share, delta) = (rim / total, rim_cells as f64 / (2 * contact_cells) as f64);
        let smooth = share.min(SMOOTH_SHARE * delta.powf(1.5)) * delta.sqrt();
        // at a singular edge the pressure rises to the rim; creep raises it towards a growing rim, but lets it fall there
        let rises = rim / rim_cells as f64 > SINGULAR * total / contact_cells as f64;
        let singular = if rises { SINGULAR_APPROACH * (share * delta.sqrt() - smooth) } else { 0.0 };
        Some(MeshError {
            approach: SMOOTH_APPROACH * smooth + singular,
            max_pressure: PEAK * smooth + singular,
            area: AREA * delta.powf(AREA_ORDER),
            singular,
        })
    }

    /// Number of the cells in contact that have a neighbour without pressure, and the sum of their pressures.
    fn rim(&self, low: [usize; 2], high: [usize; 2]) -> (usize, f64) {
        let n2 = self.grid.cells()[1];
        let (mut rim_cells, mut rim) = (0_usize, 0.0);
        for i in low[0]..=high[0] {
            for start in (low[1]..=high[1]).step_by(PIECE) {
                let piece = start..(start + PIECE).min(high[1] + 1);
                if self.has_no_rim(i, &piece) {
                    continue;
                }
                for j in piece {
                    let p = self.pressure[i * n2 + j];
                    if p != 0.0 && self.has_free_neighbour(i, j) {
                        (rim_cells, rim) = (rim_cells + 1, rim + p);
                    }
                }
            }
        }
        (rim_cells, rim)
    }

    /// Whether the cells of a piece of a row are all without pressure, or in contact together with all their neighbours: most
    /// are, and a few comparisons at a time tell it. Pieces at the ends of the grid, which may go on at the other end, are not
    /// told.
    fn has_no_rim(&self, i: usize, piece: &Range<usize>) -> bool {
        let [n1, n2] = self.grid.cells();
        if i == 0 || i + 1 == n1 || piece.start == 0 || piece.end == n2 {
            return false;
        }
        let any_free = |i: usize, columns: Range<usize>| {
            self.pressure[i * n2..][columns].iter().fold(false, |free, p| free | (*p == 0.0))
        };
        let beside = piece.start - 1..piece.end + 1;
        let all_free = self.pressure[i * n2..][piece.clone()].iter().fold(true, |free, p| free & (*p == 0.0));
        all_free || !(any_free(i, beside) | any_free(i - 1, piece.clone()) | any_free(i + 1, piece.clone()))
    }

    fn has_free_neighbour(&self, i: usize, j: usize) -> bool {
        let [n1, n2] = self.grid.cells();
        if i > 0 && i + 1 < n1 && j > 0 && j + 1 < n2 {
            let k = i * n2 + j;
            return [k - n2, k - 1, k + 1, k + n2].into_iter().any(|neighbour| self.pressure[neighbour] == 0.0);
        }
        let (i, j) = (i as isize, j as isize);
        let neighbours = [[i - 1, j], [i + 1, j], [i, j - 1], [i, j + 1]];
        neighbours.into_iter().any(|cell| self.pressure_at(cell) == 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    /// Patches of contact of all sizes, at the ends of the grid too, against the definition of the rim.
    #[test]
    fn the_rim_is_what_has_a_neighbour_without_pressure() {
        let mut state = 7_u64;
        let mut below = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % n
        };
        for _ in 0..300 {
            let cells = [1 + below(12), 1 + below(70)];
            let grid = Grid::new(cells, [1.0, 1.0]).unwrap();
            let mut pressure = vec![0.0; grid.len()];
            for _ in 0..=below(3) {
                let [from, to] = [0, 1].map(|_| cells.map(&mut below));
                for i in from[0].min(to[0])..=from[0].max(to[0]) {
                    let columns = from[1].min(to[1])..=from[1].max(to[1]);
                    columns.for_each(|j| pressure[i * cells[1] + j] = (1 + below(9)) as f64);
                }
            }
            let gap = vec![0.0; grid.len()];
            let periodic = [below(2) == 1, below(2) == 1];
            let pressed = Pressed { grid: &grid, first: None, periodic, pressure: &pressure, gap: &gap, extent: None };
            let mut expected = (0, 0.0);
            for k in (0..grid.len()).filter(|&k| pressure[k] != 0.0) {
                let [i, j] = [k / cells[1], k % cells[1]].map(|index| index as isize);
                let neighbours = [[i - 1, j], [i + 1, j], [i, j - 1], [i, j + 1]];
                if neighbours.into_iter().any(|cell| pressed.pressure_at(cell) == 0.0) {
                    expected = (expected.0 + 1, expected.1 + pressure[k]);
                }
            }
            assert_eq!(pressed.rim([0, 0], [cells[0] - 1, cells[1] - 1]), expected, "{cells:?} {periodic:?}");
        }
    }
}
