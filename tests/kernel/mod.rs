//! Does a pressure displace the surface as the theory says, on every kind of body?

mod coefficients;
mod layers;
mod love;
mod other_bodies;
mod refusals;

use std::f64::consts::TAU;
use viscocontact::{Grid, InfluenceKernel};

/// K p.
fn convolve(kernel: &InfluenceKernel, pressure: &[f64]) -> Vec<f64> {
    let mut displacement = vec![f64::NAN; pressure.len()];
    kernel.convolve(pressure, &mut displacement, &mut kernel.workspace().unwrap()).unwrap();
    displacement
}

/// Any pressure, the same every time.
fn noise(cells: usize) -> Vec<f64> {
    (0..cells).map(|k| ((k * k) as f64 * 0.37 + 1.0).sin()).collect()
}

fn values(grid: &Grid, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let n2 = grid.cells()[1];
    (0..grid.len()).map(|k| grid.center(k / n2, k % n2)).map(|[x1, x2]| f(x1, x2)).collect()
}

/// K p of a wave of the period is p times the compliance of its wave number; an infinite one leaves the mean where it is.
fn assert_answers_waves(kernel: &InfluenceKernel, compliance: impl Fn(f64) -> f64) {
    let ([n1, n2], [l1, l2]) = (kernel.grid().cells(), kernel.grid().lengths());
    assert_eq!(kernel.periodic_axes(), [true; 2]);
    for [m1, m2] in [[1, 0], [0, 1], [3, 2], [5, 7], [0, 0]] {
        if m1 > 0 && 2 * m1 >= n1 || m2 > 0 && 2 * m2 >= n2 {
            continue;
        }
        let q = [TAU * m1 as f64 / l1, TAU * m2 as f64 / l2];
        let wave = values(kernel.grid(), |x1, x2| (q[0] * x1 + q[1] * x2 + 0.3).cos());
        let factor = Some(compliance(q[0].hypot(q[1]))).filter(|factor| factor.is_finite()).unwrap_or(0.0);
        let found = convolve(kernel, &wave);
        let is_answer = found.iter().zip(&wave).all(|(v, p)| (v - factor * p).abs() < 1e-13);
        assert!(is_answer, "{kernel}, {n1} × {n2} cells: {m1} {m2}");
    }
}
