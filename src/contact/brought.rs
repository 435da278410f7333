//! Parts of a field that ranks share out, brought to one of them.

use std::ops::Range;

use num_complex::Complex64;

use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::RanksError;

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
        // two numbers are sent as a complex one
        let length = |rank: usize| (of(rank).len() * columns.len()).div_ceil(2);
        let (rank, start) = (group.rank(), first + all.own().start);
        let mut own = of(rank).flat_map(|row| &field[(row - start) * n2..(row - start + 1) * n2][columns.clone()]);
        let send: Vec<_> = std::iter::from_fn(|| {
            let first = *own.next()?;
            Some(Complex64::new(first, own.next().copied().unwrap_or(0.0)))
        })
        .collect();
        let ranks = || 0..all.ranks();
        let sent: Vec<usize> = ranks().map(|other| if other == to { send.len() } else { 0 }).collect();
        let counts: Vec<usize> = ranks().map(|other| if rank == to { length(other) } else { 0 }).collect();
        let mut received = vec![Complex64::default(); counts.iter().sum()];
        group.exchange(&send, &sent, &mut received, &counts)?;
        if rank != to {
            return Ok(None);
        }
        let mut values = Vec::with_capacity(rows.len() * columns.len());
        let mut next = 0;
        for other in ranks() {
            let numbers = received[next..next + counts[other]].iter().flat_map(|z| [z.re, z.im]);
            values.extend(numbers.take(of(other).len() * columns.len()));
            next += counts[other];
        }
        Ok(Some(Brought { values, ..whole }))
    }
}
