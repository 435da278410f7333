//! One iteration of the active set: where it stands, where it goes, and how far.

use super::{ActiveSet, CANCELLED, LENGTH};
use crate::solver::passes::{Fields, Survey};
use crate::solver::problem::{Measure, Patch, Problem, Solution};

impl ActiveSet {
    /// p += a d, v += a K d; sets r and the free motions, and takes the sums over A and the deepest penetration outside.
    pub(super) fn advance(&mut self, problem: &Problem<'_>, solution: &mut Solution, a: f64) -> (Measure, f64) {
        if self.is_upright(problem) {
            return self.advance_upright(problem, solution, a);
        }
        if a != 0.0 {
            for k in self.bodies.iter().flat_map(|active| &active.patch.cells).map(|&k| k as usize) {
                solution.pressure[k] += a * self.direction[k];
            }
            for (v, &kd) in solution.potential.iter_mut().zip(&self.image) {
                *v += a * kd;
            }
        }
        let mut state = Measure::default();
        for (body, active) in self.bodies.iter().enumerate() {
            problem.measure(body, &active.patch, solution, &mut self.residual, &mut state);
        }
        (state, problem.penetration(solution, |k| !self.member[k]))
    }

    fn advance_upright(&mut self, problem: &Problem<'_>, solution: &mut Solution, a: f64) -> (Measure, f64) {
        let motion = solution.motions[0].0[0];
        let found = self.passes.survey(
            a,
            problem.compliance,
            motion,
            Fields {
                gap: problem.gap,
                direction: &self.direction,
                image: &self.image,
                pressure: &mut solution.pressure,
                potential: &mut solution.potential,
                residual: &mut self.residual,
            },
        );
        let cells = self.passes.runs.count();
        let count = cells.max(1) as f64;
        self.mean = if problem.modes(0).translates() { found.residual / count } else { 0.0 };
        solution.motions[0].0[0] = motion - self.mean;
        let mut square = found.square - count * self.mean * self.mean;
        // where the motion was far off, the difference is mostly rounding
        if square < CANCELLED * found.square {
            square = self.passes.center(self.mean, &mut self.residual, &mut self.preconditioned);
            self.mean = 0.0;
        }
        let Survey { displacement, negative, .. } = found;
        let state = Measure { square, displacement, negative, height: self.height, cancelled: 0.0, cells };
        (state, (found.depth + solution.motions[0].0[0]).max(0.0))
    }

    /// d ← z + β d without free motion on A; with pressures to bring to zero or into balance, d is the
    /// whole change of p.
    pub(super) fn find_direction(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let (length, pending) = (LENGTH / problem.compliance, self.pending());
        if self.is_upright(problem) {
            return self.find_direction_upright(problem, solution, length, pending);
        }
        let z = &mut self.preconditioned;
        z.fill(0.0);
        for active in &self.bodies {
            active.patch.cells.iter().for_each(|&k| z[k as usize] = self.residual[k as usize]);
            for &k in &active.leaving {
                z[k as usize] = -solution.pressure[k as usize] / (length * self.preconditioner.diagonal());
            }
        }
        self.preconditioner.apply(z);
        solution.counts.preconditioner_applications += 1;

        let mut overlap = 0.0;
        for (body, Patch { cells, gram }) in self.bodies.iter().map(|active| &active.patch).enumerate() {
            problem.modes(body).project_out(gram, cells, z);
            overlap += cells.iter().map(|&k| z[k as usize] * self.image[k as usize]).sum::<f64>();
        }
        let beta = Self::conjugate(self.energy, overlap, pending);
        for (body, Patch { cells, gram }) in self.bodies.iter().map(|active| &active.patch).enumerate() {
            if beta != 0.0 {
                cells.iter().for_each(|&k| z[k as usize] += beta * self.direction[k as usize]);
                problem.modes(body).project_out(gram, cells, z);
            }
        }

        self.direction.fill(0.0);
        let scale = if pending { length } else { 1.0 };
        for (body, active) in self.bodies.iter().enumerate() {
            active.patch.cells.iter().for_each(|&k| self.direction[k as usize] = scale * z[k as usize]);
            active.leaving.iter().for_each(|&k| self.direction[k as usize] = -solution.pressure[k as usize]);
            if let Some(y) = active.correction {
                let modes = problem.modes(body);
                for k in active.patch.cells.iter().map(|&k| k as usize) {
                    let p = solution.pressure[k].max(0.0);
                    self.direction[k] += modes.balanced(y, k, p, self.shape[k]) - p;
                }
            }
        }
    }

    fn find_direction_upright(&mut self, problem: &Problem<'_>, solution: &mut Solution, length: f64, pending: bool) {
        let active = &self.bodies[0];
        self.passes.center(self.mean, &mut self.residual, &mut self.preconditioned);
        self.mean = 0.0;
        for &k in &active.leaving {
            let response = -solution.pressure[k as usize] / (length * self.preconditioner.diagonal());
            self.preconditioned[k as usize] = response;
        }
        self.preconditioner.apply(&mut self.preconditioned);
        solution.counts.preconditioner_applications += 1;

        let [z, z_kd, kd, d] = self.passes.overlaps(&self.preconditioned, &self.image, &self.direction);
        let share = if problem.modes(0).translates() { 1.0 / self.passes.runs.count().max(1) as f64 } else { 0.0 };
        let beta = Self::conjugate(self.energy, z_kd - share * z * kd, pending);
        let scale = if pending { length } else { 1.0 };
        // without a last direction, what is left in its place says nothing
        let shift = -share * if beta == 0.0 { z } else { z + beta * d };
        self.passes.redirect([scale, beta, shift], &self.preconditioned, &mut self.direction);
        for &k in &active.leaving {
            self.direction[k as usize] = -solution.pressure[k as usize];
        }
    }

    /// β from z·Kd. A correction is no conjugate direction, and would only spread the error of its length.
    pub(super) fn conjugate(energy: f64, overlap: f64, pending: bool) -> f64 {
        if energy > 0.0 && !pending { -overlap / energy } else { 0.0 }
    }

    /// The length a of the step along d, 1 for a correction. Brings cells that leave to p = 0.
    pub(super) fn step_length(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> f64 {
        let [slope, curvature] = if self.is_upright(problem) {
            self.passes.slope_and_curvature(&self.residual, &self.direction, &self.image)
        } else {
            let cells = self.bodies.iter().flat_map(|active| &active.patch.cells).map(|&k| k as usize);
            cells.fold([0.0; 2], |[slope, curvature], k| {
                let d = self.direction[k];
                [slope + self.residual[k] * d, curvature + d * self.image[k]]
            })
        };
        let leaving = self.bodies.iter().flat_map(|active| &active.leaving).map(|&k| k as usize);
        self.energy = curvature + leaving.map(|k| self.direction[k] * self.image[k]).sum::<f64>();
        if !self.pending() {
            // nothing is left to gain along a direction that vanishes, as on a single cell
            let downhill = slope > 0.0 && curvature > 0.0;
            return if downhill { slope / (problem.compliance * curvature) } else { 0.0 };
        }
        for active in &mut self.bodies {
            active.leaving.iter().for_each(|&k| solution.pressure[k as usize] = 0.0);
            active.leaving.clear();
            active.correction = None;
        }
        1.0
    }
}
