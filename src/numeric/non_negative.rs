//! Non-negative least squares.

use crate::dense::{Matrix, norm, product};

/// Solves min |A x − b| over x ≥ 0 by the active set method of Lawson & Hanson (*Solving Least Squares Problems*,
/// 1974, chapter 23), with A of one row for each of `right` and so many columns. The solution is sparse: few of many
/// similar columns are used.
///
/// ```
/// use viscocontact::numeric::non_negative_least_squares;
///
/// // the second unknown would be −1
/// let rows = [[1.0, 1.0], [1.0, -1.0]];
/// let found = non_negative_least_squares(&[1.0, 3.0], 2, |row, column| rows[row][column]);
/// assert!((found[0] - 2.0).abs() < 1e-12 && found[1] == 0.0);
/// ```
pub fn non_negative_least_squares(right: &[f64], columns: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let a = Matrix::from_fn(right.len(), columns, entry);
    // columns are normalised, so that gradients are comparable
    let norms: Vec<f64> = (0..columns).map(|j| norm(a.column(j))).collect();
    let mut x = vec![0.0; columns];
    let mut passive: Vec<usize> = Vec::new();
    let mut refused = vec![false; columns];
    let enough = 1e-14 * norm(right);
    for _ in 0..3 * columns {
        let mut residual = right.to_vec();
        for &j in &passive {
            residual.iter_mut().zip(a.column(j)).for_each(|(left, entry)| *left -= x[j] * entry);
        }
        let gradient = |j: usize| product(a.column(j), &residual) / norms[j];
        let candidates = (0..columns).filter(|j| norms[*j] > 0.0 && !refused[*j] && !passive.contains(j));
        let best = candidates.map(|j| (gradient(j), j)).max_by(|one, other| one.0.total_cmp(&other.0));
        let Some((_, entering)) = best.filter(|(steepest, _)| *steepest > enough && passive.len() < a.rows()) else {
            break;
        };
        passive.push(entering);
        let mut solved = a.of_columns(&passive).least_squares(right);
        if solved.last().is_none_or(|&value| value <= 0.0) || solved.iter().any(|value| !value.is_finite()) {
            // rounding: the strength is zero, or the column depends on the others
            passive.pop();
            refused[entering] = true;
            continue;
        }
        // move towards the unconstrained solution, removing columns that would turn negative
        while solved.iter().any(|&value| value <= 0.0) {
            let blocked = passive.iter().zip(&solved).filter(|(_, value)| **value <= 0.0);
            let step = blocked.map(|(&j, &value)| x[j] / (x[j] - value)).fold(1.0, f64::min);
            for (&j, &value) in passive.iter().zip(&solved) {
                x[j] += step * (value - x[j]);
            }
            let scale = passive.iter().map(|&j| x[j] * norms[j]).fold(0.0, f64::max);
            let before = passive.len();
            passive.retain(|&j| x[j] * norms[j] > 1e-15 * scale);
            if passive.len() == before {
                break;
            }
            for (j, value) in x.iter_mut().enumerate() {
                if !passive.contains(&j) {
                    *value = 0.0;
                }
            }
            solved = a.of_columns(&passive).least_squares(right);
        }
        for (&j, &value) in passive.iter().zip(&solved) {
            x[j] = value.max(0.0);
        }
        refused.fill(false);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Minima satisfy the conditions of Karush, Kuhn and Tucker.
    #[test]
    fn minima_are_minima() {
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut zeros = 0;
        for _ in 0..200 {
            let entries: Vec<f64> = (0..96).map(|_| random()).collect();
            let b: Vec<f64> = (0..12).map(|_| random()).collect();
            let x = non_negative_least_squares(&b, 8, |i, j| entries[8 * i + j]);
            let left = |i: usize| b[i] - (0..8).map(|j| entries[8 * i + j] * x[j]).sum::<f64>();
            for j in 0..8 {
                let slope: f64 = (0..12).map(|i| entries[8 * i + j] * left(i)).sum();
                assert!(x[j] >= 0.0 && slope < 1e-10 && (x[j] == 0.0 || slope.abs() < 1e-10), "{x:?} {slope}");
                zeros += usize::from(x[j] == 0.0);
            }
        }
        assert!((200..1400).contains(&zeros), "{zeros}");
    }
}
