//! The rectangular grid on which every field lives.

use crate::error::{Error, Result, positive};

/// Maximum number of cells of a grid: a field of 8 bytes per cell can be addressed.
const MOST_CELLS: usize = isize::MAX as usize / size_of::<f64>();

/// A rectangular grid of equal cells in the common plane of contact, centred on the origin.
///
/// Fields hold one value per cell, constant over the cell, row-major with x2 fastest: the cell
/// `[i, j]` is entry `i * cells()[1] + j`.
///
/// ```
/// use viscocontact::Grid;
///
/// let grid = Grid::new([4, 2], [8.0e-3, 2.0e-3])?;
/// assert_eq!(grid.len(), 8);
/// assert_eq!(grid.spacing(), [2.0e-3, 1.0e-3]);
/// assert_eq!(grid.center(0, 1), [-3.0e-3, 0.5e-3]);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "serialised::Rectangle", into = "serialised::Rectangle"))]
pub struct Grid {
    cells: [usize; 2],
    spacing: [f64; 2],
    /// Twice the coordinate of the centre of the first cell, in units of the spacing: 1 − cells, unless this is a part
    /// of a grid.
    start: [i64; 2],
}

impl Grid {
    /// A grid of `cells[0]` × `cells[1]` cells on a rectangle of `lengths[0]` × `lengths[1]` \[m\].
    ///
    /// # Errors
    /// If a count is zero or there are so many cells that a field of 8 bytes per cell cannot be addressed, more than
    /// 2⁶⁰ − 1 on 64-bit systems, or a length is not finite and positive.
    pub fn new(cells: [usize; 2], lengths: [f64; 2]) -> Result<Grid> {
        for (field, count) in [("cells along x1", cells[0]), ("cells along x2", cells[1])] {
            if count == 0 {
                return Err(Error::CountOutOfRange { field, value: count, allowed: "1 or more" });
            }
        }
        if cells[0].checked_mul(cells[1]).is_none_or(|all| all > MOST_CELLS) {
            let value = cells[0].saturating_mul(cells[1]);
            let allowed = "few enough for a field of 8 bytes per cell to be addressed (2^60 - 1 on 64-bit systems)";
            return Err(Error::CountOutOfRange { field: "cells of the grid", value, allowed });
        }
        positive("length along x1", lengths[0])?;
        positive("length along x2", lengths[1])?;
        let spacing = [
            positive("cell side along x1", lengths[0] / cells[0] as f64)?,
            positive("cell side along x2", lengths[1] / cells[1] as f64)?,
        ];
        positive("cell area", spacing[0] * spacing[1])?;
        // the products in `lengths`: side times count may overflow by rounding
        positive("length along x1", spacing[0] * cells[0] as f64)?;
        positive("length along x2", spacing[1] * cells[1] as f64)?;
        Ok(Grid { cells, spacing, start: cells.map(|count| 1 - count as i64) })
    }

    /// The rectangle of `cells` that begins at the cell `first`, as a grid of its own with the coordinates of the
    /// whole.
    pub(crate) fn part(&self, first: [usize; 2], cells: [usize; 2]) -> Grid {
        let start = [0, 1].map(|axis| self.start[axis] + 2 * first[axis] as i64);
        Grid { cells, spacing: self.spacing, start }
    }

    /// A centred grid of cells that are already checked, such as cells of another grid.
    pub(crate) fn of_spacing(cells: [usize; 2], spacing: [f64; 2]) -> Grid {
        Grid { cells, spacing, start: cells.map(|count| 1 - count as i64) }
    }

    /// A square grid of `cells` × `cells` cells with sides of `length` \[m\].
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn square(cells: usize, length: f64) -> Result<Grid> {
        Grid::new([cells, cells], [length, length])
    }

    /// Number of cells along x1 and x2.
    pub fn cells(&self) -> [usize; 2] {
        self.cells
    }

    /// Sides of a cell \[m\].
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Sides of the whole grid \[m\].
    pub fn lengths(&self) -> [f64; 2] {
        [self.spacing[0] * self.cells[0] as f64, self.spacing[1] * self.cells[1] as f64]
    }

    /// Number of cells in all: the length of every field.
    #[expect(clippy::len_without_is_empty, reason = "a grid has at least one cell")]
    pub fn len(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// Area of a cell \[m²\].
    pub fn cell_area(&self) -> f64 {
        self.spacing[0] * self.spacing[1]
    }

    /// Centre of the cell `[i, j]` \[m\].
    pub fn center(&self, i: usize, j: usize) -> [f64; 2] {
        [self.coordinate(0, i), self.coordinate(1, j)]
    }

    /// Coordinate of the first cell centre along `axis` \[cells\]: a whole number, and a half or nothing.
    pub(crate) fn offset_of_first(&self, axis: usize) -> (i64, f64) {
        let halves = self.start[axis].rem_euclid(2);
        ((self.start[axis] - halves) / 2, 0.5 * halves as f64)
    }

    /// Coordinate of the `index`-th cell centre along `axis`; exactly antisymmetric about zero.
    pub(crate) fn coordinate(&self, axis: usize, index: usize) -> f64 {
        (2 * index as i64 + self.start[axis]) as f64 * (0.5 * self.spacing[axis])
    }
}

/// A grid as others than checkpoints have it: `cells` and `spacing` \[m\], checked as [`Grid::new`] does.
#[cfg(feature = "serde")]
mod serialised {
    use super::Grid;
    use crate::error::Error;

    #[derive(serde::Serialize, serde::Deserialize)]
    pub(super) struct Rectangle {
        cells: [usize; 2],
        spacing: [f64; 2],
    }

    impl From<Grid> for Rectangle {
        fn from(grid: Grid) -> Rectangle {
            Rectangle { cells: grid.cells, spacing: grid.spacing }
        }
    }

    impl TryFrom<Rectangle> for Grid {
        type Error = Error;

        fn try_from(Rectangle { cells, spacing }: Rectangle) -> Result<Grid, Error> {
            Grid::new(cells, [0, 1].map(|axis| spacing[axis] * cells[axis] as f64))?;
            Ok(Grid::of_spacing(cells, spacing))
        }
    }
}

/// The grid in a checkpoint, which is validated as a whole; other grids are made by [`Grid::new`].
#[cfg(feature = "checkpoint")]
pub(crate) mod saved {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Grid;

    pub(crate) fn serialize<S: Serializer>(grid: &Grid, serializer: S) -> Result<S::Ok, S::Error> {
        (grid.cells, grid.spacing, grid.start).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Grid, D::Error> {
        let (cells, spacing, start) = Deserialize::deserialize(deserializer)?;
        Ok(Grid { cells, spacing, start })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_are_symmetric_and_half_a_cell_inside() {
        let grid = Grid::new([5, 4], [1.0, 2.0]).unwrap();
        assert_eq!(grid.center(2, 0)[0], 0.0);
        for i in 0..5 {
            assert_eq!(grid.center(i, 0)[0], -grid.center(4 - i, 0)[0]);
        }
        assert_eq!(grid.center(0, 3), [-0.4, 0.75]);
    }

    /// The side of a cell may round up, so that the sum of all sides overflows.
    #[test]
    fn lengths_are_finite_however_they_round() {
        let (mut made, mut refused) = (0, 0);
        for cells in 1..200 {
            match Grid::new([cells, 1], [f64::MAX, 1e-10]) {
                Ok(grid) => {
                    assert!(grid.lengths()[0].is_finite(), "{cells} cells");
                    made += 1;
                }
                Err(error) => {
                    assert!(matches!(error, Error::OutOfRange { field: "length along x1", .. }), "{error}");
                    refused += 1;
                }
            }
        }
        assert!(made > 0 && refused > 0, "{made} {refused}");
    }

    #[test]
    fn invalid_grids_are_rejected_by_name() {
        let field = |result: Result<Grid>| match result.unwrap_err() {
            Error::OutOfRange { field, .. } | Error::CountOutOfRange { field, .. } => field,
            other => panic!("unexpected {other}"),
        };
        assert_eq!(field(Grid::new([0, 3], [1.0, 1.0])), "cells along x1");
        assert_eq!(field(Grid::new([3, 0], [1.0, 1.0])), "cells along x2");
        assert_eq!(field(Grid::new([usize::MAX, 2], [1.0, 1.0])), "cells of the grid");
        assert_eq!(field(Grid::new([1 << 30, 1 << 30], [1.0, 1.0])), "cells of the grid");
        assert_eq!(Grid::new([(1 << 30) - 1, 1 << 30], [1.0, 1.0]).unwrap().len(), (1 << 60) - (1 << 30));
        assert_eq!(field(Grid::square(3, f64::NAN)), "length along x1");
        assert_eq!(field(Grid::new([3, 3], [1.0, -1.0])), "length along x2");
        assert_eq!(field(Grid::new([3, 3], [1e-200, 1e-200])), "cell area");
    }
}
