//! Halo rows, where ranks share the rows of a field.

use std::ops::Range;
use std::sync::Arc;

use num_complex::Complex64;

use crate::parallel::{Ranks, Rows, unwind_rank_loss};
use crate::solver::extension::passes::{NOTHING_KNOWN, weight};

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
        let Some(group) = rows.group() else { return HaloRows::default() };
        let own = of(group.rank());
        if own.is_empty() {
            return HaloRows::default();
        }
        let before = own.start.checked_sub(1).or(periodic.then_some(n1 - 1));
        let after = Some(own.end).filter(|&row| row < n1).or(periodic.then_some(0));
        let halo_row = |row: usize| {
            let rank = (0..group.size()).find(|&rank| rank != group.rank() && of(rank).contains(&row))?;
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

    /// The values of one of the rows.
    pub(super) fn row(&self, row: usize) -> &[f64] {
        self.rows.iter().flatten().find(|halo| halo.row == row).map_or(&[], |halo| &halo.values)
    }
}

/// Exchanges rows with the neighbours, in buffers of its own.
#[derive(Debug, Clone)]
pub(crate) struct HaloExchange {
    group: Arc<dyn Ranks>,
    row: Vec<f64>,
    send: Vec<Complex64>,
    received: Vec<Complex64>,
    counts: Vec<usize>,
}

impl HaloExchange {
    /// For rows of at most so many columns.
    pub(crate) fn new(group: &Arc<dyn Ranks>, columns: usize) -> HaloExchange {
        let two_rows = vec![Complex64::default(); 2 * columns.div_ceil(2)];
        let counts = vec![0; group.size()];
        HaloExchange {
            group: Arc::clone(group),
            row: vec![0.0; columns],
            send: two_rows.clone(),
            received: two_rows,
            counts,
        }
    }

    /// Fills the halo rows, `columns` long; `write` gives the first local row, and the last.
    pub(crate) fn fetch(&mut self, halo: &mut HaloRows, columns: usize, own: usize, write: impl Fn(usize, &mut [f64])) {
        let HaloExchange { group, row, send, received, counts } = self;
        let (row, length) = (&mut row[..columns], columns.div_ceil(2));
        let mut sent = 0;
        for (rank, count) in counts.iter_mut().enumerate() {
            *count = 0;
            // the rank of the row before the local rows needs the first of them, the rank of the row after them the last
            for (halo, k) in halo.rows.iter().zip([0, own.saturating_sub(1)]) {
                if halo.as_ref().is_some_and(|halo| halo.rank == rank) {
                    write(k, row);
                    let pairs = row.chunks(2).map(|pair| Complex64::new(pair[0], pair.get(1).copied().unwrap_or(0.0)));
                    send[sent..sent + length].iter_mut().zip(pairs).for_each(|(z, pair)| *z = pair);
                    (sent, *count) = (sent + length, *count + length);
                }
            }
        }
        group
            .exchange(&send[..sent], counts, &mut received[..sent], counts)
            .unwrap_or_else(|error| unwind_rank_loss(error));
        let mut next = received.chunks_exact(length);
        for rank in 0..counts.len() {
            // of a rank that has both rows, its first one, which is the row after the local rows, comes first
            for halo in halo.rows.iter_mut().rev().flatten().filter(|halo| halo.rank == rank) {
                let pairs = halo.values.chunks_mut(2).zip(next.next().unwrap_or(&[]));
                pairs.for_each(|(out, z)| out.iter_mut().zip([z.re, z.im]).for_each(|(out, part)| *out = part));
            }
        }
    }
}
