//! One iteration of the active set: its residual, its direction and its length.

use super::{ActiveSet, CORRECTION_LENGTH, JOIN_OVER_RMS, Search};
use crate::kernel::Workspace;
use crate::solver::outcome::{Outcome, ResidualSums, Stop};
use crate::solver::passes::add;
use crate::solver::problem::{Problem, Solution};
use crate::solver::rigid_motion::{ModeCoefficients, dot};

/// Σ (r − mean)² is computed afresh, not from Σ r², where less than this fraction of Σ r² is left.
const MIN_CENTRED_FRACTION: f64 = 1e-6;

/// Penetration outside is found anew where the motion of a tilting body has changed by more than this fraction of rms |r|
/// since the penetration was found.
const MAX_TURN_OVER_RMS: f64 = 1e-6;

/// Iterations without a new lowest residual after which no correction follows another one: a search comes between them.
const MAX_CORRECTIONS_WITHOUT_GAIN: usize = 3;

/// Fraction of the deepest penetration that counts as the deepest.
const DEEPEST: f64 = 0.999;

/// Iterations without a new lowest residual after which the fall-back takes over.
const MAX_ITERATIONS_WITHOUT_GAIN: usize = 40;

/// What z of a direction is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Towards {
    /// P Eᵀ M E P r.
    Preconditioned,
    /// r itself.
    Residual,
    /// Nothing: the residual is below the tolerance, and the direction makes the changes of the pressure alone. A z without
    /// a line search could make it greater again.
    Corrections,
}

impl ActiveSet {
    /// Iterates from a guess until the solve ends, or stagnates.
    pub(super) fn iterate(
        &mut self,
        problem: &Problem<'_>,
        stop: Stop,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Outcome {
        if let Err(body) = self.start(problem, solution, work) {
            return Outcome::Unbalanced(body);
        }
        let (mut lowest, mut without_gain, mut step, mut searched) = (f64::INFINITY, 0, 0.0, 0.0);
        loop {
            let (mut state, mut penetration) = self.advance(problem, solution, step);
            let hasty = without_gain > MAX_CORRECTIONS_WITHOUT_GAIN && searched == 0.0 && step != 0.0;
            if state.negative > 0.0 && self.should_remove_tensile(problem, stop, state, hasty) {
                if let Err(body) = self.remove_tensile_cells(problem, searched, solution, work) {
                    return Outcome::Unbalanced(body);
                }
                (state, penetration) = self.advance(problem, solution, 0.0);
            }
            state.note(problem, penetration, self.guess_rounding, solution);
            let mut ended = stop.outcome(solution, || !self.changes.any() && state.negative == 0.0);
            let tensile = || !solution.pressure.iter().all(|&p| p >= 0.0);
            if ended == Some(Outcome::Converged) && problem.rows().any(tensile()) {
                // tiny tensile pressures, whose squares vanish, still violate p ≥ 0
                if let Err(body) = self.remove_tensile_cells(problem, searched, solution, work) {
                    return Outcome::Unbalanced(body);
                }
                (state, penetration) = self.advance(problem, solution, 0.0);
                ended = stop.outcome(solution, || false);
            }
            if let Some(outcome) = ended {
                return outcome;
            }
            without_gain = if solution.residual < lowest { 0 } else { without_gain + 1 };
            lowest = lowest.min(solution.residual);
            if without_gain > MAX_ITERATIONS_WITHOUT_GAIN {
                return Outcome::Stagnated;
            }
            // do not test the predicted set at iteration 0: it has no pressure yet
            let foreseen = problem.likely.is_some() && solution.counts.iterations == 0;
            // small pressures that leave are all that is left to do
            let solved = solution.residual <= stop.tolerance && self.changes.any();
            if penetration > JOIN_OVER_RMS * state.rms() && !foreseen && !solved {
                let least = if std::mem::take(&mut self.was_cut) {
                    DEEPEST * penetration
                } else {
                    state.joining_depth(penetration)
                };
                self.add_penetrating_cells(problem, least, solution);
                self.advance(problem, solution, 0.0);
            }

            solution.counts.iterations += 1;
            let corrects = self.changes.any();
            let towards = if solved { Towards::Corrections } else { Towards::Preconditioned };
            self.find_direction(problem, towards, solution, work);
            problem.kernel.apply(&self.search.direction, &mut self.search.image, work);
            solution.counts.convolutions += 1;
            step = self.step_length(problem, solution);
            searched = if corrects { 0.0 } else { step };
        }
    }

    /// p += a d, v += a K d; sets r and the free motions, and returns the sums over A and the deepest penetration outside.
    pub(super) fn advance(&mut self, problem: &Problem<'_>, solution: &mut Solution, a: f64) -> (ResidualSums, f64) {
        if a != 0.0 {
            // r had no motion on A before the step: what K d adds is known, but for rounding
            for (motion, &image) in solution.motions.iter_mut().zip(&self.search.image_motions) {
                *motion = motion.plus(a * problem.compliance, image);
            }
        }
        let search = [&*self.search.direction, &*self.search.image];
        let mut state =
            ResidualSums { greatest_gap: self.set.greatest_gap, cells: self.set.count(), ..ResidualSums::default() };
        let (mut square, mut penetration, mut turned) = (0.0, 0.0_f64, 0.0_f64);
        for (body, found) in self.bands.survey(problem, &self.set.runs, a, search, solution).iter().enumerate() {
            // The fit determines a change of the last motion: what the cells at hand do not determine remains as it was.
            let fit = self.set.fit(problem, body, found.residual_modes);
            solution.motions[body] = solution.motions[body].plus(-1.0, fit);
            let tilts = problem.bodies[body].tilts();
            // of a body that tilts, no cell moves more than this
            let moved = if tilts { fit.0.iter().map(|y| y.abs()).sum() } else { -fit.0[0] };
            let (all, fitted) = (found.residual_square, dot(fit.0, found.residual_modes));
            square += all;
            state.square += all - fitted;
            state.displacement += found.displacement_square;
            state.negative += found.negative_square;
            state.deepest = state.deepest.max(found.peak + moved);
            if tilts {
                turned = turned.max(moved);
                penetration = penetration.max(found.penetration);
            } else {
                penetration = penetration.max(found.penetration + moved);
            }
        }
        // where a motion was far off, the difference is mostly rounding
        if state.square < MIN_CENTRED_FRACTION * square {
            [state.square, state.deepest] = self.find_residual(problem, solution);
        }
        if turned > MAX_TURN_OVER_RMS * state.rms() {
            penetration = self.bands.penetration(problem, &self.set.runs, solution);
            [_, state.deepest] = self.find_residual(problem, solution);
        }
        (state, penetration)
    }

    /// z ← r on A, zero elsewhere; returns Σ r² and the greatest r.
    fn find_residual(&mut self, problem: &Problem<'_>, solution: &Solution) -> [f64; 2] {
        self.bands.residual(problem, &self.set.runs, solution, &mut self.preconditioned)
    }

    /// d ← z + β d without free motion on A; with pressures to bring to zero or into balance, d is the whole change of p.
    pub(super) fn find_direction(
        &mut self,
        problem: &Problem<'_>,
        towards: Towards,
        solution: &mut Solution,
        work: &mut Workspace,
    ) {
        // no longer than the last search: where M is too great an inverse, a longer one would not lower the residual
        let length = CORRECTION_LENGTH.min(self.search.length) / problem.compliance;
        let pending = self.changes.any();
        if towards == Towards::Corrections {
            self.preconditioned.fill(0.0);
        } else {
            self.find_residual(problem, solution);
        }
        if towards == Towards::Preconditioned {
            self.preconditioner.apply(&mut self.preconditioned, &self.set, work);
            solution.counts.preconditioner_applications += 1;
        }

        let (runs, z) = (&self.set.runs, &self.preconditioned);
        let Search { direction, image, energy, shifts, .. } = &mut self.search;
        let mut overlap = 0.0;
        let found = self.bands.overlaps(problem, runs, z, [direction, image]);
        for (body, found) in found.iter().enumerate() {
            let fit = self.set.fit(problem, body, found.residual_modes);
            shifts[body] = ModeCoefficients::default().plus(-1.0, fit);
            overlap += found.residual_image - dot(fit.0, found.image_modes);
        }
        let beta = conjugate(*energy, overlap, pending);
        // without a last direction, d holds values of an earlier solve
        if beta != 0.0 {
            for (body, found) in found.iter().enumerate() {
                shifts[body] = shifts[body].plus(-beta, self.set.fit(problem, body, found.direction_modes));
            }
        }
        let scale = if pending { length } else { 1.0 };
        self.bands.redirect(problem, runs, [scale, beta], shifts, z, direction);
        if pending {
            self.correct_direction(problem, solution);
        }
    }

    /// Lets the direction bring the pressures that leave to zero, move them to the cells around, and balance what it leads to.
    fn correct_direction(&mut self, problem: &Problem<'_>, solution: &Solution) {
        if self.changes.moves {
            self.move_leaving(solution);
            add(&mut self.search.direction, 1.0, &self.preconditioned);
        }
        let Search { direction, shifts: balances, .. } = &mut self.search;
        let (runs, p) = (&self.set.runs, &solution.pressure);
        if self.changes.leaving {
            runs.outside(p.len()).for_each(|cells| {
                direction[cells.clone()].iter_mut().zip(&p[cells]).for_each(|(d, &p)| *d = -p);
            });
        }
        let corrections = &mut self.changes.corrections;
        if corrections.iter().all(Option::is_none) {
            return;
        }
        let mut bodies = corrections.iter().zip(balances.iter_mut()).enumerate();
        let whole = bodies.all(|(body, (correction, balance))| {
            let next = |k: usize| p[k] + direction[k];
            let pieces = |band| self.set.pieces_in(problem, body, band);
            let found =
                correction.and_then(|_| problem.modes(body).balance(problem.rows(), pieces, next, |k| self.shape[k]));
            *balance = found.unwrap_or_default();
            found.is_some() == correction.is_some()
        });
        if whole {
            let corrections = corrections.iter_mut().zip(balances);
            corrections.for_each(|(correction, y)| *correction = correction.map(|_| *y));
        } else if self.changes.moves {
            // what leaves is dropped: the balance of the rest is known
            runs.cells().for_each(|k| direction[k] -= self.preconditioned[k]);
        }
        self.bands.correct(problem, runs, &self.changes.corrections, whole, [p, &self.shape], direction);
    }

    /// The length a of the step along d, 1 for a correction. Brings cells that leave to p = 0.
    pub(super) fn step_length(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> f64 {
        let [slope, curvature] = self.slope_and_curvature(problem, solution);
        let energy = &mut self.search.energy;
        *energy = curvature;
        if !self.changes.any() {
            // a direction that vanishes, as on a single cell, gains nothing
            // the product of small ones may vanish
            let product = problem.compliance * curvature;
            let length = if product > 0.0 { slope / product } else { slope / curvature / problem.compliance };
            let downhill = slope > 0.0 && curvature > 0.0 && length.is_finite();
            if downhill {
                self.search.length = length * problem.compliance;
            }
            return if downhill { length } else { 0.0 };
        }
        // nothing is conjugate to a correction, which has no line search
        *energy = 0.0;
        if self.changes.leaving {
            self.set.runs.outside(solution.pressure.len()).for_each(|cells| solution.pressure[cells].fill(0.0));
        }
        self.changes.clear();
        1.0
    }

    /// Σ r d and Σ d·Kd on A; notes how K d moves the bodies that tilt.
    pub(super) fn slope_and_curvature(&mut self, problem: &Problem<'_>, solution: &Solution) -> [f64; 2] {
        let Search { direction, image, image_motions, .. } = &mut self.search;
        let found = self.bands.slope_and_curvature(problem, &self.set.runs, solution, [direction, image]);
        let mut sums = [0.0; 2];
        for (body, found) in found.iter().enumerate() {
            let tilts = problem.bodies[body].tilts();
            image_motions[body] =
                if tilts { self.set.fit(problem, body, found.image_modes) } else { Default::default() };
            sums = [sums[0] + found.residual_direction, sums[1] + found.direction_image];
        }
        sums
    }
}

/// β from z·Kd. A correction is not conjugate to the last direction: conjugacy would only spread the error of its length.
fn conjugate(energy: f64, overlap: f64, pending: bool) -> f64 {
    if energy > 0.0 && !pending { -overlap / energy } else { 0.0 }
}
