//! The reference solver of the source paper.

use crate::kernel::Workspace;
use crate::solver::cold_start::{balance, cold_start, list_possible, press_everywhere};
use crate::solver::contact_cells::{self, ContactCells};
use crate::solver::outcome::{Outcome, Stop};
use crate::solver::problem::{Problem, Solution};
use crate::solver::resting_position::RestingPosition;
use crate::solver::rigid_motion::{Freedom, ModeCoefficients, Modes};

/// Relative difference between the pressures and the force that still counts as balanced.
const FORCE_TOLERANCE: f64 = 1e-9;

/// Conjugate gradients on the cells in contact, after Polonsky & Keer (Wear 231, 1999): two
/// convolutions per iteration, one for the gap and one for the step length.
#[derive(Debug, Clone)]
pub(crate) struct PolonskyKeer {
    contacts: Vec<ContactCells>,
    /// −h in contact.
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl PolonskyKeer {
    pub(crate) fn new(cells: usize, bodies: usize) -> PolonskyKeer {
        let field = vec![0.0; cells];
        let contacts = ContactCells::of_bodies(bodies, cells);
        PolonskyKeer { contacts, residual: field.clone(), direction: field.clone(), image: field }
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
            let mut state = contact_cells::fit_motions(problem, &self.contacts, solution, &mut self.residual);
            let penetration = problem.penetration(solution, |k| solution.pressure[k] == 0.0);
            state.note(problem, penetration, 0.0, solution);
            if let Some(outcome) = stop.outcome(solution, || self.carries_the_forces(problem, solution)) {
                return outcome;
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
        for (body, ContactCells { cells, .. }) in self.contacts.iter_mut().enumerate() {
            if problem.released(body) {
                continue;
            }
            let balanced = !cells.is_empty() && balance(problem, body, cells, solution);
            if !balanced && !cold_start(problem, body, cells, solution, |_, _| ()) {
                return Err(body);
            }
        }
        Ok(())
    }

    /// Lists the cells in contact of each body.
    fn list_cells(&mut self, problem: &Problem<'_>, solution: &Solution) {
        let pressed = (0..solution.pressure.len()).filter(|&k| solution.pressure[k] > 0.0);
        contact_cells::list(problem, &mut self.contacts, pressed);
    }

    /// Whether the pressures carry every force: they may not where no balance was found.
    fn carries_the_forces(&self, problem: &Problem<'_>, solution: &Solution) -> bool {
        (0..problem.bodies.len()).all(|body| {
            let freedom = problem.bodies[body];
            let sum: f64 = self.contacts[body].cells.iter().map(|&k| solution.pressure[k as usize]).sum();
            !freedom.translation || (sum - freedom.total).abs() <= FORCE_TOLERANCE * freedom.total
        })
    }

    /// Step length from the image of the direction, less its free motion in contact.
    fn step_length(&mut self, problem: &Problem<'_>, solution: &mut Solution, work: &mut Workspace) -> f64 {
        problem.kernel.apply(&self.direction, &mut self.image, work);
        solution.counts.convolutions += 1;
        let (mut numerator, mut denominator) = (0.0, 0.0);
        for (body, ContactCells { cells, gram }) in self.contacts.iter().enumerate() {
            problem.modes(body).project_out(gram, cells, &mut self.image);
            for k in cells.iter().map(|&k| k as usize) {
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

    /// Advances, clips, presses penetrating cells and restores the balance; returns whether any cell joined the contact.
    fn advance(&mut self, problem: &Problem<'_>, solution: &mut Solution, step: f64) -> bool {
        let mut joined = false;
        for k in 0..problem.gap.len() {
            if solution.pressure[k] > 0.0 {
                solution.pressure[k] = (solution.pressure[k] - step * self.direction[k]).max(0.0);
            } else if problem.possible(k) {
                let depth = problem.depth(solution, k);
                if depth > 0.0 {
                    // a step backwards, along gradients spoiled by rounding, must not press cells with tension
                    solution.pressure[k] = step.max(0.0) * depth;
                    joined = true;
                }
            }
        }
        self.list_cells(problem, solution);
        let loaded = self.contacts.iter_mut().enumerate().filter(|(body, _)| !problem.released(*body));
        for (body, ContactCells { cells, .. }) in loaded {
            let modes = problem.modes(body);
            let balanced = balance(problem, body, cells, solution);
            if modes.translates() {
                if !balanced {
                    press_everywhere(problem, body, cells, solution);
                }
            } else if modes.tilts() && (!balanced || is_unloaded(problem, cells, solution)) {
                // held at its pivot, and touching on one side of it only: unloaded, and turned to where its deepest
                // penetration is least, on both sides of the pivot if it cannot swing clear
                cells.iter().for_each(|&k| solution.pressure[k as usize] = 0.0);
                solution.motions[body] = least_penetrating_tilt(problem, body, cells);
            }
        }
        joined
    }
}

/// Whether there are no pressures, or too small ones to show in the gap.
fn is_unloaded(problem: &Problem<'_>, cells: &[u32], solution: &Solution) -> bool {
    let greatest = |field: &[f64]| cells.iter().map(|&k| field[k as usize].abs()).fold(0.0, f64::max);
    let sunk = problem.compliance * problem.kernel.self_influence() * greatest(&solution.pressure);
    sunk <= f64::EPSILON * greatest(problem.gap)
}

/// The tilt at which a body held at its pivot penetrates the undeformed surface least: where it would rest if it could also
/// move up and down, its load at the pivot. `cells` becomes the list of the cells that it may touch.
fn least_penetrating_tilt(problem: &Problem<'_>, body: usize, cells: &mut Vec<u32>) -> ModeCoefficients {
    let free = Freedom { translation: true, total: 1.0, ..problem.bodies[body] };
    list_possible(problem, body, cells);
    let resting = RestingPosition::new(&Modes::new(problem.kernel.grid(), free), cells, problem.gap);
    let ModeCoefficients([_, tilt1, tilt2]) = resting.motion;
    ModeCoefficients([0.0, tilt1, tilt2])
}
