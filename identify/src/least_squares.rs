//! Non-linear least squares by the method of Levenberg and Marquardt.

use faer::linalg::solvers::Solve;
use faer::{Col, Mat};

use crate::error::{Error, Result};

/// Iterations after which a search has failed.
const MAX_ITERATIONS: usize = 200;
/// A search ends where a step reduces the sum of squares by less than this fraction.
const ENOUGH: f64 = 1e-15;
/// Longest step of a coordinate: a factor of e² in a modulus.
const LONGEST_STEP: f64 = 2.0;
/// Damping above which no step is left.
const MOST_DAMPING: f64 = 1e14;

/// A minimum.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub(crate) coordinates: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    pub(crate) jacobian: Mat<f64>,
    pub(crate) iterations: usize,
}

/// Minimises the sum of squares of `residuals` from `start`. Residuals that cannot be computed reject a step.
pub(crate) fn minimise(
    start: Vec<f64>,
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>>,
    jacobian: impl Fn(&[f64]) -> Result<Mat<f64>>,
) -> Result<Minimum> {
    let mut x = start;
    let mut r = residuals(&x)?;
    let mut sum = square(&r);
    let mut damping = 1e-3;
    for iteration in 0..MAX_ITERATIONS {
        let slopes = jacobian(&x)?;
        let right = slopes.transpose() * Col::from_fn(r.len(), |k| -r[k]);
        let gram = slopes.transpose() * &slopes;
        // the scale of each coordinate; coordinates that move nothing stay
        let scale: Vec<f64> = (0..x.len()).map(|j| gram[(j, j)].sqrt()).map(|s| if s > 0.0 { s } else { 1.0 }).collect();
        let done = loop {
            let step = damped_step(&gram, &right, &scale, damping);
            let longest = step.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            let shorter = (LONGEST_STEP / longest).min(1.0);
            let moved: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + s * shorter).collect();
            let trial = residuals(&moved).ok().map(|r| (square(&r), r)).filter(|(sum, _)| sum.is_finite());
            match trial {
                Some((reduced, residuals)) if reduced < sum => {
                    let enough = sum - reduced <= ENOUGH * sum && longest < 1e-6;
                    (x, r, sum) = (moved, residuals, reduced);
                    damping *= 0.1;
                    break enough;
                }
                _ if longest < 1e-14 || damping > MOST_DAMPING => break true,
                _ => damping = (damping * 10.0).max(1e-9),
            }
        };
        if done || sum == 0.0 {
            let jacobian = jacobian(&x)?;
            return Ok(Minimum { coordinates: x, residuals: r, jacobian, iterations: iteration + 1 });
        }
    }
    let reason = "the sum of squares still falls: give start values, fix parameters, or take a model with fewer of them";
    Err(Error::NotConverged { iterations: MAX_ITERATIONS, reason })
}

/// Solves (JᵀJ + λ D²) s = right, with D the norms of the columns.
fn damped_step(gram: &Mat<f64>, right: &Col<f64>, scale: &[f64], damping: f64) -> Vec<f64> {
    let count = scale.len();
    let scaled = Mat::from_fn(count, count, |i, j| {
        gram[(i, j)] / (scale[i] * scale[j]) + if i == j { damping } else { 0.0 }
    });
    let right = Col::from_fn(count, |i| right[i] / scale[i]);
    let solved = scaled.partial_piv_lu().solve(&right);
    (0..count).map(|i| solved[i] / scale[i]).map(|s| if s.is_finite() { s } else { 0.0 }).collect()
}

/// Sum of squares.
pub(crate) fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_end_of_a_curved_valley() {
        let found = minimise(
            vec![-1.2, 1.0],
            |x| Ok(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]),
            |x| Ok(Mat::from_fn(2, 2, |i, j| [[-20.0 * x[0], 10.0], [-1.0, 0.0]][i][j])),
        );
        let x = found.unwrap().coordinates;
        assert!((x[0] - 1.0).abs() < 1e-10 && (x[1] - 1.0).abs() < 1e-10, "{x:?}");
    }
}
