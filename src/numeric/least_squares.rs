//! Non-linear least squares by the method of Levenberg and Marquardt.

use faer::linalg::solvers::SolveLstsqCore;
use faer::{Col, Conj, Mat};

/// Fraction of the sum of squares that no step is worth.
const NOTHING: f64 = 1e-12;
/// Longest step of a coordinate: a factor of e² where it is a logarithm.
const LONGEST_STEP: f64 = 2.0;
/// Rounds in which long steps are damped.
const MAX_DAMPED: usize = 100;
/// Most trials of a step, the share of the promised reduction that needs no further one, and the longest correction
/// over the step.
const TRIALS: usize = 4;
const GOOD: f64 = 0.8;
const MOST_BENT: f64 = 0.75;
/// Least factor of the damping after a step.
const MOST_FALL: f64 = 0.1;
/// Least damping, and damping at the start.
const DAMPING: [f64; 2] = [1e-14, 1e-3];

/// Where a search for the least sum of squares is.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LeastSquares {
    /// The coordinates.
    pub coordinates: Vec<f64>,
    /// The residuals there.
    pub residuals: Vec<f64>,
    /// Steps done.
    pub steps: usize,
    /// Fractions of the sum of squares by which the last step reduced it, or was to reduce it if that is more, and
    /// the step before.
    pub reductions: [f64; 2],
}

impl LeastSquares {
    /// Where a search has ended before, after so many steps.
    pub fn at(coordinates: Vec<f64>, residuals: Vec<f64>, steps: usize) -> LeastSquares {
        LeastSquares { coordinates, residuals, steps, reductions: [1.0; 2] }
    }

    /// The sum of squares.
    pub fn sum(&self) -> f64 {
        square(&self.residuals)
    }
}

/// Reduces the sum of squares of `residuals` from `start` until it `is_enough`, or no step reduces it. `slopes` are
/// the derivatives of the residuals, a column of the same length for each coordinate. Where residuals cannot be
/// computed, a step is rejected. The damping follows the gain ratio (H. B. Nielsen, *Damping Parameter in Marquardt's
/// Method*, 1999); a step is at most 2 in each coordinate before it is bent to follow a curved valley, by at most as
/// much, so that logarithms are good ones.
///
/// ```
/// use viscocontact::numeric::least_squares;
///
/// // a curved valley
/// let residuals = |x: &[f64]| Ok::<_, ()>(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
/// let slopes = |x: &[f64]| Ok(vec![vec![-20.0 * x[0], -1.0], vec![10.0, 0.0]]);
/// let found = least_squares(vec![-1.2, 1.0], residuals, slopes, |found| found.sum() < 1e-20)?;
/// assert!(found.coordinates.iter().all(|x| (x - 1.0).abs() < 1e-9) && found.steps < 20);
/// # Ok::<(), ()>(())
/// ```
///
/// # Errors
/// Those of `residuals` at the start, and of `slopes`.
///
/// # Panics
/// If a column of `slopes` is shorter than the residuals.
pub fn least_squares<E>(
    start: Vec<f64>,
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    slopes: impl Fn(&[f64]) -> Result<Vec<Vec<f64>>, E>,
    is_enough: impl Fn(&LeastSquares) -> bool,
) -> Result<LeastSquares, E> {
    let (mut damping, mut growth) = (DAMPING[1], 2.0);
    let first = residuals(&start)?;
    let mut at = LeastSquares::at(start, first, 0);
    while !is_enough(&at) {
        let (model, sum) = (Linear::new(slopes(&at.coordinates)?, &at.residuals), at.sum());
        let (promised, coordinates, residuals) = loop {
            let step = model.step(damping);
            let promised = model.promised(&step);
            let next = follow(&at.coordinates, &model, &step, damping, &residuals);
            if let Some((moved, there)) = next.filter(|(_, there)| square(there) < sum) {
                break (promised, moved, there);
            }
            if promised.is_nan() || promised <= NOTHING * sum {
                return Ok(at);
            }
            (damping, growth) = (damping * growth, growth * 2.0);
        };
        let reduced = sum - square(&residuals);
        let gain = reduced / promised;
        damping = (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(MOST_FALL)).max(DAMPING[0]);
        growth = 2.0;
        let reductions = [promised.max(reduced) / sum, at.reductions[0]];
        at = LeastSquares { coordinates, residuals, steps: at.steps + 1, reductions };
    }
    Ok(at)
}

/// Coordinates and residuals at the end of a step that is bent to follow a curved valley: there the residuals equal
/// the residuals of the linearised problem at the end of the straight step, up to what the damped problem cannot
/// remove. None where the residuals cannot be computed.
fn follow<E>(
    x: &[f64],
    model: &Linear,
    step: &Col<f64>,
    damping: f64,
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
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
        let (size, longest) = (model.size(&correction), correction.norm_max());
        if is_good || size.is_nan() || size > MOST_BENT * model.size(step) || longest > LONGEST_STEP {
            break;
        }
        bent = step + correction;
    }
    best
}

/// Linearised residuals r + J s, with J = Q R.
struct Linear {
    slopes: Mat<f64>,
    residuals: Col<f64>,
    /// Norms of the columns of J.
    norms: Vec<f64>,
    q: Mat<f64>,
    r: Mat<f64>,
}

impl Linear {
    fn new(slopes: Vec<Vec<f64>>, residuals: &[f64]) -> Linear {
        let residuals = Col::from_fn(residuals.len(), |k| residuals[k]);
        let slopes = Mat::from_fn(residuals.nrows(), slopes.len(), |k, j| slopes[j][k]);
        // a coordinate that moves nothing stays
        let norm = |j: usize| Some(slopes.col(j).norm_l2()).filter(|norm| *norm > 0.0).unwrap_or(1.0);
        let (norms, qr) = ((0..slopes.ncols()).map(norm).collect(), slopes.qr());
        Linear { q: qr.compute_thin_Q(), r: qr.thin_R().to_owned(), slopes, residuals, norms }
    }

    /// The step of least |r + J s|² + λ |D s|², with D the norms of the columns. Coordinates whose step would be too
    /// long are damped more.
    fn step(&self, damping: f64) -> Col<f64> {
        let (count, right) = (self.norms.len(), -&self.residuals);
        let mut damping = vec![damping; count];
        for _ in 0..MAX_DAMPED {
            let step = self.solve(&damping, &right);
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
        self.solve(&vec![damping; bent.nrows()], &difference)
    }

    /// |D s|.
    fn size(&self, step: &Col<f64>) -> f64 {
        (0..step.nrows()).map(|j| (self.norms[j] * step[j]).powi(2)).sum::<f64>().sqrt()
    }

    /// The damped step whose J s is next to a column.
    fn solve(&self, damping: &[f64], right: &Col<f64>) -> Col<f64> {
        let (rows, count) = (self.r.nrows(), self.norms.len());
        let matrix = Mat::from_fn(rows + count, count, |i, j| match i.checked_sub(rows) {
            None => self.r[(i, j)],
            Some(k) if k == j => damping[j].max(DAMPING[0]).sqrt() * self.norms[j],
            Some(_) => 0.0,
        });
        let known = self.q.transpose() * right;
        let mut solved = Mat::from_fn(rows + count, 1, |i, _| if i < rows { known[i] } else { 0.0 });
        matrix.col_piv_qr().solve_lstsq_in_place_with_conj(Conj::No, solved.as_mut());
        Col::from_fn(count, |j| solved[(j, 0)])
    }

    /// The reduction of the sum of squares by a step.
    fn promised(&self, step: &Col<f64>) -> f64 {
        let moved = &self.slopes * step;
        -(moved.transpose() * (faer::Scale(2.0) * &self.residuals + &moved))
    }
}

fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}
