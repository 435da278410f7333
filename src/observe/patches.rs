//! Connected patches of a contact.

use crate::error::{Result, count_within, exact_length, finite, non_negative};
use crate::values::Counted;
use crate::{Grid, memory};

/// One patch of contact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Patch {
    /// Number of cells.
    pub cells: usize,
    /// Area of its cells \[m²\].
    pub area: f64,
    /// Normal force on the patch \[N\].
    pub force: f64,
    /// Centroid of its area \[m\], on the grid. A patch across the edge of a periodic grid is unwrapped first; along
    /// an axis that it winds around, the centroid is the mean of the coordinates on the grid.
    pub centroid: [f64; 2],
    /// Maximum pressure \[Pa\].
    pub max_pressure: f64,
    /// Whether the patch connects to itself around the periodic axes x1 and x2.
    pub winds: [bool; 2],
}

/// The connected patches of a contact. Cells under pressure belong to one patch if they share a side, not merely a
/// corner.
///
/// ```
/// use viscocontact::{Grid, observe::Patches};
///
/// let grid = Grid::new([3, 4], [3.0, 4.0])?;
/// let pressure = [
///     5.0, 0.0, 0.0, 1.0, //
///     2.0, 0.0, 3.0, 0.0,
///     0.0, 0.0, 3.0, 0.0,
/// ];
/// let patches = Patches::new(&grid, &pressure, [false; 2])?;
/// assert_eq!(patches.labels, [1, 0, 0, 2, 1, 0, 3, 0, 0, 0, 3, 0]);
/// assert_eq!(patches.all[0].force, 7.0);
/// assert_eq!(Patches::new(&grid, &pressure, [false, true])?.all.len(), 2);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub struct Patches {
    /// The label of each cell: 0 out of contact, k + 1 in the patch `all[k]`.
    pub labels: Vec<u32>,
    /// The patches, in the order of their first cells on the grid.
    pub all: Vec<Patch>,
}

debug_by!(self: Patches => labels: Counted(&self.labels), all: Counted(&self.all));

impl Patches {
    /// The patches where `pressure` \[Pa\], one value per cell, is above zero. Along `periodic` axes the first and the
    /// last cells are neighbours.
    ///
    /// # Errors
    /// If there is not one value per cell, a value is not finite or below zero, or the force of a patch overflows
    /// `f64`. If there is no memory for the labels.
    pub fn new(grid: &Grid, pressure: &[f64], periodic: [bool; 2]) -> Result<Patches> {
        exact_length("pressure", pressure.len(), grid.len())?;
        for &p in pressure {
            non_negative("pressure", p)?;
        }
        let what = "the labels of patches";
        let (labels, periods) = (memory::field(what, grid.len(), 0)?, memory::field(what, grid.len(), [0; 2])?);
        let mut fill = FloodFill { grid, pressure, periodic, labels, periods };
        let mut all = Vec::new();
        for (k, &p) in pressure.iter().enumerate() {
            if p > 0.0 && fill.labels[k] == 0 {
                let label = all.len() + 1;
                count_within("patches of contact", label, u32::try_from(label).is_ok(), "4294967295 at most")?;
                let patch = fill.patch(k, label as u32);
                finite("force of a patch", patch.force)?;
                all.push(patch);
            }
        }
        Ok(Patches { labels: fill.labels, all })
    }

    /// The patch with the most cells, the first of several; `None` without contact.
    pub fn largest(&self) -> Option<&Patch> {
        self.all.iter().rev().max_by_key(|patch| patch.cells)
    }
}

/// Flood fill from a first cell to its neighbours.
struct FloodFill<'a> {
    grid: &'a Grid,
    pressure: &'a [f64],
    periodic: [bool; 2],
    labels: Vec<u32>,
    /// Net number of periods crossed along each axis on the way from the first cell of the patch.
    periods: Vec<[i32; 2]>,
}

impl FloodFill<'_> {
    /// Labels the patch of the cell `first`.
    fn patch(&mut self, first: usize, label: u32) -> Patch {
        let grid = self.grid;
        let (n2, lengths) = (grid.cells()[1], grid.lengths());
        let (mut cells, mut sum, mut greatest, mut winds) = (0, 0.0, 0.0_f64, [false; 2]);
        // sums of the coordinates on the grid, and on the unwrapped patch
        let (mut on_grid, mut unwrapped) = ([0.0; 2], [0.0; 2]);
        self.labels[first] = label;
        let mut waiting = vec![first];
        while let Some(k) = waiting.pop() {
            let (cell, periods) = ([k / n2, k % n2], self.periods[k]);
            cells += 1;
            sum += self.pressure[k];
            greatest = greatest.max(self.pressure[k]);
            for axis in 0..2 {
                let x = grid.coordinate(axis, cell[axis]);
                on_grid[axis] += x;
                unwrapped[axis] += x + f64::from(periods[axis]) * lengths[axis];
            }
            for axis in 0..2 {
                for step in [-1, 1] {
                    let (next, count) = (cell[axis] as i64 + step, grid.cells()[axis] as i64);
                    let crossed = next.div_euclid(count) as i32;
                    if crossed != 0 && !self.periodic[axis] {
                        continue;
                    }
                    let next = next.rem_euclid(count) as usize;
                    let other = if axis == 0 { next * n2 + cell[1] } else { cell[0] * n2 + next };
                    if self.pressure[other] <= 0.0 {
                        continue;
                    }
                    let mut there = periods;
                    there[axis] += crossed;
                    if self.labels[other] == 0 {
                        (self.labels[other], self.periods[other]) = (label, there);
                        waiting.push(other);
                    } else {
                        // reached along two paths: the patch winds where they cross different numbers of periods
                        (0..2).for_each(|axis| winds[axis] |= self.periods[other][axis] != there[axis]);
                    }
                }
            }
        }
        let centroid = [0, 1].map(|axis| {
            let mean = (if winds[axis] { on_grid } else { unwrapped })[axis] / cells as f64;
            mean - (mean / lengths[axis]).round() * lengths[axis]
        });
        let area = grid.cell_area();
        Patch { cells, area: cells as f64 * area, force: sum * area, centroid, max_pressure: greatest, winds }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;
    use crate::error::Error;
    use crate::observe::tests::sphere;

    /// Patches of a map whose digits are pressures, on cells of 1 m × 2 m.
    fn patches(rows: &[&str], periodic: [bool; 2]) -> Patches {
        let cells = [rows.len(), rows[0].len()];
        let grid = Grid::new(cells, [cells[0] as f64, 2.0 * cells[1] as f64]).unwrap();
        let pressure: Vec<f64> = rows.concat().chars().map(|c| f64::from(c.to_digit(10).unwrap())).collect();
        Patches::new(&grid, &pressure, periodic).unwrap()
    }

    #[test]
    fn cells_that_share_a_corner_are_apart_and_a_ring_is_one_patch() {
        let found = patches(&["11100", "10100", "11102", "00020"], [false; 2]);
        assert_eq!(found.labels, [1, 1, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1, 1, 0, 2, 0, 0, 0, 3, 0]);
        assert_eq!(found.all.len(), 3);
        let ring = found.all[0];
        assert_eq!((ring.cells, ring.area, ring.force, ring.winds), (8, 16.0, 16.0, [false; 2]));
        // rows 0 to 2 of 4, columns 0 to 2 of 5
        assert_eq!(ring.centroid, [-0.5, -2.0]);
        assert_eq!(found.largest(), Some(&ring));
        assert_eq!(found.all[2].max_pressure, 2.0);
        assert_eq!(patches(&["00", "00"], [true; 2]).largest(), None);
    }

    #[test]
    fn periodic_axes_join_patches_across_the_edge() {
        let rows = ["30001", "00000", "00000", "20000"];
        assert_eq!(patches(&rows, [false; 2]).all.len(), 3);
        assert_eq!(patches(&rows, [true, false]).labels[15], 1);
        assert_eq!(patches(&rows, [true, false]).all.len(), 2);
        let found = patches(&rows, [true; 2]);
        let [patch] = *found.all else { panic!("{found:?}") };
        // the corner cell at (−1.5, −4), its neighbours across either edge
        let expected: [f64; 2] = [-1.5 - 1.0 / 3.0, -4.0 - 2.0 / 3.0];
        assert!((0..2).all(|axis| (patch.centroid[axis] - expected[axis]).abs() < 1e-14), "{:?}", patch.centroid);
        assert_eq!((patch.cells, patch.force, patch.max_pressure, patch.winds), (3, 12.0, 3.0, [false; 2]));
    }

    #[test]
    fn patches_connected_to_themselves_wind() {
        let found = patches(&["000", "121", "000"], [true; 2]);
        assert_eq!((found.all[0].winds, found.all[0].centroid), ([false, true], [0.0; 2]));
        let found = patches(&["000", "121", "000"], [true, false]);
        assert_eq!(found.all[0].winds, [false; 2]);
        // diagonal stairs, around both axes
        let found = patches(&["1100", "0110", "0011", "1001"], [true; 2]);
        assert_eq!((found.all.len(), found.all[0].winds), (1, [true; 2]));
        // a cell that is its own neighbour
        assert_eq!(patches(&["1"], [true; 2]).all[0].winds, [true; 2]);
    }

    /// Against labels that spread from cell to cell until none changes.
    #[test]
    fn random_maps_agree_with_label_propagation() {
        let (n1, n2, mut seed) = (13_usize, 17_usize, 1_u64);
        for round in 0..200 {
            let periodic = [round % 2 == 0, round % 3 == 0];
            let pressure: Vec<f64> = (0..n1 * n2)
                .map(|_| {
                    seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    if seed >> 33 < (round + 50) << 23 { 1.0 } else { 0.0 }
                })
                .collect();
            let grid = Grid::new([n1, n2], [1.0, 1.0]).unwrap();
            let found = Patches::new(&grid, &pressure, periodic).unwrap();
            let mut slow: Vec<usize> = (0..n1 * n2).collect();
            let mut changed = true;
            while changed {
                changed = false;
                for k in 0..n1 * n2 {
                    let (i, j) = (k / n2, k % n2);
                    let below = if i + 1 < n1 { Some((i + 1) * n2 + j) } else { periodic[0].then_some(j) };
                    let right = if j + 1 < n2 { Some(k + 1) } else { periodic[1].then_some(i * n2) };
                    for other in [below, right].into_iter().flatten() {
                        if pressure[k] * pressure[other] > 0.0 && slow[k] != slow[other] {
                            let least = slow[k].min(slow[other]);
                            (slow[k], slow[other], changed) = (least, least, true);
                        }
                    }
                }
            }
            let mut roots: Vec<usize> = (0..n1 * n2).filter(|&k| pressure[k] > 0.0).map(|k| slow[k]).collect();
            roots.sort_unstable();
            roots.dedup();
            for k in 0..n1 * n2 {
                let label = if pressure[k] > 0.0 { roots.binary_search(&slow[k]).unwrap() + 1 } else { 0 };
                assert_eq!(found.labels[k] as usize, label, "round {round}, cell {k}");
            }
            assert_eq!(found.all.iter().map(|patch| patch.cells).sum::<usize>() as f64, pressure.iter().sum::<f64>());
        }
    }

    #[test]
    fn a_sphere_has_one_patch_with_the_whole_force() {
        let contact = sphere([64, 48], [2.0e-3, 1.5e-3], [0.1e-3, -0.05e-3], 0.1);
        let found = contact.fields().patches().unwrap();
        assert_eq!(found.all.len(), 1);
        let patch = found.all[0];
        assert_eq!(patch.cells, contact.contact_cells());
        assert_abs_diff_eq!(patch.force, 0.1, epsilon = 1e-9);
        assert!((patch.centroid[0] - 0.1e-3).abs() < 1e-5 && (patch.centroid[1] + 0.05e-3).abs() < 1e-5);
        assert_eq!(patch.max_pressure, contact.fields().max_pressure());
    }

    #[test]
    fn bad_pressures_are_refused() {
        let grid = Grid::square(1, 1.0).unwrap();
        for value in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Patches::new(&grid, &[value], [false; 2]), Err(Error::OutOfRange { .. })));
        }
        assert!(matches!(Patches::new(&grid, &[], [false; 2]), Err(Error::WrongLength { .. })));
    }
}
