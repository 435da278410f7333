//! Least squares with unknowns of zero or more, by their normal equations.

use faer::linalg::solvers::Solve;
use faer::{Col, Mat};

/// Gradients below this fraction of the largest are rounding.
const ROUNDING: f64 = 1e-13;

/// Minimises ½ xᵀ G x − hᵀ x over x ≥ 0 by the active set method of Lawson & Hanson (*Solving Least Squares Problems*, 1974, chapter
/// 23) on a positive definite G. Also returns which unknowns are free.
pub(crate) fn non_negative(gram: &Mat<f64>, right: &[f64]) -> (Vec<f64>, Vec<bool>) {
    let count = right.len();
    let mut x = vec![0.0; count];
    let mut free = vec![false; count];
    let scale: Vec<f64> = (0..count).map(|j| gram[(j, j)].sqrt()).collect();
    let largest = (0..count).fold(0.0, |most: f64, j| most.max((right[j] / scale[j]).abs()));
    for _ in 0..3 * count {
        let gradient = |j: usize| (right[j] - (0..count).map(|k| gram[(j, k)] * x[k]).sum::<f64>()) / scale[j];
        let steepest = (0..count).filter(|&j| !free[j]).map(|j| (gradient(j), j)).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, entering)) = steepest.filter(|(slope, _)| *slope > ROUNDING * largest) else { break };
        free[entering] = true;
        loop {
            let solved = solve(gram, right, &free);
            let blocked = |j: &usize| free[*j] && solved[*j] <= 0.0;
            let shares = (0..count).filter(blocked).map(|j| x[j] / (x[j] - solved[j]));
            let share = shares.fold(1.0, f64::min);
            for j in 0..count {
                x[j] += share * (solved[j] - x[j]);
            }
            if share == 1.0 && !(0..count).any(|j| blocked(&j)) {
                break;
            }
            for j in 0..count {
                if free[j] && x[j] * scale[j] <= ROUNDING * largest {
                    (x[j], free[j]) = (0.0, false);
                }
            }
        }
    }
    (x, free)
}

/// The unconstrained minimum over the free unknowns.
fn solve(gram: &Mat<f64>, right: &[f64], free: &[bool]) -> Vec<f64> {
    let at: Vec<usize> = (0..right.len()).filter(|&j| free[j]).collect();
    let matrix = Mat::from_fn(at.len(), at.len(), |i, j| gram[(at[i], at[j])]);
    let solved = matrix.partial_piv_lu().solve(&Col::from_fn(at.len(), |i| right[at[i]]));
    let mut x = vec![0.0; right.len()];
    for (k, &j) in at.iter().enumerate() {
        x[j] = if solved[k].is_finite() { solved[k] } else { 0.0 };
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
        for _ in 0..200 {
            let a = Mat::from_fn(12, 8, |_, _| random());
            let b = Col::from_fn(12, |_| random());
            let gram = a.transpose() * &a;
            let right: Vec<f64> = (a.transpose() * &b).iter().copied().collect();
            let (x, free) = non_negative(&gram, &right);
            for j in 0..8 {
                let slope = right[j] - (0..8).map(|k| gram[(j, k)] * x[k]).sum::<f64>();
                assert!(x[j] >= 0.0 && slope < 1e-10 && (!free[j] || slope.abs() < 1e-10), "{x:?} {slope}");
            }
        }
    }
}
