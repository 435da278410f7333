//! Non-linear least squares by the method of Levenberg and Marquardt.

use faer::linalg::solvers::Solve;
use faer::{Col, Mat, Side};

use crate::error::{Error, Result};

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
/// Share of a step at which its curvature is found, and the greatest acceleration over a step that bends it.
const AHEAD: f64 = 0.1;
const MOST_BENT: f64 = 0.75;
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

/// Minimises the sum of squares of `residuals` from `start`, or until it is at most `exact`, or the linearised residuals promise less than the
/// fraction `enough` of it. Residuals that cannot be computed reject a
/// step. The damping follows the gain ratio (H. B. Nielsen, *Damping Parameter in Marquardt's Method*, 1999).
pub(crate) fn minimise(
    start: Vec<f64>,
    [exact, enough]: [f64; 2],
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>>,
    jacobian: impl Fn(&[f64]) -> Result<Mat<f64>>,
) -> Result<Minimum> {
    let mut x = start;
    let mut r = residuals(&x)?;
    let mut sum = square(&r);
    let (mut damping, mut growth) = (DAMPING[1], 2.0);
    for iterations in 1..=MAX_ITERATIONS {
        let slopes = jacobian(&x)?;
        let model = Linear::new(&slopes, &r);
        let moved = loop {
            if sum <= exact || model.promised(&model.step(0.0)) <= enough * sum {
                break None;
            }
            let mut step = model.step(damping);
            let promised = model.promised(&step);
            if let Ok(ahead) = residuals(&along(&x, &step, AHEAD)) {
                model.bend(&mut step, damping, &slopes, &r, &ahead);
            }
            let moved = along(&x, &step, 1.0);
            let trial = residuals(&moved).ok().map(|r| (square(&r), r)).filter(|(sum, _)| sum.is_finite());

            if let Some((reduced, residuals)) = trial.filter(|(reduced, _)| *reduced < sum) {
                let gain = (sum - reduced) / promised;
                // at a kink, shorter and shorter steps reduce the sum less and less
                let reduction = promised.max(sum - reduced);
                let is_enough = reduction <= sum * if damping > 1.0 { AT_KINK.max(enough) } else { enough };
                let is_last = is_enough || reduction <= SLOW * sum && iterations == MAX_ITERATIONS;
                damping = (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0)).max(DAMPING[0]);
                growth = 2.0;
                (x, r, sum) = (moved, residuals, reduced);
                break Some(is_last);
            }
            if promised <= enough * sum {
                break None;
            }
            (damping, growth) = (damping * growth, growth * 2.0);
        };
        if moved != Some(false) {
            let jacobian = if moved.is_some() { jacobian(&x)? } else { slopes };
            return Ok(Minimum { coordinates: x, residuals: r, jacobian, iterations });
        }
    }
    let reason =
        "the sum of squares still falls: give start values, fix parameters, or take a model with fewer of them";
    Err(Error::NotConverged { iterations: MAX_ITERATIONS, reason })
}

fn along(x: &[f64], step: &Col<f64>, share: f64) -> Vec<f64> {
    x.iter().enumerate().map(|(j, x)| x + share * step[j]).collect()
}

/// Linearised residuals: JᵀJ and −Jᵀr.
struct Linear {
    gram: Mat<f64>,
    right: Col<f64>,
}

impl Linear {
    fn new(slopes: &Mat<f64>, residuals: &[f64]) -> Linear {
        let mut gram = slopes.transpose() * slopes;
        for j in 0..gram.nrows() {
            // a coordinate that moves nothing stays
            gram[(j, j)] = if gram[(j, j)] > 0.0 { gram[(j, j)] } else { 1.0 };
        }
        Linear { gram, right: slopes.transpose() * Col::from_fn(residuals.len(), |k| -residuals[k]) }
    }

    /// Solves (JᵀJ + λ D²) s = −Jᵀr, with D the norms of the columns. Coordinates whose step would be too long are damped more.
    fn step(&self, damping: f64) -> Col<f64> {
        let count = self.right.nrows();
        let mut damping = vec![damping; count];
        for _ in 0..MAX_DAMPED {
            let step = self.solve(&damping, &self.right);
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

    /// Bends a step by half of the acceleration along it, so that it follows a curved valley (M. K. Transtrum & J. P. Sethna, 2012): the
    /// second derivative of the residuals is found from those a little `ahead`. A step whose acceleration is great is left.
    fn bend(&self, step: &mut Col<f64>, damping: f64, slopes: &Mat<f64>, residuals: &[f64], ahead: &[f64]) {
        let linear = slopes * &*step;
        let curvature =
            Col::from_fn(residuals.len(), |k| 2.0 / AHEAD * (linear[k] - (ahead[k] - residuals[k]) / AHEAD));
        let acceleration = self.solve(&vec![damping; step.nrows()], &(slopes.transpose() * curvature));
        let square = |of: &Col<f64>| (0..of.nrows()).map(|j| of[j] * of[j] * self.gram[(j, j)]).sum::<f64>();
        if square(&acceleration) <= MOST_BENT * MOST_BENT * square(step) {
            for j in 0..step.nrows() {
                step[j] += (0.5 * acceleration[j]).clamp(-LONGEST_STEP, LONGEST_STEP);
            }
        }
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
