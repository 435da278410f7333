//! Checks that an operator is positive definite.

use super::SpectralOperator;
use crate::dense::extreme_eigenvalues;
use crate::sum::sum_of_pairs;

/// Lanczos steps: the extreme eigenvalues converge first.
const STEPS: usize = 60;

/// The least and the maximum eigenvalue of a symmetric operator on fields of `cells` values, estimated from inside the
/// spectrum by the Lanczos method.
pub(super) fn least_eigenvalue(operator: &SpectralOperator, cells: usize) -> (f64, f64) {
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
        return (f64::NAN, f64::NAN);
    }
    extreme_eigenvalues(&diagonal, &beside)
}
