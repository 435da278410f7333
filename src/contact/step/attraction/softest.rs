//! The direction along which an energy bends up least, over what its convex part does.
//!
//! The quotient of what softens along a direction, Σ w v², and of what the convex part stiffens, Σ v M v, is raised
//! by conjugate gradients (Bradbury & Fletcher, Numer. Math. 9, 1966).

use super::descent::DESCENT;
use crate::parallel::{Rows, for_each_band};

/// The convex part of an energy at a state.
pub(super) trait Convex: Sync {
    /// Whether the cell moves. Directions are 0 on others.
    fn is_free(&self, k: usize) -> bool;
    /// Writes M v.
    fn stiffen(&mut self, v: &[f64], image: &mut [f64]);
    /// Applies an inverse of M, or nearly, on the free cells.
    fn precondition(&mut self, field: &mut [f64]);
}

/// A direction v, and M v.
pub(super) type Direction<'a> = [&'a mut [f64]; 2];

/// Σ w v² and Σ v M v of a direction.
struct Quotient {
    softened: f64,
    convex: f64,
}

impl Quotient {
    fn curvature(&self) -> f64 {
        1.0 - self.softened / self.convex
    }

    fn is_positive(&self) -> bool {
        self.softened > 0.0 && self.convex > 0.0
    }

    /// Half the gradient of the quotient with respect to a direction, over Σ v M v.
    fn gradient(&self, w: &[f64], [v, image]: [&[f64]; 2], k: usize) -> f64 {
        w[k] * v[k] - self.softened / self.convex * image[k]
    }

    /// Moves v along p to the maximum quotient. p stays apart from v, since their mix would be lost in rounding.
    fn raise(&mut self, rows: &Rows, w: &[f64], [v, image]: &mut Direction<'_>, [p, image_of_p]: &mut Direction<'_>) {
        let (now, turn) = ([&**v, &**image], [&**p, &**image_of_p]);
        let [of_vp, of_pp, with_vp, with_pp] = rows.sum_terms(|k| {
            let softened = w[k] * turn[0][k];
            Some([softened * now[0][k], softened * turn[0][k], turn[0][k] * now[1][k], turn[0][k] * turn[1][k]])
        });
        let Quotient { softened, convex } = *self;
        let (a, b) = (of_pp * with_vp - of_vp * with_pp, of_pp * convex - softened * with_pp);
        let e = of_vp * convex - softened * with_vp;
        let root = (b * b - 4.0 * a * e).max(0.0).sqrt();
        let t = if b < 0.0 { 2.0 * e / (-b + root) } else { -(b + root) / (2.0 * a) };
        if !t.is_finite() {
            return;
        }
        self.softened += t * (2.0 * of_vp + t * of_pp);
        self.convex += t * (2.0 * with_vp + t * with_pp);
        let shared = (with_vp + t * with_pp) / self.convex;
        for_each_band([&mut **v, &mut **image, &mut **p, &mut **image_of_p], |_, [v, image, p, image_of_p]| {
            for (((v, image), p), image_of_p) in v.iter_mut().zip(image).zip(p).zip(image_of_p) {
                (*v, *image) = (*v + t * *p, *image + t * *image_of_p);
                (*p, *image_of_p) = (*p - shared * *v, *image_of_p - shared * *image);
            }
        });
    }

    /// Whether the direction is exact after so many turns, where `left` is the size of its gradient. Of a random
    /// direction of N cells, as K smooths it, a long wave is about the part N^-¼; one of quotient 0 gains e^(2√κ) a
    /// turn on one of curvature κ.
    fn is_found(&self, left: f64, turn: usize, cells: usize) -> bool {
        let curvature = self.curvature().abs();
        let grown = 4.0 * curvature.sqrt() * turn as f64 >= 0.5 * (cells as f64).ln() + DESCENT.grown;
        // of a direction that is exact rounding leaves something
        left <= 1e-6 || grown && left <= DESCENT.precise * curvature
    }
}

/// Looks for the softest direction, with the softening `w` of each cell, from the one that v holds: writes it to v with its image,
/// and returns its curvature, the energy's over the one of its convex part. `None` where nothing softens. The `turn`
/// and the `gradient` are where it works.
pub(super) fn softest(
    convex: &mut impl Convex,
    rows: &Rows,
    w: &[f64],
    mut v: Direction<'_>,
    mut turn: Direction<'_>,
    gradient: &mut [f64],
) -> Option<f64> {
    let [d, image] = &mut v;
    convex.precondition(d);
    convex.stiffen(d, image);
    turn.iter_mut().for_each(|field| field.fill(0.0));
    let [softened, stiffened] = rows.sum_terms(|k| Some([w[k] * d[k] * d[k], d[k] * image[k]]));
    let (mut quotient, mut before) = (Quotient { softened, convex: stiffened }, 0.0);
    for count in 0..100 {
        quotient.raise(rows, w, &mut v, &mut turn);
        if !quotient.is_positive() || quotient.curvature() < DESCENT.negative {
            break;
        }
        let (now, last) = ([&*v[0], &*v[1]], [&*turn[0], &*turn[1]]);
        for_each_band([&mut *gradient], |first, [gradient]| {
            let cells = gradient.iter_mut().zip(first..);
            cells.for_each(|(g, k)| *g = if convex.is_free(k) { quotient.gradient(w, now, k) } else { 0.0 });
        });
        convex.precondition(gradient);
        // the next turn is conjugate to the last in the bend of the quotient
        let [steepest, of_last, of_next] = rows.sum_terms(|k| {
            let bend = quotient.gradient(w, last, k);
            Some([gradient[k] * quotient.gradient(w, now, k), last[0][k] * bend, gradient[k] * bend])
        });
        let square = (steepest / quotient.convex).max(0.0);
        if quotient.is_found(square.sqrt(), count, w.len()) {
            break;
        }
        let conjugate = if of_last < 0.0 { -of_next / of_last } else { 0.0 };
        let beta = if before > 0.0 { conjugate.clamp(0.0, square / before) } else { 0.0 };
        before = square;
        let [p, image] = &mut turn;
        p.iter_mut().zip(&*gradient).for_each(|(p, g)| *p = g + beta * *p);
        convex.stiffen(p, image);
    }
    quotient.is_positive().then(|| quotient.curvature())
}

// against faer, which `data` brings
#[cfg(all(test, feature = "data"))]
mod tests;
