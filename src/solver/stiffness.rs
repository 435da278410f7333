//! The stiffness of a contact of given area.

use super::Preconditioner;
use crate::kernel::LocalKernel;

/// Residual of the displacement, relative to it.
pub(crate) const FLAT_PUNCH_TOLERANCE: f64 = 1e-7;

/// q with K q = `motion` on cells for which `touches` holds and q = 0 elsewhere: the pressure under a rigid motion of
/// a body of unit compliance, by preconditioned conjugate gradients. If they do not converge, it fails with their
/// number of iterations and the residual reached, relative to the motion as the `tolerance` is.
pub(crate) fn flat_punch(
    kernel: &LocalKernel,
    touches: impl Fn(usize) -> bool,
    motion: impl Fn(usize) -> f64,
    tolerance: f64,
) -> Result<Vec<f64>, (usize, f64)> {
    let (cells, rows) = (kernel.grid().len(), kernel.rows());
    let mut work = kernel.workspace();
    let mut preconditioner = Preconditioner::new(kernel, &mut work);
    let inside: Vec<f64> = (0..cells).map(|k| f64::from(u8::from(touches(k)))).collect();
    let restrict = |field: &mut [f64]| field.iter_mut().zip(&inside).for_each(|(value, inside)| *value *= inside);
    let mut residual: Vec<f64> = inside.iter().enumerate().map(|(k, inside)| inside * motion(k)).collect();
    let (mut q, mut image) = (vec![0.0; cells], vec![0.0; cells]);
    let (mut direction, mut last) = (vec![0.0; cells], 0.0);
    let limit = tolerance * tolerance * rows.sum_of_pairs(&residual, &residual, |a, b| a * b);
    let mut iterations = 0;
    loop {
        let square = rows.sum_of_pairs(&residual, &residual, |a, b| a * b);
        if square <= limit {
            return Ok(q);
        }
        let failure = (iterations, (square / limit).sqrt() * tolerance);
        iterations += 1;
        image.copy_from_slice(&residual);
        preconditioner.filter(&mut image, &mut work);
        restrict(&mut image);
        let energy = rows.sum_of_pairs(&residual, &image, |a, b| a * b);
        let beta = if last > 0.0 { energy / last } else { 0.0 };
        direction.iter_mut().zip(&image).for_each(|(d, z)| *d = z + beta * *d);
        kernel.apply(&direction, &mut image, &mut work);
        restrict(&mut image);
        let curvature = rows.sum_of_pairs(&direction, &image, |a, b| a * b);
        let length = energy / curvature;
        if !length.is_finite() || curvature <= 0.0 || iterations > 500 {
            return Err(failure);
        }
        q.iter_mut().zip(&direction).for_each(|(q, d)| *q += length * d);
        residual.iter_mut().zip(&image).for_each(|(r, kd)| *r -= length * kd);
        last = energy;
    }
}
