//! Parts of fields that ranks bring to each other.

use std::ops::Range;

use crate::error::RanksError;
use crate::fields::Fields;

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

impl Fields<'_> {
    /// Brings a rectangle of a field of local rows to the rank `to`, or to all; none on others. A call of all ranks.
    pub(crate) fn bring(
        &self,
        field: &[f64],
        to: Option<usize>,
        rows: Range<usize>,
        columns: Range<usize>,
    ) -> Result<Option<Brought>, RanksError> {
        let (region, [n1, n2]) = (&self.held.region, self.grid().cells());
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
