//! Minimal residuals over Krylov spaces, preconditioned from the right, by orthonormal images (simpler GMRES: H. F.
//! Walker & L. Zhou, Numer. Linear Algebra Appl. 1, 1994). The next direction is the residual where it has shrunk,
//! else the last image (P. Jiránek & M. Rozložník, ibid. 17, 2010).

/// Maximum number of directions.
pub(super) const MOST: usize = 60;
/// An image of which the others leave less than this part is rounding.
const LEAST: f64 = 1e-14;
/// A residual has shrunk to this part of the one before.
const SHRUNK: f64 = 0.9;

/// Adds to `x` what brings the residual of a linear equation from `residual` down to `goal`. `apply` maps a direction
/// to the preconditioned direction and its image, or ends the iteration.
pub(super) fn gmres(
    x: &mut [f64],
    mut residual: Vec<f64>,
    goal: f64,
    mut apply: impl FnMut(&[f64]) -> Option<[Vec<f64>; 2]>,
) {
    let (mut left, mut next) = (norm(&residual), residual.clone());
    let mut known: Vec<[Vec<f64>; 2]> = Vec::new();
    while left > goal && known.len() < MOST {
        let Some([mut direction, mut image]) = apply(&next) else { return };
        let whole = norm(&image);
        for [other, of_other] in &known {
            let part = dot(&image, of_other);
            add(&mut image, -part, of_other);
            add(&mut direction, -part, other);
        }
        let length = norm(&image);
        if length <= LEAST * whole {
            return;
        }
        [&mut direction, &mut image].into_iter().flatten().for_each(|value| *value /= length);
        let (part, before) = (dot(&residual, &image), left);
        add(x, part, &direction);
        add(&mut residual, -part, &image);
        left = norm(&residual);
        next.clone_from(if left < SHRUNK * before { &residual } else { &image });
        known.push([direction, image]);
    }
}

fn add(field: &mut [f64], part: f64, other: &[f64]) {
    field.iter_mut().zip(other).for_each(|(own, other)| *own += part * other);
}

pub(super) fn norm(field: &[f64]) -> f64 {
    dot(field, field).sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
