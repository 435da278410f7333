//! The gap of a contact whose rows ranks share out. Each rank has the local rows of the whole grid; symmetry, datum and hull follow
//! from the rows of all ranks.

use std::hash::{DefaultHasher, Hasher};
use std::ops::Range;

use crate::Grid;
use crate::contact::{Hull, Indenter, Region, ViscoelasticContact};
use crate::error::{Error, RanksError, Result};
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
    /// Checks the gap on the local rows, and finds the lowest gap of all rows. A call of all ranks, which get the same error.
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

    /// Axes of an even number of cells about whose middle the gap is even. Rows whose mirror image another rank has are compared
    /// by 64 bits of a hash. A call of all ranks.
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

/// A rectangle of cells of the whole grid.
#[derive(Debug)]
pub(crate) struct Brought {
    /// Indices of the received rows, of the computed half where rows are folded.
    rows: Range<usize>,
    columns: Range<usize>,
    values: Vec<f64>,
    /// The number of rows of a grid whose first half are images, else 0.
    folded: usize,
}

impl Brought {
    /// A row of the rectangle.
    pub(crate) fn row(&self, row: usize) -> &[f64] {
        let computed = if 2 * row < self.folded { self.folded - 1 - row } else { row };
        let start = (computed - self.rows.start) * self.columns.len();
        &self.values[start..start + self.columns.len()]
    }
}

impl ViscoelasticContact {
    /// Brings a rectangle of a field of local rows to the rank `to`, or to all; none on others. A call of all ranks.
    pub(crate) fn bring(
        &self,
        field: &[f64],
        to: Option<usize>,
        rows: Range<usize>,
        columns: Range<usize>,
    ) -> Result<Option<Brought>, RanksError> {
        let (region, [n1, n2]) = (&self.computation.state.region, self.grid().cells());
        let all = region.rows();
        // images of the first half
        let first = if region.is_shared() { n1 - all.cells()[0] } else { 0 };
        let rows = match (rows.end <= first, rows.start < first) {
            (true, _) => n1 - rows.end..n1 - rows.start,
            (_, true) => first..rows.end.max(n1 - rows.start),
            _ => rows,
        };
        let of = |rank: usize| {
            let own = self.rows_of(rank);
            own.start.max(rows.start)..own.end.min(rows.end)
        };
        let start = self.rows().start;
        let own = of(all.rank()).flat_map(|row| &field[(row - start) * n2..][..n2][columns.clone()]);
        let own: Vec<f64> = own.copied().collect();
        let gets = |rank: usize| to.is_none_or(|to| to == rank);
        let pieces = (0..all.ranks()).map(|rank| if gets(rank) { own.clone() } else { Vec::new() });
        let count = |rank: usize| if gets(all.rank()) { of(rank).len() * columns.len() } else { 0 };
        let values = all.exchange(pieces.collect(), count);
        all.intact()?;
        Ok(gets(all.rank()).then_some(Brought { rows, columns, values, folded: 2 * first }))
    }
}
