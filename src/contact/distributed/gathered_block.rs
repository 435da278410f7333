//! Parts of a field that ranks share out, brought to one of them.

use std::ops::Range;

use crate::contact::stepper::ViscoelasticContact;
use crate::error::RanksError;
use crate::parallel::exchange_numbers;

/// A rectangle of cells of the whole grid.
#[derive(Debug)]
pub(crate) struct Brought {
    /// The rows that came, which are computed ones.
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
    /// Brings a rectangle of a field of own rows to the rank `to`; none on others, nor without ranks. A call of all ranks.
    pub(crate) fn bring(
        &self,
        field: &[f64],
        to: usize,
        rows: Range<usize>,
        columns: Range<usize>,
    ) -> Result<Option<Brought>, RanksError> {
        let (region, [n1, n2]) = (&self.computation.state.region, self.grid().cells());
        let all = region.rows();
        let first = n1 - all.cells()[0];
        // images of the first half
        let rows = match (rows.end <= first, rows.start < first) {
            (true, _) => n1 - rows.end..n1 - rows.start,
            (_, true) => first..rows.end.max(n1 - rows.start),
            _ => rows,
        };
        let of = |rank: usize| {
            let own = all.of(rank);
            (first + own.start).max(rows.start)..(first + own.end).min(rows.end)
        };
        let whole = Brought { rows: rows.clone(), columns: columns.clone(), values: Vec::new(), folded: 2 * first };
        let Some(group) = all.group() else { return Ok(None) };
        let (own_rank, start) = (group.rank(), first + all.own().start);
        let own = of(own_rank).flat_map(|row| &field[(row - start) * n2..(row - start + 1) * n2][columns.clone()]);
        let mut pieces = vec![Vec::new(); all.ranks()];
        pieces[to] = own.copied().collect();
        let count = |rank: usize| if own_rank == to { of(rank).len() * columns.len() } else { 0 };
        let values = exchange_numbers(&**group, pieces, count)?;
        if own_rank != to {
            return Ok(None);
        }
        Ok(Some(Brought { values, ..whole }))
    }
}
