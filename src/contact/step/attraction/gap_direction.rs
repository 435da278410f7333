//! Gradient, direction and length of an iteration in the gap.

use super::descent::Descent;
use super::passes::InGap;
use crate::adhesion::Attraction;
use crate::equilibrium::window::Window;
use crate::parallel::for_each_band;
use crate::solver::Solution;
use crate::sum::scattered;

/// Least curvature of E along a direction, over the curvature of its convex part.
const LEAST_CURVATURE: f64 = 1e-3;
/// Where the greatest |r| is a smaller part of the greatest traction, a step of negative curvature leads to the first
/// minimum; else it has the length of so many steps of the convex part.
const NEAR: f64 = 0.1;
const LONGEST: f64 = 4.0;
/// What a line search leaves of the slope, and how often it tries.
const SLOPE_LEFT: f64 = 0.1;
const TRIES: usize = 10;
/// A direction descends by this part of the steepest one, or the search begins anew.
const LEAST_DESCENT: f64 = 1e-3;
/// The softest direction is looked for in at most so many turns: until it is clearly negative, or the quotient is
/// known to this part of the curvature.
const MOST_TURNS: usize = 100;
const NEGATIVE: f64 = -1e-2;
const PRECISE: f64 = 0.2;
/// What rounding leaves of a direction that is exact.
const EXHAUSTED: f64 = 1e-6;
/// The search goes on until a direction of quotient 0 would have grown by half this power of e beyond the direction
/// that is found.
const GROWN: f64 = 8.0;
/// At a curvature κ of its softest direction a state is about κ² short of a fold, in r: the descent ends where r is
/// below this part of κ², or below the least.
const FOLD: f64 = 0.05;
const LEAST_FOLD: f64 = 1e-9;
/// The greatest change of the gap at first on the way from a state that is unstable, in ranges.
const SPAN: f64 = 0.03;
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

/// −s′ of an open gap.
fn softens(law: &dyn Attraction, h: f64) -> f64 {
    if !(h > 0.0 && h.is_finite()) {
        return 0.0;
    }
    let small = 0.5 * DIFFERENCE * law.range();
    let (before, after) = ((h - small).max(0.0), h + small);
    (law.traction(before) - law.traction(after)) / (after - before)
}

impl Descent<'_> {
    /// Writes r to the pressure.
    pub(super) fn gradient(&mut self) -> Gradient {
        let Descent { problem, balance, window, trial, .. } = self;
        let (law, gap, rows) = (problem.law, &trial.gap, window.kernel.rows());
        let Solution { potential: x, attraction: q, pressure: r, .. } = &mut trial.solution;
        let traction = |h: f64| if h.is_finite() { law.traction(h.max(0.0)) } else { 0.0 };
        for_each_band([&mut *r], |first, [r]| {
            r.iter_mut().zip(first..).for_each(|(r, k)| *r = q[k] + traction(gap[k] + x[k]));
        });
        let is_open = |k: usize| gap[k] + x[k] > 0.0;
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
    pub(super) fn turn(&mut self, before: f64, has_last: bool) -> f64 {
        let Descent { balance, own, window, trial, counts, .. } = self;
        let Window { kernel, work, .. } = &mut **window;
        let (rows, gap, x, r) = (kernel.rows(), &trial.gap, &trial.solution.potential, &trial.solution.pressure);
        let InGap { direction, traction: last_r, lift: steepest_y, .. } = own.in_gap();
        counts.convolutions += 1;
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
            // cells of the wall that open do so at the cost of the open ones: a shift of all cells would lift pressed
            // ones
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
    pub(super) fn length(&mut self, gradient: Gradient) -> (f64, f64) {
        let Descent { problem, own, window, trial, .. } = self;
        let (law, rows, gap) = (problem.law, window.kernel.rows(), &trial.gap);
        let (x, q) = (&trial.solution.potential, &trial.solution.attraction);
        let InGap { direction: d, image, .. } = own.in_gap();
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
        let curvature = (convex - softened) / convex;
        let bends_down = curvature <= LEAST_CURVATURE;
        let mut length = if bends_down { -LONGEST * start / convex } else { -start / (convex * curvature) };
        let (mut low, mut high) = (0.0, None);
        for _ in 0..TRIES {
            let at = self.slope(gradient, length) + length * convex;
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

    /// The slope of E along the direction after a step of this length, but for the slope of its convex part.
    fn slope(&mut self, gradient: Gradient, length: f64) -> f64 {
        let Descent { problem, own, window, trial, .. } = self;
        let (x, q, gap) = (&trial.solution.potential, &trial.solution.attraction, &trial.gap);
        let InGap { direction: d, .. } = own.in_gap();
        let [attracted] = window.kernel.rows().sum_terms(|k| {
            (d[k] != 0.0).then(|| {
                let h = gap[k] + x[k] + length * d[k];
                let s = if h.is_finite() { problem.law.traction(h.max(0.0)) } else { 0.0 };
                [(q[k] + s - gradient.multiplier) * d[k]]
            })
        });
        attracted
    }

    /// Whether r is so small that the descent may end, at this curvature, and beside the fold that the softest
    /// direction may show.
    pub(super) fn ends(&self, gradient: Gradient, soft: f64, softest: Option<f64>) -> bool {
        let fold = softest.map_or(1.0, |soft| (FOLD * soft * soft).max(LEAST_FOLD));
        gradient.greatest <= fold.min(self.own.exactness * self.problem.tolerance(soft))
    }

    /// What the least curvature of the state before the step was found to be, less the greatest rise of −s′ since,
    /// over its greatest value.
    pub(super) fn least_stiffness(&self) -> f64 {
        let Descent { problem, window, trial, .. } = self;
        let (state, law, initial) = (problem.state, problem.law, window.gap(&problem.step.indenter));
        let [now, u] = [&trial.solution.potential, state.history.displacement()];
        let mut motion = state.held.current.motions[0];
        motion.approach -= initial.datum;
        let rise = |k: usize| {
            let before = initial.above[k] + u[k] - motion.at(state.held.region.center(k));
            softens(law, trial.gap[k] + now[k]) - softens(law, before)
        };
        let most = state.held.region.rows().greatest((0..u.len()).map(rise).fold(0.0, f64::max));
        state.held.current.solution.stiffness - most / problem.scene.ground.softening
    }

    /// Looks for the direction of the open cells along which E bends up least, over what its convex part does: by
    /// conjugate gradients for the quotient (Bradbury & Fletcher, Numer. Math. 9, 1966), from a random direction: the
    /// last one has the symmetry of the state, and may have none of the one that breaks it. Writes it, with its M
    /// d/c, so long that it changes the gap by [`SPAN`] ranges; returns the quotient. r and q make room; q is
    /// computed afresh.
    pub(super) fn softest(&mut self, look: usize) -> f64 {
        let Descent { problem, balance, inverse, own, window, trial, counts } = self;
        let (law, rows, c) = (problem.law, window.kernel.rows().clone(), balance.compliance);
        let gap = &trial.gap;
        let Solution { potential: x, attraction: w, pressure: softening, .. } = &mut trial.solution;
        let x = &*x;
        for_each_band([&mut *softening], |first, [softening]| {
            softening.iter_mut().zip(first..).for_each(|(softening, k)| *softening = softens(law, gap[k] + x[k]));
        });
        let (softening, is_open) = (&*softening, |k: usize| gap[k] + x[k] > 0.0);
        // a mean that is given takes none of a direction, and no constant of a residual
        let level = |field: &mut [f64]| {
            if balance.held {
                let [sum, open] = rows.sum_terms(|k| is_open(k).then(|| [field[k], 1.0]));
                field.iter_mut().enumerate().filter(|(k, _)| is_open(*k)).for_each(|(_, y)| *y -= sum / open);
            }
        };
        // K of a field, on the open cells
        let smooth = |window: &mut Window, field: &mut [f64]| {
            level(field);
            let Window { kernel, work, .. } = window;
            let mean = (balance.soft - c * balance.inverse[1]) * rows.sum(field) / field.len() as f64;
            kernel.apply_in_place(field, work);
            field.iter_mut().enumerate().for_each(|(k, y)| *y = if is_open(k) { c * *y + mean } else { 0.0 });
            level(field);
        };
        // another for each look of a descent: of two modes that are soft alike the last one has found a mix, and
        // would find none of what is left
        let salt = look * gap.len();
        let InGap { direction: v, image, lift: p, traction: image_of_p } = own.in_gap();
        v.iter_mut().enumerate().for_each(|(k, v)| *v = softening[k] * (2.0 * scattered(salt + k) - 1.0));
        smooth(window, v);
        balance.tractions(inverse, window, v, image, true);
        counts.convolutions += 2;
        p.fill(0.0);
        image_of_p.fill(0.0);
        let [mut softened, mut convex] = rows.sum_terms(|k| Some([softening[k] * v[k] * v[k], v[k] * image[k]]));
        let mut before = 0.0;
        for turn in 0..MOST_TURNS {
            let [of_vp, of_pp, with_vp, with_pp] = rows.sum_terms(|k| {
                let softened = softening[k] * p[k];
                Some([softened * v[k], softened * p[k], p[k] * image[k], p[k] * image_of_p[k]])
            });
            // the greatest quotient of v + t p
            let (a, b) = (of_pp * with_vp - of_vp * with_pp, of_pp * convex - softened * with_pp);
            let e = of_vp * convex - softened * with_vp;
            let root = (b * b - 4.0 * a * e).max(0.0).sqrt();
            let t = if b < 0.0 { 2.0 * e / (-b + root) } else { -(b + root) / (2.0 * a) };
            if t.is_finite() {
                softened += t * (2.0 * of_vp + t * of_pp);
                convex += t * (2.0 * with_vp + t * with_pp);
                // p stays apart from v, since their mix would be lost in rounding
                let shared = (with_vp + t * with_pp) / convex;
                for_each_band([&mut *v, &mut *image, &mut *p, &mut *image_of_p], |_, [v, image, p, image_of_p]| {
                    for (((v, image), p), image_of_p) in v.iter_mut().zip(image).zip(p).zip(image_of_p) {
                        (*v, *image) = (*v + t * *p, *image + t * *image_of_p);
                        (*p, *image_of_p) = (*p - shared * *v, *image_of_p - shared * *image);
                    }
                });
            }
            let share = softened / convex;
            if !(softened > 0.0 && convex > 0.0) || 1.0 - share < NEGATIVE {
                break;
            }
            // (softening − share M) of a direction: the gradient of the quotient, of v, and its bend, of p
            let left_of = |d: &[f64], image: &[f64], k: usize| softening[k] * d[k] - share * image[k];
            for_each_band([&mut *w], |first, [w]| {
                w.iter_mut().zip(first..).for_each(|(w, k)| *w = if is_open(k) { left_of(v, image, k) } else { 0.0 });
            });
            smooth(window, w);
            counts.convolutions += 1;
            // the next p is conjugate to p in the bend of the quotient
            let [steepest, of_p, of_w] = rows.sum_terms(|k| {
                let of_last = left_of(p, image_of_p, k);
                Some([w[k] * left_of(v, image, k), p[k] * of_last, w[k] * of_last])
            });
            let square = (steepest / convex).max(0.0);
            let left = square.sqrt();
            // of a random direction, as K smooths it, a long wave is about the part N^-¼; one of quotient 0 gains
            // e^(2√q) a turn on one of quotient q
            let grown = 4.0 * (1.0 - share).abs().sqrt() * turn as f64 >= 0.5 * (v.len() as f64).ln() + GROWN;
            if left <= EXHAUSTED || grown && left <= PRECISE * (1.0 - share).abs() {
                break;
            }
            let conjugate = if of_p < 0.0 { -of_w / of_p } else { 0.0 };
            let beta = if before > 0.0 { conjugate.clamp(0.0, square / before) } else { 0.0 };
            before = square;
            p.iter_mut().zip(&*w).for_each(|(p, w)| *p = w + beta * *p);
            balance.tractions(inverse, window, p, image_of_p, true);
            counts.convolutions += 1;
        }
        // w took the place of q
        balance.tractions(inverse, window, x, w, false);
        counts.convolutions += 1;
        if !(softened > 0.0 && convex > 0.0) {
            return 1.0;
        }
        let most = v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let scale = SPAN * law.range() / most;
        [v, image].into_iter().for_each(|field| field.iter_mut().for_each(|value| *value *= scale));
        1.0 - softened / convex
    }

    /// Turns the softest direction downhill; returns how far to go along it: as far as E falls.
    pub(super) fn way_out(&mut self, gradient: Gradient) -> f64 {
        let uphill = self.slope(gradient, 0.0) > 0.0;
        let InGap { direction, image, .. } = self.own.in_gap();
        if uphill {
            direction.iter_mut().chain(image.iter_mut()).for_each(|value| *value = -*value);
        }
        let convex = self.window.kernel.rows().sum_of_pairs(direction, image, |d, image| d * image);
        let mut length = 1.0;
        for _ in 0..TRIES {
            if self.slope(gradient, 2.0 * length) + 2.0 * length * convex >= 0.0 {
                break;
            }
            length *= 2.0;
        }
        length
    }
}
