//! The reference solver of the source paper.

use crate::kernel::Workspace;
use crate::parallel::Rows;
use crate::solver::bands::Bands;
use crate::solver::cold_start::{balance, cold_start, press_everywhere};
use crate::solver::contact_set::ContactSet;
use crate::solver::outcome::{Outcome, ResidualSums, Stop};
use crate::solver::problem::{Problem, Solution};
use crate::solver::resting_position::RestingPosition;
use crate::solver::rigid_motion::{Freedom, ModeCoefficients, Modes, dot};

/// Relative difference between the pressures and the force that still counts as balanced.
const FORCE_TOLERANCE: f64 = 1e-9;

/// Conjugate gradients on the cells in contact, after Polonsky & Keer (Wear 231, 1999): two
/// convolutions per iteration, one for the gap and one for the step length.
#[derive(Debug, Clone)]
pub(crate) struct PolonskyKeer {
    set: ContactSet,
    bands: Bands,
    /// −h in contact.
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl PolonskyKeer {
    pub(crate) fn new(rows: &Rows, bodies: usize) -> PolonskyKeer {
        let cells = rows.len();
        let field = vec![0.0; cells];
        let (set, bands) = (ContactSet::new(cells, bodies), Bands::new(rows, bodies));
        PolonskyKeer { set, bands, residual: field.clone(), direction: field.clone(), image: field }
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
            self.find_contact(problem, solution);
            let (mut state, penetration) = self.fit_motions(problem, solution);
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
        self.find_contact(problem, solution);
        for body in (0..problem.bodies.len()).filter(|&body| !problem.released(body)) {
            let balanced = self.set.count_under(body) > 0 && balance(problem, body, &self.set, solution);
            if !balanced && !cold_start(problem, body, &mut self.set, solution, |_, _| ()) {
                return Err(body);
            }
        }
        Ok(())
    }

    /// Cells in contact carry pressure.
    fn find_contact(&mut self, problem: &Problem<'_>, solution: &Solution) {
        self.set.member.iter_mut().zip(&solution.pressure).for_each(|(member, &p)| *member = p > 0.0);
        self.set.update(problem);
    }

    /// Sets the free motion of each body to the best fit in contact, and the residual to −h there; returns the sums over it
    /// and the deepest penetration outside.
    fn fit_motions(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> (ResidualSums, f64) {
        let PolonskyKeer { set, bands, residual, direction, image } = self;
        let mut state = ResidualSums { greatest_gap: set.greatest_gap, cells: set.count(), ..ResidualSums::default() };
        for (body, found) in bands.survey(problem, &set.runs, 0.0, [direction, image], solution).iter().enumerate() {
            solution.motions[body] = solution.motions[body].plus(-1.0, set.fit(problem, body, found.residual_modes));
            state.displacement += found.displacement_square;
            state.negative += found.negative_square;
        }
        [state.square, state.deepest] = bands.residual(problem, &set.runs, solution, residual);
        (state, bands.penetration(problem, &set.runs, solution))
    }

    /// Whether the pressures carry every force: they may not where no balance was found.
    fn carries_the_forces(&self, problem: &Problem<'_>, solution: &Solution) -> bool {
        (0..problem.bodies.len()).all(|body| {
            let freedom = problem.bodies[body];
            let sum = self.set.sum(problem, body, &solution.pressure);
            !freedom.translation || (sum - freedom.total).abs() <= FORCE_TOLERANCE * freedom.total
        })
    }

    /// Step length from the image of the direction, less its free motion in contact.
    fn step_length(&mut self, problem: &Problem<'_>, solution: &mut Solution, work: &mut Workspace) -> f64 {
        problem.kernel.apply(&self.direction, &mut self.image, work);
        solution.counts.convolutions += 1;
        let PolonskyKeer { set, bands, residual, direction, image, .. } = self;
        let (mut numerator, mut denominator) = (0.0, 0.0);
        for found in bands.slope_and_curvature(problem, &set.runs, solution, [direction, image]) {
            numerator -= found.residual_direction;
            denominator += found.direction_image;
        }
        for (body, found) in bands.overlaps(problem, &set.runs, residual, [direction, image]).iter().enumerate() {
            let fit = set.fit(problem, body, found.image_modes);
            denominator -= dot(fit.0, found.direction_modes);
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
        self.find_contact(problem, solution);
        for body in (0..problem.bodies.len()).filter(|&body| !problem.released(body)) {
            let modes = problem.modes(body);
            let balanced = balance(problem, body, &self.set, solution);
            if modes.translates() {
                if !balanced {
                    press_everywhere(problem, body, &mut self.set, solution);
                }
            } else if modes.tilts() && (!balanced || self.is_unloaded(problem, body, solution)) {
                // held at its pivot, and touching on one side of it only: unloaded, and turned to where its deepest
                // penetration is least, on both sides of the pivot if it cannot swing clear
                self.set.cells(problem, body).for_each(|k| solution.pressure[k] = 0.0);
                self.set.press_possible(problem, body);
                solution.motions[body] = least_penetrating_tilt(problem, body, &self.set);
            }
        }
        joined
    }

    /// Whether there are no pressures under a body, or too small ones to show in the gap.
    fn is_unloaded(&self, problem: &Problem<'_>, body: usize, solution: &Solution) -> bool {
        let greatest = |field: &[f64]| self.set.cells(problem, body).map(|k| field[k].abs()).fold(0.0, f64::max);
        let sunk = problem.compliance * problem.kernel.self_influence() * greatest(&solution.pressure);
        sunk <= f64::EPSILON * greatest(problem.gap)
    }
}

/// The tilt at which a body held at its pivot penetrates the undeformed surface least: where it would rest if it could also
/// move up and down, its load at the pivot. `set` contains all cells that it may touch.
fn least_penetrating_tilt(problem: &Problem<'_>, body: usize, set: &ContactSet) -> ModeCoefficients {
    let free = Freedom { translation: true, total: 1.0, ..problem.bodies[body] };
    let modes = Modes::new(problem.kernel.grid(), problem.rows(), free);
    let resting = RestingPosition::new(problem.rows(), &modes, set.cells(problem, body), problem.gap);
    let ModeCoefficients([_, tilt1, tilt2]) = resting.motion;
    ModeCoefficients([0.0, tilt1, tilt2])
}
