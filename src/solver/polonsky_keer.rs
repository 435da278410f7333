//! The reference solver of the source paper.

use crate::kernel::Workspace;
use crate::solver::cold_start::cold_start;
use crate::solver::problem::{Problem, Solution, Stop, relative_residual};

/// Conjugate gradients on the cells in contact, after Polonsky & Keer (Wear 231, 1999): two
/// convolutions an iteration, one for the gap and one for the step length.
#[derive(Debug, Clone)]
pub(crate) struct PolonskyKeer {
    gap: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl PolonskyKeer {
    pub(crate) fn new(cells: usize) -> PolonskyKeer {
        let field = vec![0.0; cells];
        PolonskyKeer { gap: field.clone(), direction: field.clone(), image: field }
    }

    /// Improves `solution` until its residual is below the tolerance or the iterations are spent.
    pub(crate) fn solve(&mut self, problem: &Problem<'_>, stop: Stop, solution: &mut Solution, work: &mut Workspace) {
        make_feasible(problem, solution);
        self.direction.fill(0.0);
        let (mut gap_square_old, mut conjugate) = (1.0, false);
        loop {
            solution.convolve(problem, work);
            let gap_square = self.measure(problem, solution);
            if solution.residual <= stop.tolerance || solution.counts.iterations >= stop.max_iterations {
                return;
            }
            solution.counts.iterations += 1;

            // t = h + δ G/G_old t in contact
            let beta = if conjugate && gap_square_old > 0.0 { gap_square / gap_square_old } else { 0.0 };
            gap_square_old = gap_square;
            let cells = solution.pressure.iter().zip(&self.gap);
            for (t, (&p, &h)) in self.direction.iter_mut().zip(cells) {
                *t = if p > 0.0 { h + beta * *t } else { 0.0 };
            }

            // step length from the image of the direction, less its mean in contact
            problem.kernel.apply(&self.direction, &mut self.image, work);
            solution.counts.convolutions += 1;
            let (mut sum, mut count) = (0.0, 0.0);
            for (&p, &kt) in solution.pressure.iter().zip(&self.image) {
                if p > 0.0 {
                    sum += kt;
                    count += 1.0;
                }
            }
            let mean = sum / count;
            let (mut numerator, mut denominator) = (0.0, 0.0);
            for ((&t, &kt), &h) in self.direction.iter().zip(&self.image).zip(&self.gap) {
                // t is zero outside contact, where h may be infinite
                if t != 0.0 {
                    numerator += h * t;
                    denominator += t * (kt - mean);
                }
            }
            let step = if denominator > 0.0 {
                numerator / (problem.compliance * denominator)
            } else {
                // a single cell has no direction; p/v there is the inverse of its own influence
                let pressed = solution.pressure.iter().zip(&solution.potential).filter(|(p, _)| **p > 0.0);
                let (p, v) = pressed.fold((0.0, 0.0), |sum, (p, v)| (sum.0 + p, sum.1 + v));
                p / (problem.compliance * v)
            };

            // advance, clip, let penetrating cells in
            let (mut total, mut entered) = (0.0, false);
            for ((p, &t), &h) in solution.pressure.iter_mut().zip(&self.direction).zip(&self.gap) {
                let was_in_contact = *p > 0.0;
                *p = (*p - step * t).max(0.0);
                if *p == 0.0 && !was_in_contact && h < 0.0 {
                    *p = -step * h;
                    entered = entered || *p > 0.0;
                }
                total += *p;
            }
            conjugate = !entered;
            if total > 0.0 {
                let scale = problem.total / total;
                solution.pressure.iter_mut().for_each(|p| *p *= scale);
            } else {
                cold_start(problem, solution);
            }
        }
    }

    /// Gap, approach and residual of a state; returns the sum of the squared gaps in contact.
    fn measure(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> f64 {
        let c = problem.compliance;
        // see ActiveSet::measure for the pivot
        let first = solution.pressure.iter().position(|&p| p > 0.0).unwrap_or(0);
        let pivot = c * solution.potential[first] + problem.gap[first];
        let (mut sum, mut displacement, mut count) = (0.0, 0.0, 0_usize);
        for ((h, (&p, &v)), &gap) in
            self.gap.iter_mut().zip(solution.pressure.iter().zip(&solution.potential)).zip(problem.gap)
        {
            *h = c * v + gap - pivot;
            if p > 0.0 {
                sum += *h;
                displacement += (c * v).powi(2);
                count += 1;
            }
        }
        let mean = sum / count as f64;
        solution.approach = pivot + mean;
        let (mut square, mut penetration) = (0.0, 0.0_f64);
        for (h, &p) in self.gap.iter_mut().zip(&solution.pressure) {
            *h -= mean;
            if p > 0.0 {
                square += *h * *h;
            } else {
                penetration = penetration.max(-*h);
            }
        }
        solution.residual = relative_residual(square, penetration, displacement, count);
        square
    }
}

/// Clips a guess to p ≥ 0, zero where there is nothing to touch, and scales it to the total.
fn make_feasible(problem: &Problem<'_>, solution: &mut Solution) {
    let mut total = 0.0;
    for (p, &gap) in solution.pressure.iter_mut().zip(problem.gap) {
        *p = if gap.is_finite() { p.max(0.0) } else { 0.0 };
        total += *p;
    }
    if total > 0.0 {
        let scale = problem.total / total;
        solution.pressure.iter_mut().for_each(|p| *p *= scale);
    } else {
        cold_start(problem, solution);
    }
}
