//! The transforms where ranks share out the rows.
//!
//! Each rank transforms its rows, exchanges panels of columns all-to-all, convolves its columns, and exchanges back.
//! So two exchanges are a convolution, each of 16 bytes for each coefficient of a row that is not zero: rows that
//! only pad the columns are not sent.

use std::ops::Range;

use num_complex::Complex64;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

use super::{AREA, ColumnsInPlace, RowsForward, SpectralOperator, TransformWorkspace};
use crate::kernel::Layout;
use crate::parallel::{Rows, TILE, for_each_share, part, rows_in_a_tile};

/// The tiles of rows and the panels of columns that each rank has.
#[derive(Debug, Clone)]
pub(crate) struct Shares {
    pub(super) rows: Rows,
    /// The tiles of rows that each rank has.
    down: Vec<Range<usize>>,
    /// The panels of columns that each rank has.
    across: Vec<Range<usize>>,
    /// How many real numbers are sent to each rank when the rows are transformed, and received from it.
    sent: Vec<usize>,
    received: Vec<usize>,
}

impl Shares {
    /// Shares of an operator with this layout, if ranks share out the rows.
    pub(crate) fn new(layout: &Layout, rows: &Rows) -> Option<Shares> {
        if !rows.are_shared() {
            return None;
        }
        let high = rows_in_a_tile(layout.folded);
        let panels = layout.independent(1).div_ceil(TILE);
        let ranks = 0..rows.ranks();
        let down: Vec<_> = ranks.clone().map(|rank| tiles(rows.of(rank), high)).collect();
        let across: Vec<_> = ranks.map(|rank| part(panels, rank, rows.ranks())).collect();
        let (own_down, own_across) = (down[rows.rank()].len(), across[rows.rank()].len());
        let sent = across.iter().map(|panels| 2 * own_down * panels.len() * AREA).collect();
        let received = down.iter().map(|tiles| 2 * tiles.len() * own_across * AREA).collect();
        Some(Shares { rows: rows.clone(), down, across, sent, received })
    }

    /// The local columns of the spectrum. A single column is transformed by every rank.
    pub(crate) fn columns(&self, layout: &Layout) -> Range<usize> {
        self.columns_of(self.rows.rank(), layout)
    }

    fn columns_of(&self, rank: usize, layout: &Layout) -> Range<usize> {
        let all = layout.independent(1);
        if layout.is_single_column() {
            return 0..all;
        }
        let panels = &self.across[rank];
        (panels.start * TILE).min(all)..(panels.end * TILE).min(all)
    }

    /// The local columns of a table with `count` rows, of which each rank writes its part.
    pub(crate) fn own_columns(
        &self,
        layout: &Layout,
        count: usize,
        mut write: impl FnMut(usize, &mut [f64]),
    ) -> Vec<f64> {
        let (size, columns) = (self.rows.ranks(), |rank: usize| self.columns_of(rank, layout));
        let rows = |rank: usize| part(count, rank, size);
        let mut row = vec![0.0; layout.independent(1)];
        let mut written: Vec<Vec<f64>> = (0..size).map(|_| Vec::new()).collect();
        for i in rows(self.rows.rank()) {
            write(i, &mut row);
            written.iter_mut().enumerate().for_each(|(rank, piece)| piece.extend_from_slice(&row[columns(rank)]));
        }
        let own = columns(self.rows.rank()).len();
        self.rows.exchange(written, |rank| rows(rank).len() * own)
    }

    /// The numbers that go to the other ranks: where they lie rank by rank, tile by tile, and where in local rows of
    /// tiles.
    fn pieces(&self, across: usize) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        let (rows, mut packed) = (self.down[self.rows.rank()].len(), 0);
        let all = self.across.iter().flat_map(move |panels| (0..rows).map(move |row| (row, panels)));
        all.map(move |(row, panels)| {
            let (from, length) = ((row * across + panels.start) * AREA, panels.len() * AREA);
            packed += length;
            (packed - length..packed, from..from + length)
        })
    }

    /// Most complex values that this rank has at a time, of local rows or of local columns.
    pub(super) fn most(&self) -> usize {
        self.sent.iter().sum::<usize>().max(self.received.iter().sum()) / 2
    }
}

/// The tiles that hold these rows, which are whole tiles.
fn tiles(rows: Range<usize>, high: usize) -> Range<usize> {
    rows.start.div_ceil(high)..rows.end.div_ceil(high)
}

impl SpectralOperator {
    /// Convolves local rows: the result remains in the workspace, its rows still transformed. A single column remains
    /// in the cell values of all ranks.
    pub(super) fn convolve_shared(&self, shares: &Shares, input: &[f64], work: &mut TransformWorkspace) {
        if let Some(column) = &self.column {
            let mut all = std::mem::take(&mut work.column.all);
            let own = |rank| shares.rows.of(rank).len();
            shares.rows.gather(input.iter().copied(), own, |found| all.copy_from_slice(found));
            self.convolve_column(column, &all, &mut work.column);
            self.read_column(column, &work.column, &mut all);
            work.column.all = all;
            return;
        }
        let Shares { rows, down, across, sent, received } = shares;
        let (own_down, own_across) = (down[rows.rank()].len(), across[rows.rank()].len());
        let (of_rows, of_columns) = (own_down * self.across() * AREA, own_across * self.down() * AREA);
        let TransformWorkspace { tiles, result, lanes, .. } = work;

        let task = RowsForward { operator: self, input };
        if of_rows > 0 {
            for_each_share(&task, lanes, &mut tiles[..of_rows], of_rows);
        }
        for (packed, at) in shares.pieces(self.across()) {
            result[packed].copy_from_slice(&tiles[at]);
        }
        let exchange = |(send, sent): (&[Complex64], &[usize]), (got, counts): (&mut [Complex64], &[usize])| {
            rows.exchange_into((cast_slice(send), sent), (cast_slice_mut(got), counts));
        };
        exchange((&result[..of_rows], sent), (&mut tiles[..of_columns], received));

        // the tiles received lie as in a process that has all rows
        let task = ColumnsInPlace { operator: self, across: own_across };
        for_each_share(&task, lanes, &mut tiles[..of_columns], usize::MAX);

        exchange((&tiles[..of_columns], received), (&mut result[..of_rows], sent));
        for (packed, at) in shares.pieces(self.across()) {
            tiles[at].copy_from_slice(&result[packed]);
        }
    }
}
