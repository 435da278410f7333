//! The laws that every [`Geometry`] must obey, for tests of your own geometries. [`all`] checks them on a grid, and
//! reports which law is violated, on which cell, with the values there.
//!
//! ```
//! use viscocontact::Grid;
//! use viscocontact::geometry::{Geometry, laws};
//!
//! #[derive(Debug)]
//! struct Bowl; // its field lacks the factor 0.5
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
//! assert_eq!(violation.law, "a field is the gap at the cell centres");
//! assert!(matches!(violation.at, laws::Location::Cell { cell: [0, 0], .. }));
//! println!("{violation}");
//! # Ok::<(), viscocontact::Error>(())
//! ```

use crate::Grid;
pub use crate::error::{Location, Verdict, Violation};
use crate::geometry::Geometry;

/// Difference that rounding may cause between equivalent formulas, relative to the maximum gap.
const ROUNDING: f64 = 1e-10;
/// Distance that rounding may shift a point by, in cells: a jump, such as the rim of a face, may be displaced by it.
const JUMP_DISPLACEMENT: f64 = 1e-9;
/// Shifts by whole cells to test.
const SHIFTS: [[i64; 2]; 5] = [[1, 0], [0, 1], [-2, 1], [3, 2], [-1, -4]];

/// Every law, on `grid`: gaps are numbers or +∞, finite somewhere, and the same when they are asked for again; a field
/// is the gap at the cell centres, the same shifted by zero, and shifted by whole cells that of the cells it came
/// from. Check a geometry that interpolates between points on its own grid.
///
/// # Errors
/// The first violation.
pub fn all(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    is_a_gap(geometry, grid)?;
    has_something_to_touch(geometry, grid)?;
    repeats_itself(geometry, grid)?;
    field_matches_points(geometry, grid)?;
    zero_shift_changes_nothing(geometry, grid)?;
    shifts_by_whole_cells(geometry, grid)
}

/// Checks a field: `expected` takes the index and the centre of a cell and its gap, and returns the value that it
/// should have if it differs.
fn check(
    law: &'static str,
    grid: &Grid,
    gap: &[f64],
    expected: impl Fn(usize, [f64; 2], f64) -> Option<f64>,
) -> Verdict {
    let n2 = grid.cells()[1];
    for (k, &found) in gap.iter().enumerate() {
        let cell = [k / n2, k % n2];
        let position = grid.center(cell[0], cell[1]);
        if let Some(expected) = expected(k, position, found) {
            return Err(Violation { law, quantity: "gap", at: Location::Cell { cell, position }, found, expected });
        }
    }
    Ok(())
}

/// The field of a shape shifted by `by`, written over `garbage`.
fn shifted(geometry: &dyn Geometry, grid: &Grid, by: [f64; 2], garbage: f64) -> Vec<f64> {
    let mut gap = vec![garbage; grid.len()];
    geometry.fill_gap_at(grid, by, &mut gap);
    gap
}

/// The field of a shape, written over `garbage`.
fn filled(geometry: &dyn Geometry, grid: &Grid, garbage: f64) -> Vec<f64> {
    let mut gap = vec![garbage; grid.len()];
    geometry.fill_gap(grid, &mut gap);
    gap
}

/// The maximum magnitude of the finite gaps.
fn greatest(gap: &[f64]) -> f64 {
    gap.iter().filter(|h| h.is_finite()).fold(0.0, |most, h| h.abs().max(most))
}

/// Whether two gaps differ by at most `within`, or are both +∞.
fn same(a: f64, b: f64, within: f64) -> bool {
    a == b || (a - b).abs() <= within
}

/// The gap at a point, if `found` differs from it by more than `within`.
fn mismatch(geometry: &dyn Geometry, grid: &Grid, point: [f64; 2], found: f64, within: f64) -> Option<f64> {
    let [x1, x2] = point;
    let expected = geometry.initial_gap(x1, x2);
    if same(found, expected, within) {
        return None;
    }
    // next to a jump, a value of a slightly displaced point is accepted
    let [d1, d2] = grid.spacing().map(|side| JUMP_DISPLACEMENT * side);
    let directions =
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
    let displaced = |(s1, s2): (f64, f64)| same(found, geometry.initial_gap(x1 + s1 * d1, x2 + s2 * d2), within);
    if directions.into_iter().any(displaced) { None } else { Some(expected) }
}

/// The gap is neither NaN nor −∞, wherever the shape is shifted to.
fn is_a_gap(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let bad = |_, _, found: f64| (found.is_nan() || found == f64::NEG_INFINITY).then_some(f64::INFINITY);
    let law = "a gap is a number or +∞";
    check(law, grid, &filled(geometry, grid, 0.0), bad)?;
    let [l1, l2] = grid.lengths();
    for by in [[0.0; 2], [0.3 * l1, -0.2 * l2], [-1.7 * l1, 0.01 * l2], [1e3 * l1, 1e3 * l2]] {
        check(law, grid, &shifted(geometry, grid, by, 0.0), bad)?;
        check(law, grid, &vec![0.0; grid.len()], |k, [x1, x2], _| {
            bad(k, [x1, x2], geometry.initial_gap(x1 - by[0], x2 - by[1]))
        })?;
    }
    Ok(())
}

/// There is something to touch: the gap of at least one cell is finite. Otherwise a contact cannot be built.
fn has_something_to_touch(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let gap = filled(geometry, grid, 0.0);
    let nothing = !gap.iter().any(|h| h.is_finite());
    check("there is something to touch", grid, &gap, |_, _, _| nothing.then_some(0.0))
}

/// Repeated evaluations give bitwise equal values on every cell, independent of the previous content of the field.
fn repeats_itself(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let law = "repeated evaluations give the same gap";
    let by = grid.lengths().map(|length| 0.37 * length);
    let (first, first_shifted) = (filled(geometry, grid, 0.0), shifted(geometry, grid, by, 0.0));
    let differs_from = |again: Vec<f64>| {
        move |k: usize, _: [f64; 2], found: f64| (again[k].to_bits() != found.to_bits()).then_some(again[k])
    };
    check(law, grid, &first, differs_from(filled(geometry, grid, f64::NAN)))?;
    check(law, grid, &first_shifted, differs_from(shifted(geometry, grid, by, f64::NAN)))
}

/// [`Geometry::fill_gap`] writes [`Geometry::initial_gap`] at the cell centres.
fn field_matches_points(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let gap = filled(geometry, grid, 0.0);
    let within = ROUNDING * greatest(&gap);
    check("a field is the gap at the cell centres", grid, &gap, |_, center, found| {
        mismatch(geometry, grid, center, found, within)
    })
}

/// [`Geometry::fill_gap_at`] the origin is [`Geometry::fill_gap`].
fn zero_shift_changes_nothing(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let gap = filled(geometry, grid, 0.0);
    let within = ROUNDING * greatest(&gap);
    check("a shift by zero changes nothing", grid, &shifted(geometry, grid, [0.0; 2], 0.0), |k, _, found| {
        (!same(found, gap[k], within)).then_some(gap[k])
    })
}

/// Shifted by whole cells, each cell has the gap of the cell it came from, if that is on the grid.
fn shifts_by_whole_cells(geometry: &dyn Geometry, grid: &Grid) -> Verdict {
    let (gap, [n1, n2]) = (filled(geometry, grid, 0.0), grid.cells());
    let within = ROUNDING * greatest(&gap);
    for shift in SHIFTS {
        let by = [0, 1].map(|axis| shift[axis] as f64 * grid.spacing()[axis]);
        let moved = shifted(geometry, grid, by, 0.0);
        check("a shift by whole cells shifts the field", grid, &moved, |k, center, found| {
            let from = [(k / n2) as i64 - shift[0], (k % n2) as i64 - shift[1]];
            if !(0..n1 as i64).contains(&from[0]) || !(0..n2 as i64).contains(&from[1]) {
                return None;
            }
            let [i, j] = from.map(|index| index as usize);
            if same(found, gap[i * n2 + j], within) { None } else { mismatch(geometry, grid, center, found, within) }
        })?;
    }
    Ok(())
}

/// Shifted by any `by` \[m\], the field is the gap at the shifted points, to `tolerance` of the maximum gap besides
/// rounding. Not part of [`all`]: a geometry that interpolates may shift its field more accurately than its points.
///
/// # Errors
/// The first violation; or if the tolerance is negative or not finite.
pub fn shift_matches_points(geometry: &dyn Geometry, grid: &Grid, by: [f64; 2], tolerance: f64) -> Verdict {
    let law = "(arguments) the tolerance is finite and not negative";
    Violation::check_argument(law, "tolerance", [tolerance, 0.0], tolerance.is_finite() && tolerance >= 0.0)?;
    let gap = shifted(geometry, grid, by, 0.0);
    let within = (ROUNDING + tolerance) * greatest(&gap);
    check("the shifted field is the gap at the shifted points", grid, &gap, |_, [x1, x2], found| {
        mismatch(geometry, grid, [x1 - by[0], x2 - by[1]], found, within)
    })
}
