//! Gradient, direction and length of an iteration in the gap.

use super::descent::Balance;
use super::{AttractedStep, Passes};
use crate::contact::step::request::Trial;
use crate::contact::window::Window;
use crate::parallel::for_each_band;

/// Least curvature of E along a direction, over the curvature of its convex part.
const LEAST_CURVATURE: f64 = 1e-3;
/// Where the greatest |r| is a smaller part of the greatest traction, a step of negative curvature leads to the first minimum; else it has the
/// length of so many steps of the convex part.
const NEAR: f64 = 0.1;
const LONGEST: f64 = 4.0;
/// What a line search leaves of the slope, and how often it tries.
const SLOPE_LEFT: f64 = 0.1;
const TRIES: usize = 10;
/// A direction descends by this part of the steepest one, or the search begins anew.
const LEAST_DESCENT: f64 = 1e-3;
/// Curvature is measured by a change of the gap by this part of the range.
const DIFFERENCE: f64 = 1e-4;

/// The gradient of E on the cells that may move.
#[derive(Clone, Copy, Default)]
pub(super) struct Gradient {
    /// λ.
    pub(super) multiplier: f64,
    /// The greatest |r|, over the greatest traction.
    pub(super) greatest: f64,
    /// Σ s, and the number of cells at the wall.
    pub(super) attraction: f64,
    pub(super) at_wall: f64,
}

impl AttractedStep<'_> {
    /// Writes r to the pressure.
    pub(super) fn gradient(&self, balance: Balance, window: &Window, trial: &mut Trial) -> Gradient {
        let (law, gap, rows) = (self.law, &trial.gap, window.kernel.rows());
        let Trial { solution, .. } = trial;
        let (x, q, r) = (&solution.potential, &solution.attraction, &mut solution.pressure);
        let traction = |h: f64| if h.is_finite() { law.traction(h.max(0.0)) } else { 0.0 };
        for_each_band([&mut *r], |first, [r]| {
            r.iter_mut().zip(first..).for_each(|(r, k)| *r = q[k] + traction(gap[k] + x[k]));
        });
        let is_open = |k: usize| gap[k] + x[k] > 0.0;
        let r = &*r;
        let mut multiplier = 0.0;
        if balance.held {
            // cells at the wall that open join the mean
            let mut joins = f64::NEG_INFINITY;
            for _ in 0..TRIES {
                let [sum, count] = rows.sum_terms(|k| (is_open(k) || r[k] < joins).then_some([r[k], 1.0]));
                multiplier = sum / count.max(1.0);
                if std::mem::replace(&mut joins, multiplier) == multiplier {
                    break;
                }
            }
        }
        let [attraction, at_wall] = rows.sum_terms(|k| Some([r[k] - q[k], if is_open(k) { 0.0 } else { 1.0 }]));
        let r = &mut solution.pressure;
        let mut most = 0.0_f64;
        for (k, r) in r.iter_mut().enumerate() {
            *r -= multiplier;
            if !is_open(k) && *r >= 0.0 {
                *r = 0.0;
            }
            most = if r.is_nan() { f64::NAN } else { most.max(r.abs()) };
        }
        Gradient { multiplier, greatest: most / law.traction(0.0), attraction, at_wall }
    }

    /// Writes the next direction; returns y·r of the steepest one, y = K r.
    pub(super) fn turn(
        &self,
        balance: Balance,
        own: &mut Passes,
        window: &mut Window,
        trial: &Trial,
        before: f64,
        has_last: bool,
    ) -> f64 {
        let Window { kernel, work, .. } = window;
        let (rows, gap, x, r) = (kernel.rows(), &trial.gap, &trial.solution.potential, &trial.solution.pressure);
        let Passes { last: [direction, last_r], far: steepest_y, .. } = own;
        kernel.apply(r, steepest_y, work);
        let is_free = |k: usize| gap[k] + x[k] > 0.0 || r[k] < 0.0;
        let c = balance.compliance;
        let mean = (balance.soft - c * balance.inverse[1]) * rows.sum(r) / r.len() as f64;
        steepest_y.iter_mut().for_each(|y| *y = c * *y + mean);
        let y = &*steepest_y;
        let [sum, free] = rows.sum_terms(|k| is_free(k).then_some([y[k], 1.0]));
        let level = if balance.held { sum / f64::max(free, 1.0) } else { 0.0 };
        let [steepest, overlap] =
            rows.sum_terms(|k| is_free(k).then(|| [(y[k] - level) * r[k], (y[k] - level) * last_r[k]]));
        let beta = if has_last && before > 0.0 { f64::max((steepest - overlap) / before, 0.0) } else { 0.0 };
        let old = &*direction;
        let [along] = rows.sum_terms(|k| is_free(k).then(|| [r[k] * (beta * old[k] - (y[k] - level))]));
        let beta = if beta > 0.0 && along < -LEAST_DESCENT * steepest { beta } else { 0.0 };
        for_each_band([&mut *direction], |first, [direction]| {
            for (d, k) in direction.iter_mut().zip(first..) {
                let turned = if beta > 0.0 { beta * *d } else { 0.0 } - (y[k] - level);
                *d = if is_free(k) && (gap[k] + x[k] > 0.0 || turned > 0.0) { turned } else { 0.0 };
            }
        });
        if balance.held {
            // cells of the wall that open do so at the cost of the open ones: a shift of all cells would lift pressed ones
            let turned = &*direction;
            let [sum, open] = rows.sum_terms(|k| Some([turned[k], if gap[k] + x[k] > 0.0 { 1.0 } else { 0.0 }]));
            let level = sum / f64::max(open, 1.0);
            direction
                .iter_mut()
                .zip(gap.iter().zip(x))
                .filter(|(_, (z, x))| *z + *x > 0.0)
                .for_each(|(d, _)| *d -= level);
        }
        steepest
    }

    /// The length of the step along the direction, and its curvature over the curvature of the convex part.
    pub(super) fn length(&self, gradient: Gradient, own: &Passes, window: &Window, trial: &Trial) -> (f64, f64) {
        let (law, rows, gap) = (self.law, window.kernel.rows(), &trial.gap);
        let (x, q) = (&trial.solution.potential, &trial.solution.attraction);
        let (d, image) = (&own.last[0], &own.image);
        let traction = |h: f64| if h.is_finite() { law.traction(h.max(0.0)) } else { 0.0 };
        let most = d.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        let small = DIFFERENCE * law.range() / most;
        let [start, convex, softened] = rows.sum_terms(|k| {
            (d[k] != 0.0).then(|| {
                let h = gap[k] + x[k];
                let s = traction(h);
                let softened = if h > 0.0 { (s - traction(h + small * d[k])) * d[k] / small } else { 0.0 };
                [(q[k] + s - gradient.multiplier) * d[k], d[k] * image[k], softened]
            })
        });
        let slope = |length: f64| {
            let [attracted] = rows.sum_terms(|k| {
                (d[k] != 0.0).then(|| [(q[k] + traction(gap[k] + x[k] + length * d[k]) - gradient.multiplier) * d[k]])
            });
            attracted + length * convex
        };
        let curvature = (convex - softened) / convex;
        let bends_down = curvature <= LEAST_CURVATURE;
        let mut length = if bends_down { -LONGEST * start / convex } else { -start / (convex * curvature) };
        let (mut low, mut high) = (0.0, None);
        for _ in 0..TRIES {
            let at = slope(length);
            if at.abs() <= SLOPE_LEFT * start.abs() {
                break;
            }
            if at < 0.0 {
                low = length;
                if bends_down && gradient.greatest > NEAR {
                    break;
                }
                length = high.map_or(2.0 * length, |high| 0.5 * (low + high));
            } else {
                high = Some(length);
                length = 0.5 * (low + length);
            }
        }
        (if start < 0.0 { length } else { 0.0 }, curvature)
    }

    /// Writes x + `length` d, kept to h ≥ 0, to the lift that is tried; returns whether the wall or the mean changed it.
    pub(super) fn try_lift(
        &self,
        balance: Balance,
        length: f64,
        own: &mut Passes,
        window: &Window,
        trial: &Trial,
    ) -> bool {
        let (x, gap) = (&trial.solution.potential, &trial.gap);
        let Passes { far: tried, last: [direction, _], .. } = own;
        for_each_band([&mut *tried], |first, [tried]| {
            for (tried, k) in tried.iter_mut().zip(first..) {
                *tried = x[k] + length * direction[k];
            }
        });
        self.project(balance, window.kernel.rows(), gap, tried)
    }
}
