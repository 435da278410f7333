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
    let first = residuals(&start)?;
    let mut at = Point { sum: square(&first), residuals: first, x: start };
    let (mut damping, mut growth) = (DAMPING[1], 2.0);
    for iterations in 1..=MAX_ITERATIONS {
        let model = Linear::new(jacobian(&at.x)?, &at.residuals);
        loop {
            let step = model.step(damping);
            let (promised, least) = (model.promised(&step), NOTHING * at.sum);
            if at.sum <= exact || promised <= least && model.promised(&model.step(0.0)) <= least {
                return Ok(at.minimum(model.slopes, iterations));
            }
            if let Some(trial) = follow(&at, &model, &step, damping, &residuals).filter(|trial| trial.sum < at.sum) {
                let gain = (at.sum - trial.sum) / promised;
                // at a kink, shorter and shorter steps reduce the sum less and less
                let reduction = promised.max(at.sum - trial.sum);
                let is_enough = reduction <= at.sum * if damping > 1.0 { AT_KINK.max(enough) } else { enough };
                let is_last = is_enough || reduction <= SLOW * at.sum && iterations == MAX_ITERATIONS;
                damping = (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(MOST_FALL)).max(DAMPING[0]);
                growth = 2.0;
                at = trial;
                if is_last {
                    let slopes = jacobian(&at.x)?;
                    return Ok(at.minimum(slopes, iterations));
                }
                break;
            }
            if promised <= least {
                return Ok(at.minimum(model.slopes, iterations));
            }
            (damping, growth) = (damping * growth, growth * 2.0);
        }
    }
    let reason =
        "the sum of squares still falls: give start values, fix parameters, or take a model with fewer of them";
    Err(Error::NotConverged { iterations: MAX_ITERATIONS, reason })
}

/// The end of a step that is bent to follow a curved valley: where the residuals are those of the linearised problem at the end of the straight step,
/// up to what the damped problem cannot remove. None where the residuals cannot be computed.
fn follow(
    at: &Point,
    model: &Linear,
    step: &Col<f64>,
    damping: f64,
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>>,
) -> Option<Point> {
    let (mut bent, mut best) = (step.clone(), None::<Point>);
    for _ in 0..TRIALS {
        let x: Vec<f64> = at.x.iter().enumerate().map(|(j, x)| x + bent[j]).collect();
        let Ok(there) = residuals(&x) else { break };
        let (sum, curvature) = (square(&there), model.curvature(&bent, &there));
        if !(sum < best.as_ref().map_or(f64::INFINITY, |best| best.sum)) {
            break;
        }
        best = Some(Point { x, residuals: there, sum });
        let correction = model.solve(&vec![damping; bent.nrows()], &curvature);
        let is_good = at.sum - sum >= GOOD * model.promised(step);
        if is_good || !(model.size(&correction) <= MOST_BENT * model.size(step)) {
            break;
        }
        bent = step + correction;
    }
    best
}

/// Coordinates with their residuals and the sum of squares.
struct Point {
    x: Vec<f64>,
    residuals: Vec<f64>,
    sum: f64,
}

impl Point {
    fn minimum(self, jacobian: Mat<f64>, iterations: usize) -> Minimum {
        Minimum { coordinates: self.x, residuals: self.residuals, jacobian, iterations }
    }
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

    /// Jᵀ times the difference of the linearised residuals after a step from those that are `there`.
    fn curvature(&self, step: &Col<f64>, there: &[f64]) -> Col<f64> {
        let linear = &self.residuals + &self.slopes * step;
        self.slopes.transpose() * Col::from_fn(there.len(), |k| linear[k] - there[k])
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
