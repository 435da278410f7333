//! The reference solver of the source paper.

use crate::kernel::Workspace;
use crate::solver::cold_start::{balance, cold_start, press_everywhere};
use crate::solver::problem::{Measure, Outcome, Patch, Problem, Solution, Stop, relative_residual};
use crate::solver::rest::rest;
use crate::solver::rigid_motion::{Freedom, ModeCoefficients, Modes};

/// Conjugate gradients on the cells in contact, after Polonsky & Keer (Wear 231, 1999): two
/// convolutions an iteration, one for the gap and one for the step length.
#[derive(Debug, Clone)]
pub(crate) struct PolonskyKeer {
    patches: Vec<Patch>,
    /// −h in contact.
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl PolonskyKeer {
    pub(crate) fn new(cells: usize, bodies: usize) -> PolonskyKeer {
        let field = vec![0.0; cells];
        let patch = Patch { cells: Vec::with_capacity(cells), ..Patch::default() };
        PolonskyKeer { patches: vec![patch; bodies], residual: field.clone(), direction: field.clone(), image: field }
    }

    /// Improves `solution` until its residual is below the tolerance or the iterations are spent.
    pub(crate) fn solve(
        &mut self,
        problem: &Problem<'_>,
        stop: Stop,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Outcome {
        if let Err(body) = self.make_feasible(problem, solution) {
            return Outcome::Unbalanced(body);
        }
        self.direction.fill(0.0);
        let (mut square_old, mut conjugate) = (1.0, false);
        loop {
            solution.convolve(problem, work);
            self.list_cells(problem, solution);
            let mut state = Measure::default();
            for (body, patch) in self.patches.iter().enumerate() {
                problem.measure(body, patch, solution, &mut self.residual, &mut state);
            }
            let penetration = problem.penetration(solution, |k| solution.pressure[k] == 0.0);
            state.cancelled = problem.rounding(&solution.pressure);
            solution.residual = relative_residual(&state, penetration);
            solution.rounding = state.relative_rounding();
            solution.trace.note(solution.counts.iterations, solution.residual);
            if solution.residual <= stop.tolerance && self.carries_the_forces(problem, solution) {
                return Outcome::Converged;
            }
            if solution.residual.is_nan() {
                return Outcome::NotANumber;
            }
            if solution.counts.iterations >= stop.max_iterations {
                return Outcome::OutOfIterations;
            }
            solution.counts.iterations += 1;

            // t = h + δ G/G_old t in contact
            let beta = if conjugate && square_old > 0.0 { state.square / square_old } else { 0.0 };
            square_old = state.square;
            for (k, t) in self.direction.iter_mut().enumerate() {
                *t = if solution.pressure[k] > 0.0 { -self.residual[k] + beta * *t } else { 0.0 };
            }
            let step = self.step_length(problem, solution, work);
            conjugate = !self.advance(problem, solution, step);
        }
    }

    /// Clips a guess to p ≥ 0 where there is something to touch, and brings it into balance.
    fn make_feasible(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> Result<(), usize> {
        for k in 0..problem.gap.len() {
            let p = &mut solution.pressure[k];
            *p = if problem.possible(k) { p.max(0.0) } else { 0.0 };
        }
        self.list_cells(problem, solution);
        for (body, patch) in self.patches.iter_mut().enumerate() {
            if problem.released(body) {
                continue;
            }
            let balanced = !patch.cells.is_empty() && balance(problem, body, &patch.cells, solution);
            if !balanced && !cold_start(problem, body, patch, solution, |_, _| ()) {
                return Err(body);
            }
        }
        Ok(())
    }

    /// Lists the cells in contact of each body.
    fn list_cells(&mut self, problem: &Problem<'_>, solution: &Solution) {
        self.patches.iter_mut().for_each(|patch| patch.cells.clear());
        for (k, _) in solution.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            self.patches[problem.owner(k)].cells.push(k as u32);
        }
        for (body, patch) in self.patches.iter_mut().enumerate() {
            patch.gram = problem.modes(body).gram(&patch.cells);
        }
    }

    /// Whether every force is carried: a balance that could not be found leaves it open.
    fn carries_the_forces(&self, problem: &Problem<'_>, solution: &Solution) -> bool {
        (0..problem.bodies.len()).all(|body| {
            let freedom = problem.bodies[body];
            let sum: f64 = self.patches[body].cells.iter().map(|&k| solution.pressure[k as usize]).sum();
            !freedom.translation || (sum - freedom.total).abs() <= 1e-9 * freedom.total
        })
    }

    /// Step length from the image of the direction, less its free motion in contact.
    fn step_length(&mut self, problem: &Problem<'_>, solution: &mut Solution, work: &mut Workspace) -> f64 {
        problem.kernel.apply(&self.direction, &mut self.image, work);
        solution.counts.convolutions += 1;
        let (mut numerator, mut denominator) = (0.0, 0.0);
        for (body, patch) in self.patches.iter().enumerate() {
            problem.modes(body).project_out(&patch.gram, &patch.cells, &mut self.image);
            for &k in &patch.cells {
                let k = k as usize;
                numerator -= self.residual[k] * self.direction[k];
                denominator += self.direction[k] * self.image[k];
            }
        }
        if denominator > 0.0 {
            return numerator / (problem.compliance * denominator);
        }
        // too few cells to have a direction: the inverse of a cell's influence on itself
        1.0 / (problem.compliance * problem.kernel.self_influence())
    }

    /// Advances, clips, lets penetrating cells in and restores the balance; tells whether any came in.
    fn advance(&mut self, problem: &Problem<'_>, solution: &mut Solution, step: f64) -> bool {
        let mut entered = false;
        for k in 0..problem.gap.len() {
            if solution.pressure[k] > 0.0 {
                solution.pressure[k] = (solution.pressure[k] - step * self.direction[k]).max(0.0);
            } else if problem.possible(k) {
                let depth = problem.depth(solution, k);
                if depth > 0.0 {
                    // a step backwards, of gradients that have lost their way, lets none in that pulls
                    solution.pressure[k] = step.max(0.0) * depth;
                    entered = true;
                }
            }
        }
        self.list_cells(problem, solution);
        for (body, patch) in self.patches.iter_mut().enumerate().filter(|(body, _)| !problem.released(*body)) {
            let modes = problem.modes(body);
            let balanced = balance(problem, body, &patch.cells, solution);
            if modes.translates() {
                if !balanced {
                    press_everywhere(problem, body, patch, solution);
                }
            } else if modes.tilts() && (!balanced || is_unloaded(problem, &patch.cells, solution)) {
                // held at its pivot, and touching on one side of it only: unloaded, and turned to where its deepest
                // penetration is least, on both sides of the pivot if it cannot swing clear
                patch.cells.iter().for_each(|&k| solution.pressure[k as usize] = 0.0);
                solution.motions[body] = turned(problem, body);
            }
        }
        entered
    }
}

/// Whether pressures are none, or too small to show in the gap.
fn is_unloaded(problem: &Problem<'_>, cells: &[u32], solution: &Solution) -> bool {
    let greatest = |field: &[f64]| cells.iter().map(|&k| field[k as usize].abs()).fold(0.0, f64::max);
    let sunk = problem.compliance * problem.kernel.self_influence() * greatest(&solution.pressure);
    sunk <= f64::EPSILON * greatest(problem.gap)
}

/// The tilt at which a body held at its pivot penetrates the undeformed surface least: where it would rest if it could also
/// move up and down, its load at the pivot.
fn turned(problem: &Problem<'_>, body: usize) -> ModeCoefficients {
    let free = Freedom { translation: true, total: 1.0, ..problem.bodies[body] };
    let cells: Vec<u32> = (0..problem.gap.len() as u32)
        .filter(|&k| problem.owner(k as usize) == body && problem.possible(k as usize))
        .collect();
    let (ModeCoefficients([_, alpha1, alpha2]), _) =
        rest(&Modes::new(problem.kernel.grid(), free), &cells, problem.gap);
    ModeCoefficients([0.0, alpha1, alpha2])
}
