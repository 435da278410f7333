//! Numbers that go from rank to rank.

use std::ops::Range;

use super::Rows;

impl Rows {
    /// Sends each rank its piece, and returns the `count` numbers of each rank, one rank after the other: zeros if a
    /// rank is lost. A call of all ranks.
    pub(crate) fn exchange(&self, pieces: Vec<Vec<f64>>, count: impl Fn(usize) -> usize) -> Vec<f64> {
        let sent: Vec<usize> = pieces.iter().map(Vec::len).collect();
        let counts: Vec<usize> = (0..self.ranks()).map(count).collect();
        let send = pieces.concat();
        drop(pieces);
        let mut received = vec![0.0; counts.iter().sum()];
        self.exchange_into((&send, &sent), (&mut received, &counts));
        received
    }

    /// Redistributes a field of local rows to the rows `to`, which begin at the row `first` of these rows.
    pub(crate) fn moved(&self, field: &[f64], first: usize, to: &Rows) -> Vec<f64> {
        let columns = self.cells()[1];
        let common = |from: Range<usize>, to: Range<usize>| {
            let start = from.start.max(first + to.start);
            start..from.end.min(first + to.end).max(start)
        };
        let own = self.own();
        let pieces = (0..self.ranks()).map(|rank| {
            let rows = common(self.own(), to.of(rank));
            // an empty piece may begin beyond the local rows
            let cells = (rows.start - own.start) * columns..(rows.end - own.start) * columns;
            field.get(cells).unwrap_or_default().to_vec()
        });
        self.exchange(pieces.collect(), |rank| common(self.of(rank), to.own()).len() * columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::Threads;

    #[test]
    fn rows_move_to_those_who_have_them() {
        for (n1, n2, first, kept) in [(320, 256, 160, 256), (320, 256, 0, 128), (192, 513, 96, 257), (16, 4, 8, 4)] {
            for size in [1, 2, 3, 5, 9] {
                let moved = Threads::run(size, |ranks| {
                    let rows = Rows::of_rank([n1, n2], ranks);
                    let to = rows.of_cells([n1 - first, kept]);
                    let own = rows.own();
                    let field: Vec<f64> = (own.start * n2..own.end * n2).map(|k| k as f64).collect();
                    (to.own(), rows.moved(&field, first, &to))
                });
                for (own, field) in moved.unwrap() {
                    let expected = ((first + own.start) * n2..(first + own.end) * n2).map(|k| k as f64);
                    assert!(field.into_iter().eq(expected), "{n1} {n2} {first} {kept} on {size}");
                }
            }
        }
    }
}
