//! What every [`Geometry`] must obey: one function for each law, for the tests of those who write one.
//!
//! Each takes the geometry and a grid to look at it on, and says where a law is broken, and by what. [`all`] asks for
//! every one.
//!
//! ```
//! use viscocontact::Grid;
//! use viscocontact::geometry::{Geometry, laws};
//!
//! #[derive(Debug)]
//! struct Bowl; // its field forgets to halve
//!
//! impl Geometry for Bowl {
//!     fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
//!         0.5 * (x1 * x1 + x2 * x2)
//!     }
//!     fn fill_gap(&self, grid: &Grid, gap: &mut [f64]) {
//!         let n2 = grid.cells()[1];
//!         for (k, h) in gap.iter_mut().enumerate() {
//!             let [x1, x2] = grid.center(k / n2, k % n2);
//!             *h = x1 * x1 + x2 * x2;
//!         }
//!     }
//! }
//! let violation = laws::all(&Bowl, &Grid::square(8, 1.0)?).unwrap_err();
//! assert_eq!((violation.law, violation.cell), ("a field is the gap at the cell centres", [0, 0]));
//! println!("{violation}");
//! # Ok::<(), viscocontact::Error>(())
//! ```

use crate::Grid;
use crate::geometry::Geometry;

/// A law that does not hold.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{law}: on cell {cell:?} at {position:?} m found {found:e} m, expected {expected:e} m")]
#[non_exhaustive]
pub struct Violation {
    /// Which law.
    pub law: &'static str,
    /// On which cell \[i, j\].
    pub cell: [usize; 2],
    /// The centre of the cell \[m\].
    pub position: [f64; 2],
    /// The gap that was found \[m\].
    pub found: f64,
    /// What the law asks for \[m\]; where it is an inequality, its bound.
    pub expected: f64,
}

/// The law holds, or where it does not.
pub type Verdict = Result<(), Violation>;

/// Agreement of formulas that are the same but for rounding, of the greatest gap.
const SAME: f64 = 1e-10;
/// How far rounding may move a point, in cells: what jumps, as the rim of a face, may do so a little aside.
const ASIDE: f64 = 1e-9;
/// Whole cells to move by.
const STRIDES: [[i64; 2]; 5] = [[1, 0], [0, 1], [-2, 1], [3, 2], [-1, -4]];

/// Every law, on `grid`. A map of points that is interpolated between them should be asked on its own grid.
///
/// # Errors
/// The first law that is broken.
pub fn all(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    is_a_gap(geometry, grid)?;
    has_something_to_touch(geometry, grid)?;
    repeats_itself(geometry, grid)?;
    field_is_its_points(geometry, grid)?;
    moved_by_nothing_it_stays(geometry, grid)?;
    moves_by_whole_cells(geometry, grid)
}

/// Checks a whole field: `expected` names the value that a cell should have, where it has not.
fn field(law: &'static str, grid: &Grid, gap: &[f64], expected: impl Fn([usize; 2], f64) -> Option<f64>) -> Verdict {
    let n2 = grid.cells()[1];
    for (k, &found) in gap.iter().enumerate() {
        let cell = [k / n2, k % n2];
        if let Some(expected) = expected(cell, found) {
            return Err(Violation { law, cell, position: grid.center(cell[0], cell[1]), found, expected });
        }
    }
    Ok(())
}

/// The field of a shape moved by `by`, written over `garbage`.
fn moved(geometry: &dyn Geometry, grid: &Grid, by: [f64; 2], garbage: f64) -> Vec<f64> {
    let mut gap = vec![garbage; grid.len()];
    geometry.fill_gap_at(grid, by, &mut gap);
    gap
}

/// The field of a shape where it is, written over `garbage`.
fn filled(geometry: &dyn Geometry, grid: &Grid, garbage: f64) -> Vec<f64> {
    let mut gap = vec![garbage; grid.len()];
    geometry.fill_gap(grid, &mut gap);
    gap
}

/// The greatest finite gap, in absolute value.
fn greatest(gap: &[f64]) -> f64 {
    gap.iter().filter(|h| h.is_finite()).fold(0.0, |most, h| h.abs().max(most))
}

/// The gap of a point where it is not `found`, to rounding.
fn unlike(geometry: &dyn Geometry, grid: &Grid, [x1, x2]: [f64; 2], found: f64, within: f64) -> Option<f64> {
    let expected = geometry.initial_gap(x1, x2);
    let same = |a: f64, b: f64| a == b || (a - b).abs() <= within;
    if same(found, expected) {
        return None;
    }
    // beside a jump, what is a little aside will do
    let [aside1, aside2] = grid.spacing().map(|side| ASIDE * side);
    let corners =
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
    let aside = |(s1, s2): (f64, f64)| same(found, geometry.initial_gap(x1 + s1 * aside1, x2 + s2 * aside2));
    if corners.into_iter().any(aside) { None } else { Some(expected) }
}

/// Neither NaN nor −∞, wherever the shape is moved to.
///
/// # Errors
/// Where it is.
pub fn is_a_gap(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let bad = |_, found: f64| (found.is_nan() || found == f64::NEG_INFINITY).then_some(f64::INFINITY);
    let law = "a gap is a number or +∞";
    field(law, grid, &filled(geometry, grid, 0.0), bad)?;
    let [l1, l2] = grid.lengths();
    for by in [[0.0; 2], [0.3 * l1, -0.2 * l2], [-1.7 * l1, 0.01 * l2], [1e3 * l1, 1e3 * l2]] {
        field(law, grid, &moved(geometry, grid, by, 0.0), bad)?;
        field(law, grid, &vec![0.0; grid.len()], |[i, j], _| {
            let [x1, x2] = grid.center(i, j);
            bad([i, j], geometry.initial_gap(x1 - by[0], x2 - by[1]))
        })?;
    }
    Ok(())
}

/// There is something to touch: a finite gap on one cell or more. A contact cannot be built otherwise.
///
/// # Errors
/// If every cell is out of reach; the first is named.
pub fn has_something_to_touch(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let gap = filled(geometry, grid, 0.0);
    let nothing = !gap.iter().any(|h| h.is_finite());
    field("there is something to touch", grid, &gap, |_, _| nothing.then_some(0.0))
}

/// Asked again it answers the same, bit by bit, on every cell, whatever the field held before.
///
/// # Errors
/// Where it does not.
pub fn repeats_itself(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let law = "asked again, it answers the same";
    let n2 = grid.cells()[1];
    let by = grid.lengths().map(|length| 0.37 * length);
    let (first, first_moved) = (filled(geometry, grid, 0.0), moved(geometry, grid, by, 0.0));
    let unlike = |other: Vec<f64>| {
        move |[i, j]: [usize; 2], found: f64| {
            let again = other[i * n2 + j];
            (again.to_bits() != found.to_bits()).then_some(again)
        }
    };
    field(law, grid, &first, unlike(filled(geometry, grid, f64::NAN)))?;
    field(law, grid, &first_moved, unlike(moved(geometry, grid, by, f64::NAN)))
}

/// [`Geometry::fill_gap`] writes [`Geometry::initial_gap`] at the cell centres.
///
/// # Errors
/// Where they differ by more than 1e-10 of the greatest gap.
pub fn field_is_its_points(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let gap = filled(geometry, grid, 0.0);
    let within = SAME * greatest(&gap);
    field("a field is the gap at the cell centres", grid, &gap, |[i, j], found| {
        unlike(geometry, grid, grid.center(i, j), found, within)
    })
}

/// [`Geometry::fill_gap_at`] the origin is [`Geometry::fill_gap`].
///
/// # Errors
/// Where they differ by more than 1e-10 of the greatest gap.
pub fn moved_by_nothing_it_stays(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let (gap, n2) = (filled(geometry, grid, 0.0), grid.cells()[1]);
    let within = SAME * greatest(&gap);
    field("moved by nothing, it stays", grid, &moved(geometry, grid, [0.0; 2], 0.0), |[i, j], found| {
        let expected = gap[i * n2 + j];
        let same = found == expected || (found - expected).abs() <= within;
        (!same).then_some(expected)
    })
}

/// Moved by whole cells it has the gap of the cells it came from, where those are on the grid.
///
/// # Errors
/// Where it has not, to 1e-10 of the greatest gap.
pub fn moves_by_whole_cells(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let (gap, [n1, n2]) = (filled(geometry, grid, 0.0), grid.cells());
    let within = SAME * greatest(&gap);
    for stride in STRIDES {
        let by = [0, 1].map(|axis| stride[axis] as f64 * grid.spacing()[axis]);
        field("moved by whole cells, so is its field", grid, &moved(geometry, grid, by, 0.0), |[i, j], found| {
            let from = [i as i64 - stride[0], j as i64 - stride[1]];
            if !(0..n1 as i64).contains(&from[0]) || !(0..n2 as i64).contains(&from[1]) {
                return None;
            }
            let [i, j] = from.map(|index| index as usize);
            let expected = gap[i * n2 + j];
            let same = found == expected || (found - expected).abs() <= within;
            if same { None } else { unlike(geometry, grid, grid.center(i, j), found, within) }
        })?;
    }
    Ok(())
}

/// Moved to the point `by` \[m\], whole cells or not, its field is the gap of the points it came from, to `tolerance` of
/// the greatest gap besides rounding. Not among [`all`]: what is interpolated may be moved better than its points.
///
/// # Errors
/// Where it is not.
pub fn moves_as_its_points(geometry: &dyn Geometry, grid: &Grid, by: [f64; 2], tolerance: f64) -> Verdict {
    let gap = moved(geometry, grid, by, 0.0);
    let within = (SAME + tolerance) * greatest(&gap);
    field("moved, its field is the gap of the points it came from", grid, &gap, |[i, j], found| {
        let [x1, x2] = grid.center(i, j);
        unlike(geometry, grid, [x1 - by[0], x2 - by[1]], found, within)
    })
}
