//! Cells, boundaries and symmetries of an operator, and the lengths of its transforms.

use std::f64::consts::TAU;

/// Number of mirror images of a cell, itself included, where axes are folded.
pub(crate) fn images(folded: [bool; 2]) -> usize {
    folded.into_iter().map(|folded| if folded { 2 } else { 1 }).product()
}

/// What follows beyond the cells of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ends {
    /// Nothing: padded with zeros, so that the convolution is linear.
    Free,
    /// The same cells again.
    Periodic,
    /// The same cells again, after as many zeros as make the transform fast: for operators that need not be exact.
    Wrapped,
    /// The same cells again, as if a kernel that ends were periodic.
    Closed,
}

/// Cells, boundaries and symmetries of an operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Cells along each axis; half of them along a folded axis.
    pub(crate) cells: [usize; 2],
    /// What follows beyond the cells of each axis.
    pub(crate) ends: [Ends; 2],
    /// Axes about whose beginning all fields are even.
    pub(crate) folded: [bool; 2],
}

impl Layout {
    /// The length of the transforms along an axis.
    pub(super) fn line(&self, axis: usize) -> usize {
        let cells = self.cells[axis];
        match (self.ends[axis], self.folded[axis]) {
            (Ends::Free, true) => fast_length(2 * cells),
            (Ends::Free, false) => fast_length(2 * cells - 1),
            // without any zeros where a length is fast enough: a field that is not zero at the end jumps there
            (Ends::Wrapped, _) => {
                if is_fast(cells) {
                    cells
                } else {
                    fast_length(cells)
                }
            }
            (Ends::Periodic | Ends::Closed, _) => cells,
        }
    }

    /// Number of independent coefficients of a real line along an axis: the others mirror them.
    pub(super) fn independent(&self, axis: usize) -> usize {
        if self.folded[axis] { self.line(axis) } else { self.line(axis) / 2 + 1 }
    }

    /// The layout of an operator that need not be exact: no padding but for fast transforms.
    pub(super) fn wrapped(&self) -> Layout {
        self.ending(Ends::Wrapped)
    }

    /// The layout with other ends where the cells end.
    pub(super) fn ending(&self, other: Ends) -> Layout {
        let ends = self.ends.map(|end| if end == Ends::Free { other } else { end });
        Layout { ends, ..*self }
    }

    /// Cells along an axis and their mirror images.
    pub(super) fn unfolded(&self, axis: usize) -> usize {
        self.cells[axis] * if self.folded[axis] { 2 } else { 1 }
    }

    /// The period of the fields \[cells\].
    pub(crate) fn period(&self, axis: usize) -> usize {
        self.line(axis) * if self.folded[axis] { 2 } else { 1 }
    }
}

/// The sum of the waves ±`k` of a period, `at` cells from their crest: one of them if they are the same.
pub(crate) fn waves_at(at: usize, k: usize, period: usize) -> f64 {
    let count = if k == 0 || 2 * k == period { 1.0 } else { 2.0 };
    count * (TAU * ((k as f64 * at as f64) % period as f64) / period as f64).cos()
}

/// Whether a length is transformed hardly slower than a power of two: see [`fast_length`].
pub(super) fn is_fast(cells: usize) -> bool {
    cells.is_multiple_of(if cells > 32 { 16 } else { 4 }) && least_smooth(cells) == cells
}

/// The length ≥ `least` that is transformed fastest, of those whose only prime factors are 2, 3, 5 and 7.
///
/// Measured with rustfft on one processor with AVX: n log₂ n takes 0.12 to 0.14 ns per unit for powers of two, 0.15 to
/// 0.2 for multiples of 16, and up to 0.3 for others: 63 takes 1.7 times as long as 64, 500 2.3 times as long as 512.
pub(crate) fn fast_length(least: usize) -> usize {
    let power = least.next_power_of_two();
    let step = if least > 32 { 16 } else { 4 };
    let other = step * least_smooth(least.div_ceil(step));
    if 10 * power as u128 <= 12 * other as u128 { power } else { other }
}

/// The least number ≥ `least` whose only prime factors are 2, 3, 5 and 7: each product of the odd ones is completed by
/// the least power of two. A search upwards would take too long for large numbers.
fn least_smooth(least: usize) -> usize {
    let mut best = least.next_power_of_two();
    let mut sevens = 1_usize;
    while sevens < best {
        let mut fives = sevens;
        while fives < best {
            let mut threes = fives;
            while threes < best {
                best = best.min(threes * least.div_ceil(threes).next_power_of_two());
                threes = threes.saturating_mul(3);
            }
            fives = fives.saturating_mul(5);
        }
        sevens = sevens.saturating_mul(7);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fast_lengths_are_the_least_smooth_ones() {
        assert_eq!([1, 2, 3, 9, 63, 65, 95, 127, 129, 225].map(fast_length), [1, 2, 4, 12, 64, 80, 96, 128, 144, 256]);
        assert_eq!([511, 513, 641, 1023, 1999, 8191].map(fast_length), [512, 560, 672, 1024, 2048, 8192]);
        assert!((1..3000).all(|n| fast_length(n) >= n && fast_length(n) <= n + n / 3 + 16));
        let plain = |least: usize| (least..).find(|n| [2, 3, 5, 7].iter().fold(*n, divided) == 1).unwrap();
        assert!((1..3000).all(|n| least_smooth(n) == plain(n)));
        // the greatest period of any grid, and numbers that a search upwards would not reach
        for n in [(1 << 61) - 1, 1 << 61, (1 << 40) + 1, 3 << 50, 12_345_678_901_234_567] {
            let found = least_smooth(n);
            assert!(found >= n && (found - n) as f64 <= 0.01 * n as f64, "{n} {found}");
            assert_eq!([2, 3, 5, 7].iter().fold(found, divided), 1);
        }
    }

    fn divided(mut n: usize, factor: &usize) -> usize {
        while n.is_multiple_of(*factor) {
            n /= factor;
        }
        n
    }
}
