//! The reference solver of the source paper.

use super::{
    Bands, ContactSet, Freedom, ModeCoefficients, Modes, Outcome, Problem, ResidualSums, RestingPosition, Search,
    Solution, Solve, balance, dot, make_feasible, press_everywhere,
};
use crate::parallel::Rows;

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
    search: Search,
}

impl PolonskyKeer {
    pub(crate) fn new(rows: &Rows, bodies: usize) -> PolonskyKeer {
        let cells = rows.len();
        let (set, bands) = (ContactSet::new(cells, bodies), Bands::new(rows, bodies));
        PolonskyKeer { set, bands, residual: vec![0.0; cells], search: Search::new(cells) }
    }

    /// Improves `solution` until its residual is below the tolerance or the iterations are spent.
    pub(crate) fn solve(&mut self, solve: &mut Solve<'_>) -> Outcome {
        let (problem, stop) = (solve.problem, solve.stop);
        if let Err(body) = make_feasible(problem, &mut self.set, solve.solution) {
            return Outcome::Unbalanced(body);
        }
        self.search.direction.fill(0.0);
        let (mut square_old, mut conjugate) = (1.0, false);
        loop {
            solve.convolve();
            let solution = &mut *solve.solution;
            self.set.find_pressed(problem, &solution.pressure);
            let mut state = self.fit_motions(problem, solution);
            state.note(problem, 0.0, solution);
            if let Some(outcome) = stop.outcome(solution, || self.carries_the_forces(problem, solution)) {
                return outcome;
            }
            solution.counts.iterations += 1;

            // t = h + δ G/G_old t in contact
            let beta = if conjugate && square_old > 0.0 { state.square / square_old } else { 0.0 };
            square_old = state.square;
            for (k, t) in self.search.direction.iter_mut().enumerate() {
                *t = if solution.pressure[k] > 0.0 { -self.residual[k] + beta * *t } else { 0.0 };
            }
            let step = self.step_length(solve);
            conjugate = !self.advance(problem, solve.solution, step);
        }
    }

    /// Sets the free motion of each body to the best fit in contact, and the residual to −h there; returns the sums
    /// over it and the deepest penetration outside.
    fn fit_motions(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> ResidualSums {
        let PolonskyKeer { set, bands, residual, search } = self;
        let mut state = ResidualSums::of(set);
        for (body, found) in set.passes(problem, bands).survey(0.0, search, solution).iter().enumerate() {
            solution.motions[body] = solution.motions[body].plus(-1.0, set.fit(problem, body, found.residual_modes));
            state.displacement += found.displacement_square;
            state.negative += found.negative_square;
        }
        [state.square, state.deepest] = set.passes(problem, bands).residual(solution, residual);
        state.penetration = set.passes(problem, bands).penetration(solution);
        state
    }

    /// Whether the pressures carry every force; false where no balance was found.
    fn carries_the_forces(&self, problem: &Problem<'_>, solution: &Solution) -> bool {
        (0..problem.bodies.len()).all(|body| {
            let freedom = problem.bodies[body];
            let sum = self.set.sum(problem, body, &solution.pressure);
            !freedom.translation || (sum - freedom.total).abs() <= FORCE_TOLERANCE * freedom.total
        })
    }

    /// Step length from the image of the direction, less its free motion in contact.
    fn step_length(&mut self, solve: &mut Solve<'_>) -> f64 {
        self.search.convolve(solve);
        let Solve { problem, solution, .. } = solve;
        let PolonskyKeer { set, bands, residual, search } = self;
        let (mut numerator, mut denominator) = (0.0, 0.0);
        for found in set.passes(problem, bands).slope_and_curvature(solution, search) {
            numerator -= found.residual_direction;
            denominator += found.direction_image;
        }
        for (body, found) in set.passes(problem, bands).overlaps(residual, search).iter().enumerate() {
            let fit = set.fit(problem, body, found.image_modes);
            denominator -= dot(fit.0, found.direction_modes);
        }
        if denominator > 0.0 {
            return numerator / (problem.compliance * denominator);
        }
        // too few cells to have a direction: the inverse of a cell's influence on itself
        1.0 / (problem.compliance * problem.kernel.whole.self_influence())
    }

    /// Advances, clips, presses penetrating cells and restores the balance; returns whether any cell joined the
    /// contact.
    fn advance(&mut self, problem: &Problem<'_>, solution: &mut Solution, step: f64) -> bool {
        let mut joined = false;
        for k in 0..problem.gap.len() {
            if solution.pressure[k] > 0.0 {
                solution.pressure[k] = (solution.pressure[k] - step * self.search.direction[k]).max(0.0);
            } else if problem.possible(k) {
                let depth = problem.depth(solution, k);
                if depth > 0.0 {
                    // a step backwards, along gradients spoiled by rounding, must not press cells with tension
                    solution.pressure[k] = step.max(0.0) * depth;
                    joined = true;
                }
            }
        }
        self.set.find_pressed(problem, &solution.pressure);
        for body in problem.loaded_bodies() {
            let modes = problem.modes(body);
            let balanced = balance(problem, body, &self.set, solution);
            if modes.freedom.translation {
                if !balanced {
                    press_everywhere(problem, body, &mut self.set, solution);
                }
            } else if modes.freedom.tilts() && (!balanced || self.is_unloaded(problem, body, solution)) {
                // the body is held at its pivot, and touches on one side of it only: it is unloaded, and turned to
                // where its deepest penetration is least, on both sides of the pivot if it cannot swing clear
                self.set.cells(problem, body).for_each(|k| solution.pressure[k] = 0.0);
                self.set.press_possible(problem, body);
                solution.motions[body] = least_penetrating_tilt(problem, body, &self.set);
            }
        }
        joined
    }

    /// Whether a body carries no pressure, or too little to change the gap.
    fn is_unloaded(&self, problem: &Problem<'_>, body: usize, solution: &Solution) -> bool {
        let greatest = |field: &[f64]| self.set.cells(problem, body).map(|k| field[k].abs()).fold(0.0, f64::max);
        let sunk = problem.compliance * problem.kernel.whole.self_influence() * greatest(&solution.pressure);
        sunk <= f64::EPSILON * greatest(problem.gap)
    }
}

/// The tilt at which a body held at its pivot penetrates the undeformed surface least: where it would rest if it
/// could also move up and down, its load at the pivot. `set` contains all cells that it may touch.
fn least_penetrating_tilt(problem: &Problem<'_>, body: usize, set: &ContactSet) -> ModeCoefficients {
    let free = Freedom { translation: true, total: 1.0, ..problem.bodies[body] };
    let modes = Modes::new(problem.kernel.grid(), problem.rows(), free);
    let resting = RestingPosition::new(problem, &modes, set, body);
    let ModeCoefficients([_, tilt1, tilt2]) = resting.motion;
    ModeCoefficients([0.0, tilt1, tilt2])
}
