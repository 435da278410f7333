//! Least squares against faer.

use faer::linalg::solvers::SolveLstsqCore;
use faer::{Conj, Mat};

use super::*;

/// A uniform random number in −1 … 1.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// The x of faer's factorisation with pivots.
fn by_faer(a: &Matrix, b: &[f64]) -> Vec<f64> {
    let matrix = Mat::from_fn(a.rows(), a.columns(), |i, j| a[(i, j)]);
    let mut right = Mat::from_fn(b.len(), 1, |i, _| b[i]);
    matrix.col_piv_qr().solve_lstsq_in_place_with_conj(Conj::No, right.as_mut());
    (0..a.columns()).map(|j| right[(j, 0)]).collect()
}

/// Σ over rows of A x − b, and Aᵀ of it.
fn left(a: &Matrix, x: &[f64], b: &[f64]) -> (f64, f64) {
    let residual: Vec<f64> =
        (0..a.rows()).map(|i| b[i] - (0..a.columns()).map(|j| a[(i, j)] * x[j]).sum::<f64>()).collect();
    let slopes: Vec<f64> = (0..a.columns()).map(|j| product(a.column(j), &residual) / norm(a.column(j))).collect();
    (norm(&residual), norm(&slopes))
}

/// Random matrices, some of them of neighbouring exponentials with conditions to beyond 1/ε, in
/// units from 1e-150 to 1e150: the residual is that of faer, and orthogonal to the columns.
#[test]
fn least_squares_are_those_of_faer() {
    let mut state = 1;
    let mut compared = 0;
    for case in 0..400 {
        let columns = 1 + case % 23;
        let rows = columns + (case * 7) % 60;
        let unit = 10f64.powf(150.0 * random(&mut state));
        let near = 10f64.powf(1.0 + random(&mut state));
        let noise: Vec<f64> = (0..rows * columns).map(|_| random(&mut state)).collect();
        let of_series = |i: usize, j: usize| (-(i as f64 + 1.0) / near.powf(j as f64 / 3.0)).exp();
        let entry = |i: usize, j: usize| unit * if case % 2 == 0 { noise[i * columns + j] } else { of_series(i, j) };
        let a = Matrix::from_fn(rows, columns, entry);
        let b: Vec<f64> = (0..rows).map(|i| 1.0 + 0.1 * random(&mut state) * i as f64).collect();
        let (own, other) = (a.clone().least_squares(&b), by_faer(&a, &b));
        let ((residual, slope), (reference, _)) = (left(&a, &own, &b), left(&a, &other, &b));
        // units cancel
        let size = norm(&b) + a.norm() * norm(&own);
        assert!(residual <= reference * (1.0 + 1e-12) + 1e-13 * size, "{case}: {residual:e} {reference:e}");
        assert!(slope <= 1e-13 * size, "{case}: {slope:e} of {size:e}");
        if case % 2 == 0 && rows > columns + 5 {
            let off: Vec<f64> = own.iter().zip(&other).map(|(a, b)| a - b).collect();
            assert!(norm(&off) <= 1e-11 * norm(&other), "{case}: {own:?} {other:?}");
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn dependent_columns_get_nothing() {
    let mut state = 5;
    let noise: Vec<f64> = (0..40).map(|_| random(&mut state)).collect();
    // the third column is twice the first, the fourth is empty
    let a = Matrix::from_fn(10, 4, |i, j| [noise[i], noise[10 + i], 2.0 * noise[i], 0.0][j]);
    let b: Vec<f64> = (0..10).map(|i| 3.0 * noise[i] - noise[10 + i]).collect();
    let x = a.clone().least_squares(&b);
    assert!(left(&a, &x, &b).0 < 1e-14 && x[3] == 0.0 && (x[0] == 0.0) != (x[2] == 0.0), "{x:?}");
    assert!(Matrix::from_fn(3, 1, |_, _| f64::NAN).least_squares(&[1.0; 3])[0].is_nan());
    assert_eq!(Matrix::zeros(3, 0).least_squares(&[1.0; 3]), []);
}

#[test]
fn norms_neither_overflow_nor_vanish() {
    for (values, expected) in
        [([3e-200, 4e-200], 5e-200), ([3e200, 4e200], 5e200), ([0.0, 0.0], 0.0), ([3.0, -4.0], 5.0)]
    {
        assert!((norm(&values) - expected).abs() <= 1e-15 * expected, "{values:?}");
    }
    assert_eq!(norm(&[f64::INFINITY, 1.0]), f64::INFINITY);
    assert!(norm(&[f64::NAN, 1.0]).is_nan());
}
