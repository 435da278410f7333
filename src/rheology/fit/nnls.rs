//! Non-negative least squares.

use faer::linalg::solvers::SolveLstsqCore;
use faer::{Col, Conj, Mat, Scale};

/// Solves min |A x − b| over x ≥ 0 by the active set method of Lawson & Hanson (*Solving Least Squares
/// Problems*, 1974, chapter 23). The solution is sparse: few of many similar columns are used.
pub(crate) fn non_negative_least_squares(a: &Mat<f64>, b: &Col<f64>) -> Vec<f64> {
    let columns = a.ncols();
    // columns are normalised, so that gradients are comparable
    let norms: Vec<f64> = (0..columns).map(|j| a.col(j).norm_l2()).collect();
    let mut x = vec![0.0; columns];
    let mut passive: Vec<usize> = Vec::new();
    let mut refused = vec![false; columns];
    let enough = 1e-14 * b.norm_l2();
    for _ in 0..3 * columns {
        let mut residual = b.clone();
        for &j in &passive {
            residual -= Scale(x[j]) * a.col(j);
        }
        let gradient = |j: usize| (a.col(j).transpose() * &residual) / norms[j];
        let candidates = (0..columns).filter(|j| norms[*j] > 0.0 && !refused[*j] && !passive.contains(j));
        let best = candidates.map(|j| (gradient(j), j)).max_by(|one, other| one.0.total_cmp(&other.0));
        let Some((_, entering)) = best.filter(|(steepest, _)| *steepest > enough && passive.len() < a.nrows()) else {
            break;
        };
        passive.push(entering);
        let mut solved = least_squares(a, &passive, b);
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
            solved = least_squares(a, &passive, b);
        }
        for (&j, &value) in passive.iter().zip(&solved) {
            x[j] = value.max(0.0);
        }
        refused.fill(false);
    }
    x
}

/// The least squares solution on some columns.
fn least_squares(a: &Mat<f64>, columns: &[usize], b: &Col<f64>) -> Vec<f64> {
    let part = Mat::from_fn(a.nrows(), columns.len(), |i, k| a[(i, columns[k])]);
    solve(&part, b)
}

/// min |A x − b| by Householder QR with column pivoting; at least as many rows as columns.
pub(crate) fn solve(a: &Mat<f64>, b: &Col<f64>) -> Vec<f64> {
    let mut right = Mat::from_fn(b.nrows(), 1, |i, _| b[i]);
    a.col_piv_qr().solve_lstsq_in_place_with_conj(Conj::No, right.as_mut());
    (0..a.ncols()).map(|j| right[(j, 0)]).collect()
}
