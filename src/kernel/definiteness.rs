//! Checks that an operator is positive definite.

use super::SpectralOperator;
use crate::sum::sum_of_pairs;

/// Lanczos steps: the extreme eigenvalues converge first.
const STEPS: usize = 60;
/// Eigenvalues that are negative by less than this part of a bound of all of them are rounding errors.
const ROUNDING: f64 = 1e-10;

/// Whether the Lanczos method, which sees the spectrum from inside, finds a symmetric operator on fields of `cells`
/// values positive definite but for rounding.
pub(super) fn is_positive(operator: &SpectralOperator, cells: usize) -> bool {
    let mut work = operator.workspace();
    let (mut previous, mut image) = (vec![0.0; cells], vec![0.0; cells]);
    // a field with a component of every wave
    let mut vector: Vec<f64> = (0..cells).map(|k| ((k * k) as f64 * 0.7 + 1.0).sin()).collect();
    let norm = sum_of_pairs(&vector, &vector, |a, b| a * b).sqrt();
    vector.iter_mut().for_each(|value| *value /= norm);
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    for _ in 0..STEPS.min(cells) {
        operator.apply(&vector, &mut image, &mut work);
        let alpha = sum_of_pairs(&vector, &image, |a, b| a * b);
        let beta = beside.last().copied().unwrap_or(0.0);
        for ((image, &own), &before) in image.iter_mut().zip(&vector).zip(&previous) {
            *image -= alpha * own + beta * before;
        }
        diagonal.push(alpha);
        let next = sum_of_pairs(&image, &image, |a, b| a * b).sqrt();
        if next <= f64::EPSILON * alpha.abs() {
            break;
        }
        beside.push(next);
        std::mem::swap(&mut previous, &mut vector);
        vector.iter_mut().zip(&image).for_each(|(vector, image)| *vector = image / next);
    }
    if !diagonal.iter().chain(&beside).all(|value| value.is_finite()) {
        return false;
    }
    // the off-diagonal entries before and after each row of the tridiagonal matrix that Lanczos leaves
    beside.truncate(diagonal.len() - 1);
    let before = |k: usize| if k == 0 { 0.0 } else { beside[k - 1] };
    let after = |k: usize| beside.get(k).copied().unwrap_or(0.0);
    // Gershgorin's bound of its eigenvalues
    let bounds = diagonal.iter().enumerate().map(|(k, own)| own.abs() + before(k) + after(k));
    let shift = ROUNDING * bounds.fold(0.0, f64::max);
    // shifted by rounding errors, it is positive definite if all pivots are positive (Sturm's sequence: Golub & Van
    // Loan, *Matrix Computations*, 2013, section 8.4.1)
    let mut pivot = 1.0;
    diagonal.iter().enumerate().all(|(k, own)| {
        pivot = own + shift - before(k) * (before(k) / pivot);
        pivot > 0.0
    })
}
