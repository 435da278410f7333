//! Optimises strengths and times of a series together, by least squares of the misfit.

use super::{FittedSeries, Sample, Search, first_time};
use crate::dense::Matrix;

/// Maximum change of the logarithm of a parameter in one iteration.
const MAX_CHANGE: f64 = 1.5;

/// Levenberg–Marquardt in the logarithms of strengths and times, which keeps both positive. The strength of a term of
/// relaxation is its modulus at the first sample: the modulus at t = 0 changes by orders of magnitude with the time.
/// Ends after `iterations`, when `done`, or when the squares no longer decrease.
pub(in crate::rheology) fn polish(
    start: &FittedSeries,
    samples: &[Sample],
    search: &Search,
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
        let (jacobian, misfits) = linearise(&best, samples, search);
        let mut improved = None;
        for _ in 0..6 {
            let step = damped_step(&jacobian, &misfits, damping);
            let mut trial = moved(&best, search, &step, first_time(samples));
            trial.bound(samples, search.hidden);
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
pub(in crate::rheology) fn linearise(series: &FittedSeries, samples: &[Sample], search: &Search) -> (Matrix, Vec<f64>) {
    let [constant_moves, slope_moves] = moving_ends(series, search);
    let ends = usize::from(constant_moves) + usize::from(slope_moves);
    let mut jacobian = Matrix::zeros(samples.len(), ends + 2 * series.terms.len());
    let mut misfits = vec![0.0; samples.len()];
    let first = first_time(samples);
    for (i, sample) in samples.iter().enumerate() {
        let (function, root) = (sample.function, sample.weight.sqrt());
        let weight = root / sample.value;
        misfits[i] = root * series.misfit(sample);
        let mut column = 0;
        for (moves, strength, value) in [
            (constant_moves, series.constant, function.constant()),
            (slope_moves, series.slope, function.slope(sample.x)),
        ] {
            if moves {
                jacobian[(i, column)] = strength * value * weight;
                column += 1;
            }
        }
        for &(strength, lambda) in &series.terms {
            let (value, derivative) = function.term(sample.x, lambda);
            jacobian[(i, column)] = strength * value * weight;
            jacobian[(i, column + 1)] = strength * (derivative - first / lambda * value) * weight;
            column += 2;
        }
    }
    (jacobian, misfits)
}

/// Whether the constant and the slope may change: in the logarithm, zero stays zero.
fn moving_ends(series: &FittedSeries, search: &Search) -> [bool; 2] {
    [search.constant.is_none() && series.constant > 0.0, search.slope && series.slope > 0.0]
}

/// min |J δ + r|² + damping |δ|².
pub(in crate::rheology) fn damped_step(jacobian: &Matrix, misfits: &[f64], damping: f64) -> Vec<f64> {
    let (m, n) = (jacobian.rows(), jacobian.columns());
    let scale = damping.sqrt() * (jacobian.norm() / (n as f64).sqrt()).max(1e-300);
    let matrix = Matrix::from_fn(m + n, n, |i, j| match i {
        _ if i < m => jacobian[(i, j)],
        _ if i - m == j => scale,
        _ => 0.0,
    });
    let right: Vec<f64> = misfits.iter().map(|misfit| -misfit).chain(std::iter::repeat_n(0.0, n)).collect();
    matrix.least_squares(&right)
}

fn moved(series: &FittedSeries, search: &Search, step: &[f64], first: f64) -> FittedSeries {
    let mut step = step.iter().map(|d| d.clamp(-MAX_CHANGE, MAX_CHANGE).exp());
    let mut next = || step.next().unwrap_or(1.0);
    let mut moved = series.clone();
    let [constant_moves, slope_moves] = moving_ends(series, search);
    if constant_moves {
        moved.constant *= next();
    }
    if slope_moves {
        moved.slope *= next();
    }
    for (strength, lambda) in &mut moved.terms {
        let (grown, before) = (next(), *lambda);
        *lambda = before * next();
        *strength *= grown * (first / *lambda - first / before).exp();
    }
    moved
}
