//! Halo rows, where ranks share the rows of a field.

use std::ops::Range;

use crate::parallel::Rows;
use crate::solver::extension::weights::{NOTHING_KNOWN, weight};

/// Halo rows of a level: the row before the local rows and the row after them, where another rank holds these.
#[derive(Debug, Clone, Default)]
pub(crate) struct HaloRows {
    rows: [Option<HaloRow>; 2],
    /// The members of a halo row, none, and its factors φ, all for w = 0: halo values are multiplied by 1 − w already.
    pub(super) no_members: Vec<bool>,
    pub(super) nothing_known: Vec<f64>,
}

/// A row of another rank.
#[derive(Debug, Clone)]
struct HaloRow {
    rank: usize,
    row: usize,
    values: Vec<f64>,
}

impl HaloRows {
    /// For a level of `n1` rows of `n2` values; `of` gives the rows of each rank.
    pub(crate) fn new(
        rows: &Rows,
        of: impl Fn(usize) -> Range<usize>,
        [n1, n2]: [usize; 2],
        periodic: bool,
    ) -> HaloRows {
        let own = of(rows.rank());
        if !rows.are_shared() || own.is_empty() {
            return HaloRows::default();
        }
        let before = own.start.checked_sub(1).or(periodic.then_some(n1 - 1));
        let after = Some(own.end).filter(|&row| row < n1).or(periodic.then_some(0));
        let halo_row = |row: usize| {
            let rank = (0..rows.ranks()).find(|&rank| rank != rows.rank() && of(rank).contains(&row))?;
            Some(HaloRow { rank, row, values: vec![0.0; n2] })
        };
        debug_assert_eq!(weight(NOTHING_KNOWN), 0.0);
        HaloRows {
            rows: [before, after].map(|row| row.and_then(halo_row)),
            no_members: vec![false; n2],
            nothing_known: vec![NOTHING_KNOWN; n2],
        }
    }

    /// The values of the row before the local rows, if another rank holds it.
    pub(crate) fn before(&self) -> Option<&[f64]> {
        self.rows[0].as_ref().map(|halo| &halo.values[..])
    }

    /// The values of the row after the local rows, if another rank holds it.
    pub(crate) fn after(&self) -> Option<&[f64]> {
        self.rows[1].as_ref().map(|halo| &halo.values[..])
    }

    /// The values of one of the rows.
    pub(super) fn row(&self, row: usize) -> &[f64] {
        self.rows.iter().flatten().find(|halo| halo.row == row).map_or(&[], |halo| &halo.values)
    }
}

/// Exchanges rows with the neighbours, in buffers of its own.
#[derive(Debug, Clone)]
pub(crate) struct HaloExchange {
    rows: Rows,
    send: Vec<f64>,
    received: Vec<f64>,
    counts: Vec<usize>,
}

impl HaloExchange {
    /// For rows of at most so many columns, if ranks share them.
    pub(crate) fn new(rows: &Rows, columns: usize) -> Option<HaloExchange> {
        let (two_rows, counts) = (vec![0.0; 2 * columns], vec![0; rows.ranks()]);
        rows.are_shared().then(|| HaloExchange {
            rows: rows.clone(),
            send: two_rows.clone(),
            received: two_rows,
            counts,
        })
    }

    /// Fills the halo rows, `columns` long; `write` gives the first local row, and the last.
    pub(crate) fn fetch(&mut self, halo: &mut HaloRows, columns: usize, own: usize, write: impl Fn(usize, &mut [f64])) {
        let HaloExchange { rows, send, received, counts } = self;
        let mut sent = 0;
        for (rank, count) in counts.iter_mut().enumerate() {
            *count = 0;
            // the rank of the row before the local rows needs the first of them, the rank of the row after them the
            // last
            for (halo, k) in halo.rows.iter().zip([0, own.saturating_sub(1)]) {
                if halo.as_ref().is_some_and(|halo| halo.rank == rank) {
                    write(k, &mut send[sent..sent + columns]);
                    (sent, *count) = (sent + columns, *count + columns);
                }
            }
        }
        rows.exchange_into((&send[..sent], counts), (&mut received[..sent], counts));
        let mut next = received.chunks_exact(columns);
        for rank in 0..counts.len() {
            // of a rank that has both rows, its first one, which is the row after the local rows, comes first
            let rows = halo.rows.iter_mut().rev().flatten().filter(|halo| halo.rank == rank);
            rows.zip(&mut next).for_each(|(halo, values)| halo.values.copy_from_slice(values));
        }
    }
}
