//! Non-linear least squares by the method of Levenberg and Marquardt.

use faer::linalg::solvers::Solve;
use faer::{Col, Mat, Side};

use crate::error::{Error, Result};

/// Fraction of the sum of squares that no step is worth.
const NOTHING: f64 = 1e-12;
/// Iterations after which a search has failed.
const MAX_ITERATIONS: usize = 200;
/// A search ends where the sum of squares falls by less than this where steps are damped so much that the linearised residuals hold nowhere: at kinks, where samples are about to touch or to leave.
const AT_KINK: f64 = 1e-9;
/// A search that reduces the sum of squares by less than this fraction in its last iteration has not failed.
const SLOW: f64 = 1e-6;
/// Longest step of a coordinate: a factor of e² in a modulus.
const LONGEST_STEP: f64 = 2.0;
/// Rounds in which long steps are damped.
const MAX_DAMPED: usize = 100;
/// Most trials of a step, the share of the promised reduction that needs no further one, and the longest correction over the step.
const TRIALS: usize = 4;
const GOOD: f64 = 0.8;
const MOST_BENT: f64 = 0.75;
/// Least factor of the damping after a step.
const MOST_FALL: f64 = 0.1;
/// Least damping, and damping at the start.
const DAMPING: [f64; 2] = [1e-14, 1e-3];

/// A minimum.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub(crate) coordinates: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    pub(crate) jacobian: Mat<f64>,
    pub(crate) iterations: usize,
}

/// Minimises the sum of squares of `residuals` from `start`, until it is at most `exact`, or until a step reduces it by less than the fraction
/// `enough`: what such a step leaves is far less, but for parameters that go to a limit. Residuals that cannot be computed reject a step. The damping follows the gain ratio (H. B. Nielsen, *Damping Parameter
/// in Marquardt's Method*, 1999).
pub(crate) fn minimise(
    start: Vec<f64>,
    [exact, enough]: [f64; 2],
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>>,
    jacobian: impl Fn(&[f64]) -> Result<Mat<f64>>,
) -> Result<Minimum> {
    let mut x = start;
    let mut r = residuals(&x)?;
    let (mut damping, mut growth) = (DAMPING[1], 2.0);
    for iterations in 1..=MAX_ITERATIONS {
        let (model, sum) = (Linear::new(jacobian(&x)?, &r), square(&r));
        let (is_last, has_moved) = loop {
            let step = model.step(damping);
            let (promised, least) = (model.promised(&step), NOTHING * sum);
            if sum <= exact || promised <= least && model.promised(&model.step(0.0)) <= least {
                break (true, false);
            }
            if let Some((moved, there)) =
                follow(&x, &model, &step, damping, &residuals).filter(|(_, r)| square(r) < sum)
            {
                let reduced = sum - square(&there);
                // at a kink, shorter and shorter steps reduce the sum less and less
                let reduction = promised.max(reduced);
                let is_enough = reduction <= sum * if damping > 1.0 { AT_KINK.max(enough) } else { enough };
                let gain = reduced / promised;
                damping = (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(MOST_FALL)).max(DAMPING[0]);
                growth = 2.0;
                (x, r) = (moved, there);
                break (is_enough || reduction <= SLOW * sum && iterations == MAX_ITERATIONS, true);
            }
            if promised <= least {
                break (true, false);
            }
            (damping, growth) = (damping * growth, growth * 2.0);
        };
        if is_last {
            let slopes = if has_moved { jacobian(&x)? } else { model.slopes };
            return Ok(Minimum { jacobian: slopes, coordinates: x, residuals: r, iterations });
        }
    }
    let reason =
        "the sum of squares still falls: give start values, fix parameters, or take a model with fewer of them";
    Err(Error::NotConverged { iterations: MAX_ITERATIONS, reason })
}

/// Coordinates and residuals at the end of a step that is bent to follow a curved valley: where the residuals are those of the linearised problem at
/// the end of the straight step, up to what the damped problem cannot remove. None where the residuals cannot be computed.
fn follow(
    x: &[f64],
    model: &Linear,
    step: &Col<f64>,
    damping: f64,
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>>,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let (before, mut least) = (model.residuals.squared_norm_l2(), f64::INFINITY);
    let (mut bent, mut best) = (step.clone(), None);
    for _ in 0..TRIALS {
        let moved: Vec<f64> = x.iter().enumerate().map(|(j, x)| x + bent[j]).collect();
        let Ok(there) = residuals(&moved) else { break };
        let (sum, correction) = (square(&there), model.correction(&bent, damping, &there));
        if sum.is_nan() || sum >= least {
            break;
        }
        (least, best) = (sum, Some((moved, there)));
        let is_good = before - sum >= GOOD * model.promised(step);
        if is_good || model.size(&correction).is_nan() || model.size(&correction) > MOST_BENT * model.size(step) {
            break;
        }
        bent = step + correction;
    }
    best
}

/// Linearised residuals r + J s, with JᵀJ and −Jᵀr.
struct Linear {
    slopes: Mat<f64>,
    residuals: Col<f64>,
    gram: Mat<f64>,
    right: Col<f64>,
}

impl Linear {
    fn new(slopes: Mat<f64>, residuals: &[f64]) -> Linear {
        let residuals = Col::from_fn(residuals.len(), |k| residuals[k]);
        let mut gram = slopes.transpose() * &slopes;
        for j in 0..gram.nrows() {
            // a coordinate that moves nothing stays
            gram[(j, j)] = if gram[(j, j)] > 0.0 { gram[(j, j)] } else { 1.0 };
        }
        let right = -(slopes.transpose() * &residuals);
        Linear { slopes, residuals, gram, right }
    }

    /// Solves (JᵀJ + λ D²) s = −Jᵀr, with D the norms of the columns. Coordinates whose step would be too long are damped more.
    fn step(&self, damping: f64) -> Col<f64> {
        let count = self.right.nrows();
        let mut damping = vec![damping; count];
        for _ in 0..MAX_DAMPED {
            let step = self.solve(&damping, &self.right);
            if step.norm_l2().is_nan() {
                damping.iter_mut().for_each(|damping| *damping = 10.0 * damping.max(DAMPING[0]));
                continue;
            }
            let far: Vec<f64> = (0..count).map(|j| (step[j].abs() / LONGEST_STEP).min(100.0)).collect();
            if far.iter().all(|far| *far <= 1.0) {
                return step;
            }
            for (damping, far) in damping.iter_mut().zip(far).filter(|(_, far)| *far > 1.0) {
                *damping = (2.0 * far * *damping).max(DAMPING[1]);
            }
        }
        Col::zeros(count)
    }

    /// What is added to a straight step to have its linearised residuals where they are `there` after a bent one.
    fn correction(&self, bent: &Col<f64>, damping: f64, there: &[f64]) -> Col<f64> {
        let linear = &self.residuals + &self.slopes * bent;
        let difference = Col::from_fn(there.len(), |k| linear[k] - there[k]);
        self.solve(&vec![damping; bent.nrows()], &(self.slopes.transpose() * difference))
    }

    /// |D s|.
    fn size(&self, step: &Col<f64>) -> f64 {
        (0..step.nrows()).map(|j| step[j] * step[j] * self.gram[(j, j)]).sum::<f64>().sqrt()
    }

    /// The damped step of a right side; not a number where rounding hides it.
    fn solve(&self, damping: &[f64], right: &Col<f64>) -> Col<f64> {
        let damped = |j: usize| 1.0 + damping[j].max(DAMPING[0]);
        let entry = |i: usize, j: usize| self.gram[(i, j)] * if i == j { damped(j) } else { 1.0 };
        let matrix = Mat::from_fn(right.nrows(), right.nrows(), entry);
        matrix.llt(Side::Lower).map_or(Col::full(right.nrows(), f64::NAN), |factor| factor.solve(right))
    }

    /// The reduction of the sum of squares by a step.
    fn promised(&self, step: &Col<f64>) -> f64 {
        step.transpose() * (faer::Scale(2.0) * &self.right - &self.gram * step)
    }
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
            [0.0, 1e-10],
            |x| Ok(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]),
            |x| Ok(Mat::from_fn(2, 2, |i, j| [[-20.0 * x[0], 10.0], [-1.0, 0.0]][i][j])),
        );
        let x = found.unwrap().coordinates;
        assert!((x[0] - 1.0).abs() < 1e-10 && (x[1] - 1.0).abs() < 1e-10, "{x:?}");
    }
}
