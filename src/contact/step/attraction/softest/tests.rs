//! The softest direction against faer.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};

use super::*;
use crate::sum::scattered;

const CELLS: usize = 24;

/// M as a dense matrix, with its inverse, on cells of which some do not move.
struct Dense {
    stiffness: Mat<f64>,
    compliance: Mat<f64>,
    free: Vec<bool>,
}

fn apply(matrix: &Mat<f64>, field: &[f64]) -> Vec<f64> {
    (0..CELLS).map(|i| (0..CELLS).map(|j| matrix[(i, j)] * field[j]).sum()).collect()
}

impl Convex for Dense {
    fn is_free(&self, k: usize) -> bool {
        self.free[k]
    }

    fn stiffen(&mut self, v: &[f64], image: &mut [f64]) {
        image.copy_from_slice(&apply(&self.stiffness, v));
    }

    fn precondition(&mut self, field: &mut [f64]) {
        let smooth = apply(&self.compliance, field);
        (0..CELLS).for_each(|k| field[k] = if self.free[k] { smooth[k] } else { 0.0 });
    }
}

/// The maximum eigenvalue of W relative to M on the free cells: of √W M⁻¹ √W, with the rows and columns of M that
/// move.
fn greatest(dense: &Dense, w: &[f64]) -> f64 {
    let free: Vec<usize> = (0..CELLS).filter(|&k| dense.free[k]).collect();
    let stiffness = Mat::from_fn(free.len(), free.len(), |i, j| dense.stiffness[(free[i], free[j])]);
    let inverse = stiffness.partial_piv_lu().inverse();
    let root = |i: usize| w[free[i]].sqrt();
    let relative = Mat::from_fn(free.len(), free.len(), |i, j| root(i) * inverse[(i, j)] * root(j));
    let eigenvalues = relative.self_adjoint_eigenvalues(Side::Lower).unwrap();
    eigenvalues[free.len() - 1]
}

/// Random M and w, scaled to curvatures from 0.9 to −0.5, in a third of the cases with cells that do not move, on which
/// M⁻¹ is a poor preconditioner: what is found is the curvature of the direction that is written, and at least that of the
/// softest one. It is above it by no more than the search leaves, but that a stiff state may pass for a stiffer one where
/// the preconditioner is poor; what is clearly unstable is told.
#[test]
fn the_softest_direction_is_that_of_a_dense_solver() {
    let rows = Rows::all([1, CELLS]);
    for seed in 0..600 {
        let random = |k: usize| 2.0 * scattered(5000 * seed + k) - 1.0;
        let factor = Mat::from_fn(CELLS, CELLS, |i, j| random(CELLS * i + j) / (1 + j) as f64);
        let ground = if seed % 2 == 0 { 1e-1 } else { 1e-3 };
        let compliance = &factor * factor.transpose() + Mat::<f64>::identity(CELLS, CELLS) * ground;
        let stiffness = compliance.partial_piv_lu().inverse();
        let free = (0..CELLS).map(|k| seed % 3 > 0 || random(1000 + k) > -0.5).collect();
        let mut dense = Dense { stiffness, compliance, free };
        let mut w: Vec<f64> = (0..CELLS).map(|k| if dense.free[k] { random(2000 + k).max(0.0) } else { 0.0 }).collect();
        let exact = 0.9 - 1.4 * scattered(seed);
        let scale = (1.0 - exact) / greatest(&dense, &w);
        w.iter_mut().for_each(|w| *w *= scale);
        let mut v: Vec<f64> = (0..CELLS).map(|k| w[k] * random(3000 + k)).collect();
        let (mut image, mut gradient) = (vec![0.0; CELLS], vec![0.0; CELLS]);
        let (mut p, mut image_of_p) = (image.clone(), image.clone());
        let fields = ([&mut v[..], &mut image[..]], [&mut p[..], &mut image_of_p[..]]);
        let found = softest(&mut dense, &rows, &w, fields.0, fields.1, &mut gradient).unwrap();
        let softened: f64 = (0..CELLS).map(|k| w[k] * v[k] * v[k]).sum();
        let convex: f64 = apply(&dense.stiffness, &v).iter().zip(&v).map(|(image, v)| image * v).sum();
        assert!((found - 1.0 + softened / convex).abs() < 1e-9, "{seed}: {found}, of v {}", 1.0 - softened / convex);
        assert!(found > exact - 1e-9, "{seed}: {found} {exact}");
        let left = match exact {
            exact if exact < DESCENT.negative => DESCENT.negative,
            exact if exact < 0.2 || seed % 3 > 0 => exact + DESCENT.precise * exact.abs(),
            _ => 1.0,
        };
        assert!(found <= left, "{seed}: {found} {exact}");
    }
    let mut dense = Dense {
        stiffness: Mat::identity(CELLS, CELLS),
        compliance: Mat::identity(CELLS, CELLS),
        free: vec![true; CELLS],
    };
    let mut fields = [(); 5].map(|()| vec![1.0; CELLS]);
    let [v, image, p, image_of_p, gradient] = &mut fields;
    assert_eq!(softest(&mut dense, &rows, &[0.0; CELLS], [v, image], [p, image_of_p], gradient), None);
}
