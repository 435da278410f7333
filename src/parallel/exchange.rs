//! Real numbers that go from rank to rank.

use std::ops::Range;

use num_complex::Complex64;

use super::rows::unwind_rank_loss;
use super::{Ranks, Rows};
use crate::error::RanksError;

/// Sends each rank its piece, and returns the `count` numbers of each rank, one rank after the other. Two numbers travel as a
/// complex one.
///
/// # Errors
/// If a rank has left.
pub(crate) fn exchange_numbers(
    group: &dyn Ranks,
    pieces: Vec<Vec<f64>>,
    count: impl Fn(usize) -> usize,
) -> Result<Vec<f64>, RanksError> {
    let sent: Vec<usize> = pieces.iter().map(|piece| piece.len().div_ceil(2)).collect();
    let mut send = Vec::with_capacity(sent.iter().sum());
    for piece in pieces {
        send.extend(piece.chunks(2).map(|pair| Complex64::new(pair[0], pair.get(1).copied().unwrap_or(0.0))));
    }
    let counts: Vec<usize> = (0..group.size()).map(|rank| count(rank).div_ceil(2)).collect();
    let mut received = vec![Complex64::default(); counts.iter().sum()];
    group.exchange(&send, &sent, &mut received, &counts)?;
    drop(send);
    let mut numbers = Vec::with_capacity((0..group.size()).map(&count).sum());
    let mut rest = &received[..];
    for (rank, pairs) in counts.into_iter().enumerate() {
        let (own, others) = rest.split_at(pairs);
        numbers.extend(own.iter().flat_map(|pair| [pair.re, pair.im]).take(count(rank)));
        rest = others;
    }
    Ok(numbers)
}

impl Rows {
    /// Brings a field of own rows to those who have them of the rows `to`, which begin at the row `first` of these.
    pub(crate) fn moved(&self, field: &[f64], first: usize, to: &Rows) -> Vec<f64> {
        let Some(group) = self.group() else { return field.to_vec() };
        let columns = self.cells()[1];
        let common = |from: Range<usize>, to: Range<usize>| {
            let start = from.start.max(first + to.start);
            start..from.end.min(first + to.end).max(start)
        };
        let own = self.own();
        let pieces = (0..self.ranks()).map(|rank| {
            let rows = common(self.own(), to.of(rank));
            // an empty piece may begin beyond the own rows
            if rows.is_empty() {
                Vec::new()
            } else {
                field[(rows.start - own.start) * columns..(rows.end - own.start) * columns].to_vec()
            }
        });
        exchange_numbers(&**group, pieces.collect(), |rank| common(self.of(rank), to.own()).len() * columns)
            .unwrap_or_else(|error| unwind_rank_loss(error))
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
