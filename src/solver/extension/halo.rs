//! Rows of neighbours, where ranks share out the rows of a field.

use std::ops::Range;
use std::sync::Arc;

use num_complex::Complex64;

use crate::parallel::{Ranks, Rows, unwind_rank_loss};
use crate::solver::extension::passes::{NOTHING_KNOWN, weight};

/// Halo rows of a level: the row before the local rows and the row after them, where another rank has these.
#[derive(Debug, Clone, Default)]
pub(crate) struct HaloRows {
    /// The rank that has each.
    partners: [Option<usize>; 2],
    /// Their numbers.
    rows: [usize; 2],
    values: [Vec<f64>; 2],
    /// What is known of cells whose values come without what is known of them.
    outside: Vec<bool>,
    open: Vec<f64>,
}

impl HaloRows {
    /// Of a level of so many rows and columns; `of` gives the rows of each rank.
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
        let beside = [before, after].map(|row| row.filter(|row| !own.contains(row)));
        let owner = |row: usize| (0..group.size()).find(|&rank| of(rank).contains(&row));
        let field = |row: Option<usize>| vec![0.0; if row.is_some() { n2 } else { 0 }];
        debug_assert_eq!(weight(NOTHING_KNOWN), 0.0);
        HaloRows {
            partners: beside.map(|row| row.and_then(owner)),
            rows: beside.map(|row| row.unwrap_or(usize::MAX)),
            values: beside.map(field),
            outside: vec![false; n2],
            open: vec![NOTHING_KNOWN; n2],
        }
    }

    /// The values of the row before the local rows, if another rank has it.
    pub(crate) fn before(&self) -> Option<&[f64]> {
        self.partners[0].map(|_| &self.values[0][..])
    }

    /// The values of one of the two rows.
    pub(super) fn row(&self, row: usize) -> &[f64] {
        if row == self.rows[0] { &self.values[0] } else { &self.values[1] }
    }

    /// That none of its cells is in the set.
    pub(super) fn outside(&self) -> &[bool] {
        &self.outside
    }

    /// The factor of blocks of which nothing is known.
    pub(super) fn open(&self) -> &[f64] {
        &self.open
    }
}

/// Fetches rows from neighbours.
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
        let asked_by = |rank: usize, which: usize| halo.partners[which] == Some(rank);
        let mut sent = 0;
        for (rank, count) in counts.iter_mut().enumerate() {
            *count = 0;
            // who has the row before mine needs my first, who has the one behind mine my last
            for (which, k) in [(0, 0), (1, own.saturating_sub(1))] {
                if asked_by(rank, which) {
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
            // of one that has both, its first row, which lies behind mine, comes first
            for which in [1, 0] {
                if halo.partners[which] == Some(rank)
                    && let Some(values) = next.next()
                {
                    let pairs = halo.values[which].chunks_mut(2).zip(values);
                    pairs.for_each(|(out, z)| out.iter_mut().zip([z.re, z.im]).for_each(|(out, part)| *out = part));
                }
            }
        }
    }
}
