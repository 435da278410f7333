//! The gap of a contact whose rows ranks share out. Each rank has the local rows of the whole grid; symmetry, datum
//! and hull follow from the rows of all ranks.

use std::hash::{DefaultHasher, Hasher};

use crate::Grid;
use crate::equilibrium::{Hull, Indenter, Region};
use crate::error::{Error, Result};
use crate::geometry::Gap;
use crate::parallel::Rows;

/// The gap of a single body on the local rows of the whole grid.
pub(in crate::contact) struct SharedGap<'a> {
    rows: Rows,
    heights: &'a [f64],
    /// The lowest gap of all rows \[m\].
    datum: f64,
}

impl SharedGap<'_> {
    /// Checks the gap on the local rows, and finds the lowest gap of all rows. A call of all ranks, which get the
    /// same error.
    pub(in crate::contact) fn new<'a>(heights: &'a [f64], grid: &Grid, rows: &Rows) -> Result<SharedGap<'a>> {
        let n2 = grid.cells()[1];
        let invalid = heights.iter().position(|h| h.is_nan() || *h == f64::NEG_INFINITY);
        let own = invalid.map_or([f64::INFINITY, 0.0], |k| [(rows.own().start * n2 + k) as f64, heights[k]]);
        let [first, value] = rows.join(own, |a, b| if b[0] < a[0] { b } else { a });
        if first.is_finite() {
            let cell = [first as usize / n2, first as usize % n2];
            return Err(Error::InvalidGap { cell, position: grid.center(cell[0], cell[1]), value });
        }
        let datum = rows.least(heights.iter().copied().fold(f64::INFINITY, f64::min));
        if datum == f64::INFINITY {
            return Err(Error::NothingToTouch { body: 0, cells: grid.len() });
        }
        Ok(SharedGap { rows: rows.clone(), heights, datum })
    }

    /// Axes of an even number of cells about whose middle the gap is even. Rows whose mirror image another rank has
    /// are compared by 64 bits of a hash. A call of all ranks.
    pub(in crate::contact) fn even_axes(&self) -> [bool; 2] {
        let SharedGap { rows, heights, datum } = self;
        let [n1, n2] = rows.cells();
        let mirrored = |row: &[f64]| (0..n2 / 2).all(|j| row[j] - datum == row[n2 - 1 - j] - datum);
        let even2 = n2.is_multiple_of(2) && !rows.any(!heights.chunks_exact(n2).all(mirrored));
        let marks = heights.chunks_exact(n2).flat_map(|row| {
            let mut hasher = DefaultHasher::new();
            // −0 and 0 are the same
            row.iter().for_each(|h| hasher.write_u64((h - datum + 0.0).to_bits()));
            let mark = hasher.finish();
            [mark >> 32, mark & u64::from(u32::MAX)].map(|half| half as f64)
        });
        let rows_agree = |all: &[f64]| {
            let marks = all.as_chunks::<2>().0;
            (0..n1 / 2).all(|i| marks[i] == marks[n1 - 1 - i])
        };
        let even1 = n1.is_multiple_of(2) && rows.gather(marks, |rank| 2 * rows.of(rank).len(), rows_agree);
        [even1, even2]
    }

    /// The indenter on a region of own rows, which may be others where the region is folded. A call of all ranks.
    pub(in crate::contact) fn on(&self, region: &Region, grid: &Grid, even: [bool; 2]) -> Indenter {
        let ([n1, n2], [_, m2], to) = (grid.cells(), region.cells(), region.rows());
        let mut above: Vec<f64> = self.heights.iter().map(|h| h - self.datum).collect();
        if to.cells() != self.rows.cells() {
            above = self.rows.moved(&above, n1 - to.cells()[0], &to);
        }
        if m2 < n2 {
            above = above.chunks_exact(n2).flat_map(|row| &row[n2 - m2..]).copied().collect();
        }
        Indenter::shared(Gap { datum: self.datum, above, owner: None }, even, self.hull(grid), region)
    }

    /// The convex hull of the cells that may be touched.
    fn hull(&self, grid: &Grid) -> Hull {
        let SharedGap { rows, heights, .. } = self;
        let n2 = grid.cells()[1];
        let ends = heights.chunks_exact(n2).flat_map(|row| {
            let first = row.iter().position(|h| h.is_finite());
            let last = row.iter().rposition(|h| h.is_finite());
            [first, last].map(|end| end.map_or(f64::NAN, |j| j as f64))
        });
        let of_all = |all: &[f64]| {
            let ends = all.as_chunks::<2>().0;
            Hull::of_rows(grid, |i| (!ends[i][0].is_nan()).then(|| ends[i].map(|j| j as usize)))
        };
        rows.gather(ends, |rank| 2 * rows.of(rank).len(), of_all)
    }
}
