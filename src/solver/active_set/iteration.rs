//! One iteration of the active set: its residual, its direction and its length.

use super::{ActiveSet, CORRECTION_LENGTH, JOIN_OVER_RMS};
use crate::kernel::Workspace;
use crate::solver::contact_cells::{self, ContactCells};
use crate::solver::outcome::{Outcome, ResidualSums, Stop};
use crate::solver::passes::{Fields, Survey};
use crate::solver::problem::{Problem, Solution};

/// Σ (r − mean)² is computed afresh, not from Σ r², where less than this fraction of Σ r² is left.
const MIN_CENTRED_FRACTION: f64 = 1e-6;

/// Iterations without a new lowest residual after which the fall-back takes over.
const MAX_ITERATIONS_WITHOUT_GAIN: usize = 40;

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
        let (mut lowest, mut without_gain, mut step) = (f64::INFINITY, 0, 0.0);
        loop {
            let (mut state, mut penetration) = self.advance(problem, solution, step);
            if state.negative > 0.0 && self.should_remove_tensile(problem, stop, state) {
                if let Err(body) = self.remove_tensile_cells(problem, solution, work) {
                    return Outcome::Unbalanced(body);
                }
                (state, penetration) = self.advance(problem, solution, 0.0);
            }
            state.note(problem, penetration, self.guess_rounding, solution);
            let mut ended = stop.outcome(solution, || !self.pending() && state.negative == 0.0);
            if ended == Some(Outcome::Converged) && !solution.pressure.iter().all(|&p| p >= 0.0) {
                // tiny tensile pressures, whose squares vanish, still violate p ≥ 0
                if let Err(body) = self.remove_tensile_cells(problem, solution, work) {
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
            if penetration > JOIN_OVER_RMS * state.rms() {
                self.add_penetrating_cells(problem, state.joining_depth(penetration), solution);
                self.advance(problem, solution, 0.0);
            }

            solution.counts.iterations += 1;
            self.find_direction(problem, solution);
            problem.kernel.apply(&self.search.direction, &mut self.search.image, work);
            solution.counts.convolutions += 1;
            step = self.step_length(problem, solution);
        }
    }

    /// p += a d, v += a K d; sets r and the free motions, and returns the sums over A and the deepest penetration outside.
    pub(super) fn advance(&mut self, problem: &Problem<'_>, solution: &mut Solution, a: f64) -> (ResidualSums, f64) {
        if self.is_upright(problem) {
            return self.advance_upright(problem, solution, a);
        }
        if a != 0.0 {
            for k in contact_cells::all(&self.set.contacts) {
                solution.pressure[k] += a * self.search.direction[k];
            }
            for (v, &kd) in solution.potential.iter_mut().zip(&self.search.image) {
                *v += a * kd;
            }
        }
        let state = contact_cells::fit_motions(problem, &self.set.contacts, solution, &mut self.residual);
        (state, problem.penetration(solution, |k| !self.set.member[k]))
    }

    fn advance_upright(&mut self, problem: &Problem<'_>, solution: &mut Solution, a: f64) -> (ResidualSums, f64) {
        let motion = solution.motions[0].0[0];
        let found = self.passes.survey(
            a,
            problem.compliance,
            motion,
            Fields {
                gap: problem.gap,
                direction: &self.search.direction,
                image: &self.search.image,
                pressure: &mut solution.pressure,
                potential: &mut solution.potential,
                residual: &mut self.residual,
            },
        );
        let cells = self.passes.runs.count();
        let count = cells.max(1) as f64;
        self.residual_mean = if problem.modes(0).translates() { found.residual / count } else { 0.0 };
        solution.motions[0].0[0] = motion - self.residual_mean;
        let mut square = found.square - count * self.residual_mean * self.residual_mean;
        // where the motion was far off, the difference is mostly rounding
        if square < MIN_CENTRED_FRACTION * found.square {
            square = self.passes.center(self.residual_mean, &mut self.residual, &mut self.preconditioned);
            self.residual_mean = 0.0;
        }
        let Survey { displacement, negative, .. } = found;
        let state = ResidualSums {
            square,
            displacement,
            negative,
            greatest_gap: self.set.greatest_gap,
            cancellation: 0.0,
            cells,
        };
        (state, (found.depth + solution.motions[0].0[0]).max(0.0))
    }

    /// d ← z + β d without free motion on A; with pressures to bring to zero or into balance, d is the
    /// whole change of p.
    pub(super) fn find_direction(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let (length, pending) = (CORRECTION_LENGTH / problem.compliance, self.pending());
        if self.is_upright(problem) {
            return self.find_direction_upright(problem, solution, length, pending);
        }
        let z = &mut self.preconditioned;
        z.fill(0.0);
        for (contact, change) in self.set.contacts.iter().zip(&self.changes) {
            contact.cells.iter().for_each(|&k| z[k as usize] = self.residual[k as usize]);
            for &k in &change.leaving {
                z[k as usize] = -solution.pressure[k as usize] / (length * self.preconditioner.diagonal());
            }
        }
        self.preconditioner.apply(z);
        solution.counts.preconditioner_applications += 1;

        self.conjugate_preconditioned(problem, pending);

        self.search.direction.fill(0.0);
        let scale = if pending { length } else { 1.0 };
        for (body, (contact, change)) in self.set.contacts.iter().zip(&self.changes).enumerate() {
            let z = &self.preconditioned;
            contact.cells.iter().for_each(|&k| self.search.direction[k as usize] = scale * z[k as usize]);
            change.leaving.iter().for_each(|&k| self.search.direction[k as usize] = -solution.pressure[k as usize]);
            if let Some(y) = change.correction {
                let modes = problem.modes(body);
                for k in contact.cells.iter().map(|&k| k as usize) {
                    let p = solution.pressure[k].max(0.0);
                    self.search.direction[k] += modes.balanced(y, k, p, self.shape[k]) - p;
                }
            }
        }
    }

    fn find_direction_upright(&mut self, problem: &Problem<'_>, solution: &mut Solution, length: f64, pending: bool) {
        let change = &self.changes[0];
        self.passes.center(self.residual_mean, &mut self.residual, &mut self.preconditioned);
        self.residual_mean = 0.0;
        for &k in &change.leaving {
            let response = -solution.pressure[k as usize] / (length * self.preconditioner.diagonal());
            self.preconditioned[k as usize] = response;
        }
        self.preconditioner.apply(&mut self.preconditioned);
        solution.counts.preconditioner_applications += 1;

        let [z, z_kd, kd, d] = self.passes.overlaps(&self.preconditioned, &self.search.image, &self.search.direction);
        let share = if problem.modes(0).translates() { 1.0 / self.passes.runs.count().max(1) as f64 } else { 0.0 };
        let beta = conjugate(self.search.energy, z_kd - share * z * kd, pending);
        let scale = if pending { length } else { 1.0 };
        // without a last direction, d holds values of an earlier solve
        let shift = -share * if beta == 0.0 { z } else { z + beta * d };
        self.passes.redirect([scale, beta, shift], &self.preconditioned, &mut self.search.direction);
        for &k in &change.leaving {
            self.search.direction[k as usize] = -solution.pressure[k as usize];
        }
    }

    /// z ← z + β d without free motion on A.
    pub(super) fn conjugate_preconditioned(&mut self, problem: &Problem<'_>, pending: bool) {
        let z = &mut self.preconditioned;
        let mut overlap = 0.0;
        for (body, ContactCells { cells, gram }) in self.set.contacts.iter().enumerate() {
            problem.modes(body).project_out(gram, cells, z);
            overlap += cells.iter().map(|&k| z[k as usize] * self.search.image[k as usize]).sum::<f64>();
        }
        let beta = conjugate(self.search.energy, overlap, pending);
        if beta == 0.0 {
            return;
        }
        for (body, ContactCells { cells, gram }) in self.set.contacts.iter().enumerate() {
            cells.iter().for_each(|&k| z[k as usize] += beta * self.search.direction[k as usize]);
            problem.modes(body).project_out(gram, cells, z);
        }
    }

    /// The length a of the step along d, 1 for a correction. Brings cells that leave to p = 0.
    pub(super) fn step_length(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> f64 {
        let [slope, curvature] = if self.is_upright(problem) {
            self.passes.slope_and_curvature(&self.residual, &self.search.direction, &self.search.image)
        } else {
            self.slope_and_curvature(&self.search.direction, &self.search.image)
        };
        let leaving = self.changes.iter().flat_map(|change| &change.leaving).map(|&k| k as usize);
        self.search.energy = curvature + leaving.map(|k| self.search.direction[k] * self.search.image[k]).sum::<f64>();
        if !self.pending() {
            // a direction that vanishes, as on a single cell, gains nothing
            let downhill = slope > 0.0 && curvature > 0.0;
            return if downhill { slope / (problem.compliance * curvature) } else { 0.0 };
        }
        for change in &mut self.changes {
            change.leaving.drain(..).for_each(|k| solution.pressure[k as usize] = 0.0);
            change.correction = None;
        }
        1.0
    }

    /// Σ r d and Σ d·Kd on the listed cells of A.
    pub(super) fn slope_and_curvature(&self, direction: &[f64], image: &[f64]) -> [f64; 2] {
        let cells = contact_cells::all(&self.set.contacts);
        cells.fold([0.0; 2], |[slope, curvature], k| {
            [slope + self.residual[k] * direction[k], curvature + direction[k] * image[k]]
        })
    }
}

/// β from z·Kd. A correction is not conjugate to the last direction: conjugacy would only spread the error of its length.
fn conjugate(energy: f64, overlap: f64, pending: bool) -> f64 {
    if energy > 0.0 && !pending { -overlap / energy } else { 0.0 }
}
