//! Non-linear least squares by the method of Levenberg and Marquardt.

use faer::linalg::solvers::Solve;
use faer::{Col, Mat};

use crate::error::{Error, Result};

/// Iterations after which a search has failed.
const MAX_ITERATIONS: usize = 200;
/// A search ends where its next step would reduce the sum of squares by less than this fraction: it moves parameters by a
/// millionth of √n standard deviations.
const ENOUGH: f64 = 1e-12;
/// Longest step of a coordinate: a factor of e² in a modulus.
const LONGEST_STEP: f64 = 2.0;
/// Least width of differences: below, rounding is felt.
const LEAST_DIFFERENCE: f64 = 1e-7;
/// Least damping.
const LEAST_DAMPING: f64 = 1e-12;
/// A search ends after some steps that each reduce the sum of squares by less than this fraction: it is at a kink.
const IDLE: f64 = 1e-2;
const MAX_IDLE: usize = 6;
/// Shortest step.
const SHORTEST_STEP: f64 = 1e-10;

/// A minimum.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub(crate) coordinates: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    pub(crate) jacobian: Mat<f64>,
    pub(crate) iterations: usize,
}

/// Minimises the sum of squares of `residuals` from `start`, or until it is at most `exact`. Residuals that cannot be computed reject a step. `jacobian` takes
/// differences of a width that is at most `difference`: narrower than the last step, since residuals have kinks where a sample is
/// about to touch or to leave.
pub(crate) fn minimise(
    start: Vec<f64>,
    exact: f64,
    difference: f64,
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>>,
    jacobian: impl Fn(&[f64], f64) -> Result<Mat<f64>>,
) -> Result<Minimum> {
    let mut x = start;
    let mut r = residuals(&x)?;
    let mut sum = square(&r);
    let (mut damping, mut width, mut idle) = (1e-3, difference, 0);
    for iteration in 0..MAX_ITERATIONS {
        let slopes = jacobian(&x, width)?;
        let right = slopes.transpose() * Col::from_fn(r.len(), |k| -r[k]);
        let gram = slopes.transpose() * &slopes;
        // the scale of each coordinate; coordinates that move nothing stay
        let scale: Vec<f64> =
            (0..x.len()).map(|j| gram[(j, j)].sqrt()).map(|s| if s > 0.0 { s } else { 1.0 }).collect();
        let done = loop {
            let step = damped_step(&gram, &right, &scale, damping);
            let promised: f64 = (0..x.len()).map(|j| step[j] * right[j]).sum();
            let longest = step.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            let shorter = (LONGEST_STEP / longest).min(1.0);
            let moved: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + s * shorter).collect();
            let trial = residuals(&moved).ok().map(|r| (square(&r), r)).filter(|(sum, _)| sum.is_finite());
            match trial {
                Some((reduced, residuals)) if reduced < sum => {
                    idle = if sum - reduced < IDLE * sum { idle + 1 } else { 0 };
                    let enough = promised <= ENOUGH * sum && damping < 1.0 || idle == MAX_IDLE;
                    (x, r, sum) = (moved, residuals, reduced);
                    damping = (damping * 0.1).max(LEAST_DAMPING);
                    width = (0.1 * longest).clamp(LEAST_DIFFERENCE, difference);
                    break enough;
                }
                _ if longest < SHORTEST_STEP || promised <= ENOUGH * sum && damping < 1.0 => break true,
                _ => damping = (damping * 10.0).max(1e-9),
            }
        };
        if done || sum <= exact {
            let jacobian = jacobian(&x, difference)?;
            return Ok(Minimum { coordinates: x, residuals: r, jacobian, iterations: iteration + 1 });
        }
    }
    let reason =
        "the sum of squares still falls: give start values, fix parameters, or take a model with fewer of them";
    Err(Error::NotConverged { iterations: MAX_ITERATIONS, reason })
}

/// Solves (JᵀJ + λ D²) s = right, with D the norms of the columns.
fn damped_step(gram: &Mat<f64>, right: &Col<f64>, scale: &[f64], damping: f64) -> Vec<f64> {
    let count = scale.len();
    let scaled =
        Mat::from_fn(count, count, |i, j| gram[(i, j)] / (scale[i] * scale[j]) + if i == j { damping } else { 0.0 });
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
            0.0,
            1e-5,
            |x| Ok(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]),
            |x, _| Ok(Mat::from_fn(2, 2, |i, j| [[-20.0 * x[0], 10.0], [-1.0, 0.0]][i][j])),
        );
        let x = found.unwrap().coordinates;
        assert!((x[0] - 1.0).abs() < 1e-10 && (x[1] - 1.0).abs() < 1e-10, "{x:?}");
    }
}
