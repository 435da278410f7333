//! Gradient, direction and length of an iteration in the gap.

use super::balance::Operators;
use super::descent::{Along, DESCENT, Descent, Gradient};
use super::passes::InGap;
use super::softest::{Convex, softest};
use crate::attraction::Attraction;
use crate::parallel::for_each_band;
use crate::solver::Solution;
use crate::sum::scattered;

/// Curvature is measured by a change of the gap by this part of the range.
const DIFFERENCE: f64 = 1e-4;

/// s of a gap.
fn attraction_at(law: &dyn Attraction, h: f64) -> f64 {
    if h.is_finite() { law.traction(h.max(0.0)) } else { 0.0 }
}

/// −s′ of an open gap.
fn softening_at(law: &dyn Attraction, h: f64) -> f64 {
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
        let Descent { problem, operators: Operators { balance, window, .. }, trial, .. } = self;
        let (law, gap, rows) = (problem.law, &trial.gap, window.kernel.rows());
        let Solution { potential: x, attraction: q, pressure: r, .. } = &mut trial.solution;
        for_each_band([&mut *r], |first, [r]| {
            r.iter_mut().zip(first..).for_each(|(r, k)| *r = q[k] + attraction_at(law, gap[k] + x[k]));
        });
        let is_open = |k: usize| gap[k] + x[k] > 0.0;
        let mut multiplier = 0.0;
        if balance.held {
            // cells at the wall that open join the mean
            let mut joins = f64::NEG_INFINITY;
            for _ in 0..DESCENT.tries {
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

    /// Writes the next direction d, conjugate to the last one, with y·r `before`, where this is not 0, and M d/c.
    /// Returns y·r of the steepest one, y = K r.
    pub(super) fn turn(&mut self, before: f64) -> f64 {
        let steepest = self.precondition(before);
        let InGap { direction, image, .. } = &mut self.own.in_gap;
        self.operators.stiffen(direction, image);
        steepest
    }

    /// Writes the preconditioned direction, conjugate to the last one, with y·r `before`, where this is not 0.
    fn precondition(&mut self, before: f64) -> f64 {
        let Descent { operators, own, trial, .. } = self;
        let (gap, Solution { potential: x, pressure: r, .. }) = (&trial.gap, &trial.solution);
        let InGap { direction, traction: last_r, lift: y, .. } = &mut own.in_gap;
        y.copy_from_slice(r);
        operators.precondition(y);
        let (rows, balance) = (operators.rows(), &operators.balance);
        let is_free = |k: usize| gap[k] + x[k] > 0.0 || r[k] < 0.0;
        let [sum, free] = rows.sum_terms(|k| is_free(k).then_some([y[k], 1.0]));
        let level = if balance.held { sum / f64::max(free, 1.0) } else { 0.0 };
        let [steepest, overlap] =
            rows.sum_terms(|k| is_free(k).then(|| [(y[k] - level) * r[k], (y[k] - level) * last_r[k]]));
        let beta = if before > 0.0 { f64::max((steepest - overlap) / before, 0.0) } else { 0.0 };
        let old = &*direction;
        let [along] = rows.sum_terms(|k| is_free(k).then(|| [r[k] * (beta * old[k] - (y[k] - level))]));
        // a direction that descends by less than a thousandth of the steepest one is given up for that one
        let beta = if beta > 0.0 && along < -1e-3 * steepest { beta } else { 0.0 };
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

    /// The step along the direction.
    pub(super) fn length(&self, gradient: Gradient) -> Along {
        let Descent { problem, own, operators, trial } = self;
        let (law, rows, gap) = (problem.law, operators.rows(), &trial.gap);
        let (x, q) = (&trial.solution.potential, &trial.solution.attraction);
        let InGap { direction: d, image, .. } = &own.in_gap;
        let most = d.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        let small = DIFFERENCE * law.range() / most;
        let [start, convex, softened] = rows.sum_terms(|k| {
            (d[k] != 0.0).then(|| {
                let h = gap[k] + x[k];
                let s = attraction_at(law, h);
                let softened = if h > 0.0 { (s - attraction_at(law, h + small * d[k])) * d[k] / small } else { 0.0 };
                [(q[k] + s - gradient.multiplier) * d[k], d[k] * image[k], softened]
            })
        });
        let curvature = (convex - softened) / convex;
        // or nearly so
        let bends_down = curvature <= 1e-3;
        let mut length = if bends_down { -DESCENT.longest * start / convex } else { -start / (convex * curvature) };
        let (mut low, mut high) = (0.0, None);
        for _ in 0..DESCENT.tries {
            let at = self.slope(gradient, length) + length * convex;
            if at.abs() <= DESCENT.slope_left * start.abs() {
                break;
            }
            if at < 0.0 {
                low = length;
                if bends_down && gradient.greatest > DESCENT.near {
                    break;
                }
                length = high.map_or(2.0 * length, |high| 0.5 * (low + high));
            } else {
                high = Some(length);
                length = 0.5 * (low + length);
            }
        }
        Along { length: if start < 0.0 { length } else { 0.0 }, curvature }
    }

    /// The slope of E along the direction after a step of this length, but for the slope of its convex part.
    fn slope(&self, gradient: Gradient, length: f64) -> f64 {
        let Descent { problem, own, operators, trial } = self;
        let (x, q, gap) = (&trial.solution.potential, &trial.solution.attraction, &trial.gap);
        let d = &own.in_gap.direction;
        let [attracted] = operators.rows().sum_terms(|k| {
            let s = || attraction_at(problem.law, gap[k] + x[k] + length * d[k]);
            (d[k] != 0.0).then(|| [(q[k] + s() - gradient.multiplier) * d[k]])
        });
        attracted
    }

    /// Whether r is so small that the descent may end, at this curvature.
    pub(super) fn ends(&self, gradient: Gradient, soft: f64) -> bool {
        gradient.greatest <= self.problem.tolerance(soft)
    }

    /// What the least curvature of the state before the step was found to be, less the maximum rise of −s′ since,
    /// over its maximum value.
    pub(super) fn least_stiffness(&self) -> f64 {
        let Descent { problem, operators, trial, .. } = self;
        let (state, law, initial) = (problem.state, problem.law, operators.window.gap(&problem.step.indenter));
        let [now, u] = [&trial.solution.potential, state.history.displacement()];
        let mut motion = state.held.current.motions[0];
        motion.approach -= initial.datum;
        let rise = |k: usize| {
            let before = initial.above[k] + u[k] - motion.at(state.held.region.center(k));
            softening_at(law, trial.gap[k] + now[k]) - softening_at(law, before)
        };
        let most = state.held.region.rows().greatest((0..u.len()).map(rise).fold(0.0, f64::max));
        state.held.current.solution.stiffness - most / problem.scene.ground.softening
    }

    /// Looks for the softest direction of the open cells: writes it, with its M d/c, so long that it changes the gap by a
    /// [part](super::descent::DescentNumbers::span) of the range, and returns its curvature. It overwrites r, and
    /// computes q afresh.
    ///
    /// The search begins at random: the last direction has the symmetry of the state, and may have none of the one that
    /// breaks it. Each look of a descent begins anew: of two modes that are soft alike the last one has found a mix, and
    /// would find none of what is left.
    pub(super) fn find_softest(&mut self, look: usize) -> f64 {
        let Descent { problem, operators, own, trial } = self;
        let (law, gap, rows) = (problem.law, &trial.gap[..], operators.rows().clone());
        let Solution { potential, attraction: q, pressure: softening, .. } = &mut trial.solution;
        let x = &potential[..];
        for_each_band([&mut *softening], |first, [softening]| {
            softening.iter_mut().zip(first..).for_each(|(softening, k)| *softening = softening_at(law, gap[k] + x[k]));
        });
        let InGap { direction: v, image, lift: turn, traction: image_of_turn } = &mut own.in_gap;
        let scatter = |k: usize| 2.0 * scattered(look * gap.len() + k) - 1.0;
        v.iter_mut().enumerate().for_each(|(k, v)| *v = softening[k] * scatter(k));
        let mut open = OpenCells { operators, gap, x };
        let found = softest(&mut open, &rows, softening, [v, image], [turn, image_of_turn], q);
        operators.tractions(x, q);
        let Some(curvature) = found else { return 1.0 };
        let most = v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let scale = DESCENT.span * law.range() / most;
        v.iter_mut().chain(image).for_each(|value| *value *= scale);
        curvature
    }

    /// Turns the softest direction downhill; returns how far to go along it: as far as E falls.
    pub(super) fn way_out(&mut self, gradient: Gradient) -> f64 {
        if self.slope(gradient, 0.0) > 0.0 {
            self.own.in_gap.reverse();
        }
        let InGap { direction, image, .. } = &self.own.in_gap;
        let convex = self.operators.rows().sum_of_pairs(direction, image, |d, image| d * image);
        let mut length = 1.0;
        for _ in 0..DESCENT.tries {
            if self.slope(gradient, 2.0 * length) + 2.0 * length * convex >= 0.0 {
                break;
            }
            length *= 2.0;
        }
        length
    }
}

/// The convex part of E on the cells that are open.
struct OpenCells<'a, 'b> {
    operators: &'a mut Operators<'b>,
    gap: &'a [f64],
    x: &'a [f64],
}

impl OpenCells<'_, '_> {
    /// A mean that is given takes none of a direction, and no constant of a residual.
    fn level(&self, field: &mut [f64]) {
        if self.operators.balance.held {
            let [sum, open] = self.operators.rows().sum_terms(|k| self.is_free(k).then(|| [field[k], 1.0]));
            field.iter_mut().enumerate().filter(|(k, _)| self.is_free(*k)).for_each(|(_, y)| *y -= sum / open);
        }
    }
}

impl Convex for OpenCells<'_, '_> {
    fn is_free(&self, k: usize) -> bool {
        self.gap[k] + self.x[k] > 0.0
    }

    fn stiffen(&mut self, v: &[f64], image: &mut [f64]) {
        self.operators.stiffen(v, image);
    }

    fn precondition(&mut self, field: &mut [f64]) {
        self.level(field);
        self.operators.precondition(field);
        field.iter_mut().enumerate().filter(|(k, _)| !self.is_free(*k)).for_each(|(_, y)| *y = 0.0);
        self.level(field);
    }
}
