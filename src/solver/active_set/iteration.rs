//! One iteration of the active set: its residual, its direction and its length.

use super::{ActiveSet, RULES};
use crate::solver::{ModeCoefficients, Outcome, Problem, ResidualSums, Solution, Solve, add, dot};

/// The vector z of a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Towards {
    /// P Eᵀ M E P r.
    Preconditioned,
    /// r itself.
    Residual,
    /// Zero: the residual is below the tolerance, and the direction makes the changes of the pressure alone. A z
    /// without a line search could increase it again.
    Corrections,
}

impl ActiveSet {
    /// Iterates from a guess until the solve ends, or stagnates. Fails with the body whose load no pressure can
    /// balance.
    pub(super) fn iterate(&mut self, solve: &mut Solve<'_>) -> Result<Outcome, usize> {
        let (problem, stop) = (solve.problem, solve.stop);
        self.start(solve)?;
        let (mut lowest, mut without_gain, mut step, mut searched) = (f64::INFINITY, 0, 0.0, 0.0);
        loop {
            let mut state = self.advance(problem, solve.solution, step);
            let aggressive = without_gain <= RULES.tries_without_gain || searched != 0.0 || step == 0.0;
            if state.negative > 0.0 && self.should_remove_tensile(problem, stop, state, aggressive) {
                self.remove_tensile_cells(searched, solve)?;
                state = self.advance(problem, solve.solution, 0.0);
            }
            state.note(problem, self.guess_rounding, solve.solution);
            let mut ended = stop.outcome(solve.solution, || !self.changes.any() && state.negative == 0.0);
            let tensile = || !solve.solution.pressure.iter().all(|&p| p >= 0.0);
            if ended == Some(Outcome::Converged) && problem.rows().any(tensile()) {
                // tiny tensile pressures, whose squares vanish, still violate p ≥ 0
                self.remove_tensile_cells(searched, solve)?;
                state = self.advance(problem, solve.solution, 0.0);
                ended = stop.outcome(solve.solution, || false);
            }
            if let Some(outcome) = ended {
                return Ok(outcome);
            }
            without_gain = if solve.solution.residual < lowest { 0 } else { without_gain + 1 };
            lowest = lowest.min(solve.solution.residual);
            if without_gain > RULES.iterations_without_gain {
                return Ok(Outcome::Stagnated);
            }
            // do not test the predicted set at iteration 0: it has no pressure yet
            let predicted = problem.likely.is_some() && solve.solution.counts.iterations == 0;
            // only small pressures that leave remain to be removed
            let solved = solve.solution.residual <= stop.tolerance && self.changes.any();
            if state.penetration > RULES.join_over_rms * state.rms() && !predicted && !solved {
                let was_cut = std::mem::take(&mut self.was_cut);
                // the deepest cells alone
                let least = if was_cut { 0.999 * state.penetration } else { state.joining_depth() };
                self.add_penetrating_cells(problem, least, solve.solution);
                self.advance(problem, solve.solution, 0.0);
            }

            solve.solution.counts.iterations += 1;
            let corrects = self.changes.any();
            let towards = if solved { Towards::Corrections } else { Towards::Preconditioned };
            self.find_direction(towards, solve);
            self.search.convolve(solve);
            step = self.step_length(problem, solve.solution);
            searched = if corrects { 0.0 } else { step };
        }
    }

    /// p += a d, v += a K d; fits the free motions, and returns the sums over A and the deepest penetration outside.
    pub(super) fn advance(&mut self, problem: &Problem<'_>, solution: &mut Solution, a: f64) -> ResidualSums {
        if a != 0.0 {
            // r had no motion on A before the step: the motion that K d adds is known, but for rounding
            for (motion, &image) in solution.motions.iter_mut().zip(&self.image_motions) {
                *motion = motion.plus(a * problem.compliance, image);
            }
        }
        let mut state = ResidualSums::of(&self.set);
        let (mut square, mut turned) = (0.0, 0.0_f64);
        let found = self.set.passes(problem, &mut self.bands).survey(a, &self.search, solution);
        for (body, found) in found.iter().enumerate() {
            // The fit determines a change of the last motion: a motion that the cells do not determine remains as it
            // was.
            let fit = self.set.fit(problem, body, found.residual_modes);
            solution.motions[body] = solution.motions[body].plus(-1.0, fit);
            let tilts = problem.bodies[body].tilts();
            // of a body that tilts, no cell moves more than this
            let moved = if tilts { fit.0.iter().map(|y| y.abs()).sum() } else { -fit.0[0] };
            square += found.residual_square;
            state.square += found.residual_square - dot(fit.0, found.residual_modes);
            state.displacement += found.displacement_square;
            state.negative += found.negative_square;
            state.deepest = state.deepest.max(found.peak + moved);
            turned = turned.max(if tilts { moved } else { 0.0 });
            state.penetration = state.penetration.max(found.penetration + if tilts { 0.0 } else { moved });
        }
        // where a motion was far off, the difference is mostly rounding
        if state.square < 1e-6 * square {
            [state.square, state.deepest] = self.find_residual(problem, solution);
        }
        // the penetration was found at a motion of a tilting body that has changed since
        if turned > 1e-6 * state.rms() {
            state.penetration = self.set.passes(problem, &mut self.bands).penetration(solution);
            [_, state.deepest] = self.find_residual(problem, solution);
        }
        state
    }

    /// Writes r on A, zero elsewhere, to the buffer; returns Σ r² and the largest r.
    fn find_residual(&mut self, problem: &Problem<'_>, solution: &Solution) -> [f64; 2] {
        self.set.passes(problem, &mut self.bands).residual(solution, &mut self.buffer)
    }

    /// d ← z + β d without free motion on A; with pressures to bring to zero or into balance, d is the whole change
    /// of p.
    pub(super) fn find_direction(&mut self, towards: Towards, solve: &mut Solve<'_>) {
        let Solve { problem, solution, work, .. } = solve;
        // no longer than the last search: where M is too great an inverse, a longer one would not lower the residual
        let length = RULES.correction_length.min(self.search_length) / problem.compliance;
        let pending = self.changes.any();
        if towards != Towards::Corrections {
            self.find_residual(problem, solution);
        }
        let ActiveSet { set, bands, preconditioner, buffer: z, search, shifts, .. } = self;
        match towards {
            Towards::Corrections => z.fill(0.0),
            Towards::Residual => {}
            Towards::Preconditioned => {
                preconditioner.apply(z, set, work);
                solution.counts.preconditioner_applications += 1;
            }
        }
        let mut overlap = 0.0;
        let found = set.passes(problem, bands).overlaps(z, search);
        for (body, found) in found.iter().enumerate() {
            let fit = set.fit(problem, body, found.residual_modes);
            shifts[body] = ModeCoefficients::default().plus(-1.0, fit);
            overlap += found.residual_image - dot(fit.0, found.image_modes);
        }
        // β from z·Kd + β d·Kd = 0. A correction is not conjugate to the last direction: conjugacy would only spread
        // the error of its length.
        let beta = if self.energy > 0.0 && !pending { -overlap / self.energy } else { 0.0 };
        // without a last direction, d holds values of an earlier solve
        if beta != 0.0 {
            for (body, found) in found.iter().enumerate() {
                shifts[body] = shifts[body].plus(-beta, set.fit(problem, body, found.direction_modes));
            }
        }
        let scale = if pending { length } else { 1.0 };
        set.passes(problem, bands).redirect(scale, beta, shifts, z, &mut search.direction);
        if pending {
            self.correct_direction(problem, &solution.pressure);
        }
    }

    /// Adds the pending changes to the direction: pressures that leave are brought to zero and moved to the cells
    /// around, and the pressure after the step is balanced.
    fn correct_direction(&mut self, problem: &Problem<'_>, p: &[f64]) {
        let ActiveSet { set, bands, preconditioner, buffer: moved, shape, changes, .. } = self;
        let (direction, balances) = (&mut self.search.direction, &mut self.shifts);
        if changes.moves {
            preconditioner.gather_outside(p, set, moved);
            add(direction, 1.0, moved);
        }
        if changes.leaving {
            set.segments.outside(p.len()).for_each(|cells| {
                direction[cells.clone()].iter_mut().zip(&p[cells]).for_each(|(d, &p)| *d = -p);
            });
        }
        let corrections = &mut changes.corrections;
        if corrections.iter().all(Option::is_none) {
            return;
        }
        let mut bodies = corrections.iter().zip(balances.iter_mut()).enumerate();
        let whole = bodies.all(|(body, (correction, balance))| {
            let next = |k: usize| p[k] + direction[k];
            let found = correction.and_then(|_| set.balance(problem, body, next, |k| shape[k]));
            *balance = found.unwrap_or_default();
            found.is_some() == correction.is_some()
        });
        if whole {
            let corrections = corrections.iter_mut().zip(balances);
            corrections.for_each(|(correction, y)| *correction = correction.map(|_| *y));
        } else if changes.moves {
            // the pressure that leaves is dropped: the balance of the rest is known
            set.segments.cells().for_each(|k| direction[k] -= moved[k]);
        }
        set.passes(problem, bands).correct(corrections, whole, [p, shape], direction);
    }

    /// The length a of the step along d, 1 for a correction. Brings cells that leave to p = 0.
    fn step_length(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> f64 {
        let [slope, curvature] = self.slope_and_curvature(problem, solution);
        if !self.changes.any() {
            self.energy = curvature;
            // the product of small ones may vanish
            let product = problem.compliance * curvature;
            let length = if product > 0.0 { slope / product } else { slope / curvature / problem.compliance };
            // a direction that vanishes, as on a single cell, gains nothing
            if !(slope > 0.0 && curvature > 0.0 && length.is_finite()) {
                return 0.0;
            }
            self.search_length = length * problem.compliance;
            return length;
        }
        // no later direction is conjugate to a correction, which has no line search
        self.energy = 0.0;
        if self.changes.leaving {
            self.set.segments.outside(solution.pressure.len()).for_each(|cells| solution.pressure[cells].fill(0.0));
        }
        self.changes.clear();
        1.0
    }

    /// Σ r d and Σ d·Kd on A; notes how K d moves the bodies that tilt.
    pub(super) fn slope_and_curvature(&mut self, problem: &Problem<'_>, solution: &Solution) -> [f64; 2] {
        let found = self.set.passes(problem, &mut self.bands).slope_and_curvature(solution, &self.search);
        let mut sums = [0.0; 2];
        for (body, found) in found.iter().enumerate() {
            let tilts = problem.bodies[body].tilts();
            self.image_motions[body] =
                if tilts { self.set.fit(problem, body, found.image_modes) } else { Default::default() };
            sums = [sums[0] + found.residual_direction, sums[1] + found.direction_image];
        }
        sums
    }
}
