//! Optimises strengths and times of a series together, by least squares of the misfit.

use faer::{Col, Mat};

use super::basis::{FittedSeries, Sample};
use super::nnls::solve;

/// Greatest change of the logarithm of a parameter in one iteration.
const MAX_CHANGE: f64 = 1.5;

/// The ends of a series that may change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Free {
    pub(crate) constant: bool,
    pub(crate) slope: bool,
}

/// Levenberg–Marquardt in the logarithms of strengths and times, which keeps both positive. Ends after
/// `iterations`, when `done`, or when the squares no longer decrease.
pub(crate) fn polish(
    start: &FittedSeries,
    samples: &[Sample],
    free: Free,
    iterations: usize,
    done: &dyn Fn(&FittedSeries) -> bool,
) -> FittedSeries {
    let mut best = start.clone();
    let mut squares = best.squares(samples);
    let mut damping = 1e-3;
    for _ in 0..iterations {
        if squares == 0.0 || done(&best) {
            break;
        }
        let (jacobian, misfits) = linearise(&best, samples, free);
        let mut improved = None;
        for _ in 0..6 {
            let trial = moved(&best, free, &damped_step(&jacobian, &misfits, damping));
            let trial_squares = trial.squares(samples);
            if trial_squares < squares {
                improved = Some((trial, trial_squares));
                damping *= 0.1;
                break;
            }
            damping *= 10.0;
        }
        let Some((trial, trial_squares)) = improved else { break };
        let gain = 1.0 - trial_squares / squares;
        (best, squares) = (trial, trial_squares);
        if gain < 1e-3 {
            break;
        }
    }
    best.terms.sort_by(|a, b| a.1.total_cmp(&b.1));
    best
}

/// Derivatives of the misfits by ln constant, ln slope, and each (ln strength, ln time), and the misfits.
fn linearise(series: &FittedSeries, samples: &[Sample], free: Free) -> (Mat<f64>, Col<f64>) {
    let ends = usize::from(moves(free.constant, series.constant)) + usize::from(moves(free.slope, series.slope));
    let mut jacobian = Mat::zeros(samples.len(), ends + 2 * series.terms.len());
    let mut misfits = Col::zeros(samples.len());
    for (i, sample) in samples.iter().enumerate() {
        let (function, root) = (sample.function, sample.weight.sqrt());
        let weight = root / sample.value;
        misfits[i] = root * series.misfit(sample);
        let mut column = 0;
        for (is_free, strength, value) in [
            (free.constant, series.constant, function.constant()),
            (free.slope, series.slope, function.slope(sample.x)),
        ] {
            if moves(is_free, strength) {
                jacobian[(i, column)] = strength * value * weight;
                column += 1;
            }
        }
        for &(strength, lambda) in &series.terms {
            let (value, derivative) = function.term(sample.x, lambda);
            jacobian[(i, column)] = strength * value * weight;
            jacobian[(i, column + 1)] = strength * derivative * weight;
            column += 2;
        }
    }
    (jacobian, misfits)
}

fn moves(free: bool, strength: f64) -> bool {
    free && strength > 0.0
}

/// min |J δ + r|² + damping |δ|².
fn damped_step(jacobian: &Mat<f64>, misfits: &Col<f64>, damping: f64) -> Vec<f64> {
    let (m, n) = (jacobian.nrows(), jacobian.ncols());
    let scale = damping.sqrt() * (jacobian.norm_l2() / (n as f64).sqrt()).max(1e-300);
    let matrix = Mat::from_fn(m + n, n, |i, j| match i {
        _ if i < m => jacobian[(i, j)],
        _ if i - m == j => scale,
        _ => 0.0,
    });
    let right = Col::from_fn(m + n, |i| if i < m { -misfits[i] } else { 0.0 });
    solve(&matrix, &right)
}

fn moved(series: &FittedSeries, free: Free, step: &[f64]) -> FittedSeries {
    let mut step = step.iter().map(|d| d.clamp(-MAX_CHANGE, MAX_CHANGE).exp());
    let mut next = || step.next().unwrap_or(1.0);
    let mut moved = series.clone();
    if moves(free.constant, series.constant) {
        moved.constant *= next();
    }
    if moves(free.slope, series.slope) {
        moved.slope *= next();
    }
    for (strength, lambda) in &mut moved.terms {
        *strength *= next();
        *lambda *= next();
    }
    moved
}
