//! The contact area of a contact that ranks share out.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::equilibrium::Held;
use crate::fields::Fields;
use crate::fields::area::{PressedCells, REACH};
use crate::parallel::Rows;

/// Rows that are looked at together.
const PIECE: usize = 64;
/// In place of a pressure where there is nothing to touch: where bodies are apart it is −h.
const NOTHING: f64 = f64::NEG_INFINITY;

impl Fields<'_> {
    /// The contact area \[m²\]: each rank finds the covered part of its rows of squares, and the parts of all ranks
    /// are added in the order of the rows.
    pub(super) fn shared_area(&self) -> f64 {
        let Held { region, current, .. } = self.held;
        let (rows, [n1, n2]) = (region.rows(), self.grid().cells());
        let extent = region.reach(&current.solution.pressure);
        let beside = self.rows_beside(&rows);
        // squares whose upper corners are in some rows; the last rows have those across the end, too
        let squares = |rows: Range<usize>| {
            let beyond = usize::from(rows.end == n1 && !rows.is_empty());
            rows.start..rows.end + beyond
        };
        let (mut covered, mut marked, mut pressure) = (Vec::new(), Vec::new(), Vec::new());
        for half in self.with_images(region.computed_rows()) {
            for start in half.clone().step_by(PIECE) {
                let piece = start..(start + PIECE).min(half.end);
                let first = start as isize - 1 - REACH as isize;
                let near = first..piece.end as isize + 1 + REACH as isize;
                marked.clear();
                marked.resize(near.len() * n2, NOTHING);
                for (row, out) in near.zip(marked.chunks_exact_mut(n2)) {
                    match self.computed_row(row) {
                        Some(row) if region.computed_rows().contains(&row) => self.marked_row(row, out),
                        Some(row) => beside.get(&row).into_iter().for_each(|row| out.copy_from_slice(row)),
                        None => {}
                    }
                }
                pressure.clear();
                pressure.extend(marked.iter().map(|p| p.max(0.0)));
                let gap = |k: usize| -marked[k];
                let (periodic, first) = (self.ground.kernel.periodic_axes(), Some(first));
                let pressed =
                    PressedCells { grid: self.grid(), first, periodic, pressure: &pressure, gap: &gap, extent };
                covered.extend(squares(piece).map(|row| [pressed.covered_in_row(row)]));
            }
        }
        let [covered] =
            self.sum_in_order(covered.into_iter(), |rank| self.with_images(self.rows_of(rank)).map(squares));
        covered * self.grid().cell_area()
    }

    /// The computed row of a row or of its mirror image; none beyond a grid that ends.
    fn computed_row(&self, row: isize) -> Option<usize> {
        let (n1, folded) = (self.grid().cells()[0], self.held.region.folded()[0]);
        let row = if self.ground.kernel.periodic_axes()[0] { row.rem_euclid(n1 as isize) } else { row };
        let row = usize::try_from(row).ok().filter(|&row| row < n1)?;
        Some(if folded && row < n1 / 2 { n1 - 1 - row } else { row })
    }

    /// The pressure of an own row, marked where there is none.
    fn marked_row(&self, row: usize, out: &mut [f64]) {
        let region = &self.held.region;
        let (row, [_, m2], n2) = (row - region.computed_rows().start, region.cells(), out.len());
        out.copy_from_slice(&self.pressure()[row * n2..(row + 1) * n2]);
        for j in 0..m2 {
            // of a folded axis the first half are images
            let both = [n2 - m2 + j, if region.folded()[1] { m2 - 1 - j } else { j }];
            if out[both[0]] <= 0.0 {
                both.into_iter().for_each(|column| out[column] = -self.gap_of(row * m2 + j).max(0.0));
            }
        }
    }

    /// Halo: rows of other ranks that are near enough to the local rows to matter.
    fn rows_beside(&self, shared: &Rows) -> BTreeMap<usize, Vec<f64>> {
        let reach = 1 + REACH as isize;
        let wanted = |rank: usize| {
            let own = self.rows_of(rank);
            let (start, end) = (own.start as isize, own.end as isize);
            let near = (start - reach..start).chain(end..end + reach).filter(|_| !own.is_empty());
            near.filter_map(|row| self.computed_row(row)).filter(|row| !own.contains(row)).collect::<BTreeSet<_>>()
        };
        let n2 = self.grid().cells()[1];
        let own = self.rows_of(shared.rank());
        let pieces = (0..shared.ranks()).map(|rank| {
            let sent = wanted(rank).into_iter().filter(|row| own.contains(row)).collect::<Vec<_>>();
            let mut piece = vec![0.0; sent.len() * n2];
            sent.into_iter().zip(piece.chunks_exact_mut(n2)).for_each(|(row, out)| self.marked_row(row, out));
            piece
        });
        let rows = wanted(shared.rank());
        let count = |rank: usize| n2 * rows.range(self.rows_of(rank)).count();
        let received = shared.exchange(pieces.collect(), count);
        let fields = received.chunks_exact(n2).map(<[f64]>::to_vec).collect::<Vec<_>>();
        rows.into_iter().zip(fields).collect()
    }
}
