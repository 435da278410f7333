//! Rows of neighbours, where ranks share out the rows of a field.

use std::ops::Range;

use crate::parallel::Rows;
use crate::solver::extension::passes::{NOTHING_KNOWN, weight};

/// Halo rows of a level: the row before the local rows and the row after them, where another rank has these.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ghosts {
    /// The rank that has each.
    partners: [Option<usize>; 2],
    /// Their numbers.
    rows: [usize; 2],
    values: [Vec<f64>; 2],
    /// What is known of cells whose values come without what is known of them.
    outside: Vec<bool>,
    open: Vec<f64>,
}

impl Ghosts {
    /// Of a level of so many rows and columns; `of` gives the rows of each rank.
    pub(crate) fn beside(
        rows: &Rows,
        of: impl Fn(usize) -> Range<usize>,
        [n1, n2]: [usize; 2],
        periodic: bool,
    ) -> Ghosts {
        if !rows.are_shared() {
            return Ghosts::default();
        }
        let own = of(rows.rank());
        if own.is_empty() {
            return Ghosts::default();
        }
        let before = own.start.checked_sub(1).or(periodic.then_some(n1 - 1));
        let after = Some(own.end).filter(|&row| row < n1).or(periodic.then_some(0));
        let beside = [before, after].map(|row| row.filter(|row| !own.contains(row)));
        let owner = |row: usize| (0..rows.ranks()).find(|&rank| of(rank).contains(&row));
        let field = |row: Option<usize>| vec![0.0; if row.is_some() { n2 } else { 0 }];
        debug_assert_eq!(weight(NOTHING_KNOWN), 0.0);
        Ghosts {
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
    rows: Rows,
    send: Vec<f64>,
    received: Vec<f64>,
    counts: Vec<usize>,
}

impl HaloExchange {
    /// For rows of at most so many columns, if ranks share them out.
    pub(crate) fn new(rows: &Rows, columns: usize) -> Option<HaloExchange> {
        let two_rows = vec![0.0; 2 * columns];
        let counts = vec![0; rows.ranks()];
        rows.are_shared().then(|| HaloExchange {
            rows: rows.clone(),
            send: two_rows.clone(),
            received: two_rows,
            counts,
        })
    }

    /// Fills the halo rows, `columns` long; `write` gives the first local row, and the last.
    pub(crate) fn fetch(&mut self, ghosts: &mut Ghosts, columns: usize, own: usize, write: impl Fn(usize, &mut [f64])) {
        let HaloExchange { rows, send, received, counts } = self;
        let mut sent = 0;
        for (rank, count) in counts.iter_mut().enumerate() {
            *count = 0;
            // who has the row before mine needs my first, who has the one behind mine my last
            for (which, k) in [(0, 0), (1, own.saturating_sub(1))] {
                if ghosts.partners[which] == Some(rank) {
                    write(k, &mut send[sent..sent + columns]);
                    (sent, *count) = (sent + columns, *count + columns);
                }
            }
        }
        rows.exchange_into((&send[..sent], counts), (&mut received[..sent], counts));
        let mut next = received.chunks_exact(columns);
        for rank in 0..counts.len() {
            // of one that has both, its first row, which lies behind mine, comes first
            for which in [1, 0] {
                if ghosts.partners[which] == Some(rank)
                    && let Some(values) = next.next()
                {
                    ghosts.values[which].copy_from_slice(values);
                }
            }
        }
    }
}
