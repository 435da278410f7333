//! Generalised minimal residuals (Y. Saad & M. H. Schultz, SIAM J. Sci. Stat. Comput. 7, 1986), preconditioned from the right.

/// Greatest number of directions.
pub(super) const MOST: usize = 60;
/// A direction that is shorter than this part of the first residual is rounding.
const LEAST: f64 = 1e-14;

/// Adds to `x` what brings the residual of a linear equation from `residual` down to `goal`; returns the residual left. `apply` maps a direction to the
/// preconditioned direction and its image, or ends the iteration.
pub(super) fn gmres(
    x: &mut [f64],
    residual: &[f64],
    goal: f64,
    mut apply: impl FnMut(&[f64]) -> Option<[Vec<f64>; 2]>,
) -> f64 {
    let first = norm(residual);
    if first <= goal || first == 0.0 {
        return first;
    }
    let mut basis = vec![residual.iter().map(|v| v / first).collect::<Vec<_>>()];
    let mut directions = Vec::new();
    // columns of the triangle to which rotations bring the Hessenberg matrix, and the turned right side
    let (mut triangle, mut rotations, mut right) = (Vec::<Vec<f64>>::new(), Vec::<[f64; 2]>::new(), vec![first]);
    for k in 0..MOST {
        let Some([direction, mut image]) = apply(&basis[k]) else { break };
        directions.push(direction);
        let mut column = vec![0.0; k + 2];
        // twice: rounding of the first round is left in the second
        for _ in 0..2 {
            for (own, along) in column.iter_mut().zip(&basis) {
                let part = dot(&image, along);
                *own += part;
                image.iter_mut().zip(along).for_each(|(a, b)| *a -= part * b);
            }
        }
        let length = norm(&image);
        column[k + 1] = length;
        for (j, &[cosine, sine]) in rotations.iter().enumerate() {
            let [a, b] = [column[j], column[j + 1]];
            (column[j], column[j + 1]) = (cosine * a + sine * b, cosine * b - sine * a);
        }
        let (a, b) = (column[k], column[k + 1]);
        let radius = a.hypot(b);
        if radius == 0.0 {
            directions.pop();
            break;
        }
        let [cosine, sine] = [a / radius, b / radius];
        column[k] = radius;
        column.truncate(k + 1);
        right.push(-sine * right[k]);
        right[k] *= cosine;
        rotations.push([cosine, sine]);
        triangle.push(column);
        if right[k + 1].abs() <= goal || length <= LEAST * first {
            break;
        }
        basis.push(image.iter().map(|v| v / length).collect());
    }
    let count = directions.len();
    let mut parts = right[..count].to_vec();
    for k in (0..count).rev() {
        parts[k] /= triangle[k][k];
        let (before, own) = parts.split_at_mut(k);
        before.iter_mut().zip(&triangle[k]).for_each(|(part, entry)| *part -= entry * own[0]);
    }
    for (part, direction) in parts.iter().zip(&directions) {
        x.iter_mut().zip(direction).for_each(|(x, d)| *x += part * d);
    }
    right[count].abs()
}

pub(super) fn norm(field: &[f64]) -> f64 {
    dot(field, field).sqrt()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
