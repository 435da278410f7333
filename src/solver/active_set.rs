//! The default solver: an active set of cells in contact, and preconditioned conjugate gradients on it.
//!
//! On the set A of cells in contact the problem is linear: r = −(c v + gap − motion) = 0, with the free
//! motion of each body fitted by least squares, and force and moments fixed. One iteration is
//!
//! z = P M P r,  d = z + β d,  p += a d,  v += a K d
//!
//! with M ≈ K⁻¹ ([`Preconditioner`]), P the restriction to A less the free motions, β from conjugacy
//! z·Kd + β d·Kd = 0 (which stays exact when cells join A) and a the exact minimum along d.
//!
//! An iteration costs one convolution, whatever happens to A:
//!
//! * Cells that penetrate join with p = 0, which changes no field. They do so when the penetration
//!   stands out of the residual ([`JOIN`]).
//! * Cells whose pressure turned negative leave when their error does ([`EVICT`]). The *next* direction
//!   brings them to p = 0: it contains δ = −p on them, so that the convolution it needs anyway repairs v.
//!   Its length is then 1, and the rest of it is z with the usual length ([`LENGTH`]). The response of the
//!   other cells to δ is M δ/m, m the diagonal of M (by block inversion −K_AA⁻¹ K_AN = M_AN M_NN⁻¹), and
//!   rides on the same application of M.
//! * Less pressure on A is less force; scaling p and v together restores it. With moments to balance, or
//!   several bodies, the factor 1 + B y differs from cell to cell, and joins the next direction too.
//! * A guess extrapolated from earlier steps brings its own v along.
//!
//! Measured on a creeping Maxwell sphere (256², 100 steps, convolution equivalents a step, residual
//! 1e-6 / 1e-4): 8.9 / 5.2 when cells leave and join at once, 7.6 / 4.1 with [`JOIN`], 6.8 / 3.6 with
//! [`EVICT`] too, 5.9 / 3.1 with the response to δ, 5.3 / 2.9 without conjugacy in corrections, 5.1 / 2.5
//! when only the [`DEEP`] ones join.

mod descent;
mod search;

use crate::kernel::{LocalKernel, Workspace};
use crate::solver::cold_start::{balance, cold_start, press_everywhere};
use crate::solver::passes::Passes;
use crate::solver::preconditioner::Preconditioner;
use crate::solver::problem::{Measure, Outcome, PENETRATION_SLACK, Patch, Problem, Solution, Stop, relative_residual};
use crate::solver::rigid_motion::ModeCoefficients;
use crate::sum::greatest;

/// Cells join A when the deepest penetration exceeds this many times rms |r|. It must be below the
/// slack that the residual grants to penetration, or a state could neither improve nor pass.
const JOIN: f64 = 0.4 * PENETRATION_SLACK;

/// Of the penetrating cells, those join that are deeper than this fraction of the deepest: the shallowest,
/// on the rim of a growing contact, would mostly leave again.
const DEEP: f64 = 0.2;

/// Cells leave A when rms (c p⁻/m), the gap that their negative pressure is worth, exceeds this
/// fraction of rms |r|.
const EVICT: f64 = 0.4;

/// c a of a direction that corrects the pressure, taken for the line search it cannot have. Searches along
/// plain z = P M P r, with M ≈ K⁻¹, end between 0.4 and 0.8; measured best of 0.4 … 0.8.
const LENGTH: f64 = 0.5;

/// Change of the force by which a converged pressure may be closed.
const CLOSED: f64 = 1e-9;

/// Σ (r − mean)² is not taken from Σ r² where less than this part of it is left.
const CANCELLED: f64 = 1e-6;

/// Iterations without a new lowest residual after which the fall-back takes over for a while.
const PATIENCE: usize = 40;

#[derive(Debug, Clone)]
pub(crate) struct ActiveSet {
    preconditioner: Preconditioner,
    /// Whether a cell is in A.
    member: Vec<bool>,
    /// The pieces of rows that A consists of, and the passes over them.
    passes: Passes,
    /// The greatest |gap| there.
    height: f64,
    /// What c K p is rounded by, having been that of the guess: where an approach is given, it may fall to nothing.
    begun: f64,
    bodies: Vec<ActiveBody>,
    /// r on A.
    residual: Vec<f64>,
    /// What is still to be taken from it: its mean, by which the motion was corrected.
    mean: f64,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    /// K d, and d·Kd.
    image: Vec<f64>,
    energy: f64,
    /// What corrections of the balance are shaped like; made at the first load that tilts.
    shape: Vec<f64>,
}

/// The part of the active set under one body.
#[derive(Debug, Clone)]
struct ActiveBody {
    patch: Patch,
    /// Cells outside A whose pressure the next direction brings to zero.
    leaving: Vec<u32>,
    /// The y of the change shape · B y by which the next direction balances the pressure.
    correction: Option<ModeCoefficients>,
}

/// What a correction of the balance is shaped like.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// The pressure itself: right for a load that changes as a whole.
    Pressure,
    /// The pressure under a flat punch with the face A, M 1: little of its displacement is not rigid.
    Punch,
}

impl ActiveSet {
    pub(crate) fn new(kernel: &LocalKernel, bodies: usize) -> ActiveSet {
        let grid = kernel.grid();
        let field = vec![0.0; grid.len()];
        let cells = || Vec::with_capacity(grid.len());
        let body =
            |_| ActiveBody { patch: Patch { cells: cells(), ..Patch::default() }, leaving: cells(), correction: None };
        ActiveSet {
            preconditioner: Preconditioner::new(kernel),
            member: vec![false; grid.len()],
            passes: Passes::new(grid.len()),
            height: 0.0,
            begun: 0.0,
            energy: 0.0,
            mean: 0.0,
            bodies: (0..bodies).map(body).collect(),
            residual: field.clone(),
            preconditioned: field.clone(),
            direction: field.clone(),
            image: field,
            shape: Vec::new(),
        }
    }

    /// Improves `solution` until its residual is below the tolerance or the iterations are spent. On
    /// entry `solution.potential` is K p of the guess, whose pressure may be negative on some cells; a body
    /// without any positive pressure gets a cold start.
    pub(crate) fn solve(
        &mut self,
        problem: &Problem<'_>,
        stop: Stop,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Outcome {
        let given = problem.bodies.iter().any(|freedom| !freedom.translation);
        let most = if given { greatest(&solution.potential) } else { 0.0 };
        self.begun = 4.0 * f64::EPSILON * problem.compliance * most;
        let outcome = match self.iterate(problem, stop, solution, work) {
            Outcome::Stagnated => self.descend(problem, stop, solution, work),
            outcome => outcome,
        };
        if outcome != Outcome::Converged || self.close(problem, solution) {
            return outcome;
        }
        // what was taken for a solution does not carry the loads
        match self.descend(problem, stop, solution, work) {
            Outcome::Converged if !self.close(problem, solution) => Outcome::Stagnated,
            outcome => outcome,
        }
    }

    fn iterate(&mut self, problem: &Problem<'_>, stop: Stop, solution: &mut Solution, work: &mut Workspace) -> Outcome {
        if let Err(body) = self.start(problem, solution, work) {
            return Outcome::Unbalanced(body);
        }
        let (mut lowest, mut since, mut step) = (f64::INFINITY, 0, 0.0);
        loop {
            let (mut state, mut penetration) = self.advance(problem, solution, step);
            if state.negative > 0.0 && self.should_evict(problem, stop, state) {
                if let Err(body) = self.evict(problem, solution, work) {
                    return Outcome::Unbalanced(body);
                }
                (state, penetration) = self.advance(problem, solution, 0.0);
            }
            state.cancelled = problem.rounding(&solution.pressure) + self.begun;
            solution.residual = relative_residual(&state, penetration);
            solution.rounding = state.relative_rounding();
            solution.trace.note(solution.counts.iterations, solution.residual);
            let admissible = !self.pending() && state.negative == 0.0;
            if admissible && solution.residual <= stop.tolerance {
                if solution.pressure.iter().all(|&p| p >= 0.0) {
                    return Outcome::Converged;
                }
                // pulls so small that their squares vanish are pulls all the same
                if let Err(body) = self.evict(problem, solution, work) {
                    return Outcome::Unbalanced(body);
                }
                (state, penetration) = self.advance(problem, solution, 0.0);
            }
            if solution.residual.is_nan() {
                return Outcome::NotANumber;
            }
            if solution.counts.iterations >= stop.max_iterations {
                return Outcome::OutOfIterations;
            }
            since = if solution.residual < lowest { 0 } else { since + 1 };
            lowest = lowest.min(solution.residual);
            if since > PATIENCE {
                return Outcome::Stagnated;
            }
            if penetration > JOIN * state.rms() {
                self.join(problem, state, penetration, solution);
                self.advance(problem, solution, 0.0);
            }

            solution.counts.iterations += 1;
            self.find_direction(problem, solution);
            problem.kernel.apply(&self.direction, &mut self.image, work);
            solution.counts.convolutions += 1;
            step = self.step_length(problem, solution);
        }
    }

    /// A = {p > 0}; other cells that carry pressure are to leave; the pressure on A is in balance. Fails with the body whose
    /// load no pressure can balance.
    fn start(&mut self, problem: &Problem<'_>, solution: &mut Solution, work: &mut Workspace) -> Result<(), usize> {
        self.energy = 0.0;
        let upright = self.is_upright(problem);
        if upright {
            let fields = solution.pressure.iter().zip(problem.gap);
            for (member, (&p, &gap)) in self.member.iter_mut().zip(fields) {
                *member = (p > 0.0) & (gap < f64::INFINITY);
            }
        } else {
            self.direction.fill(0.0);
            self.image.fill(0.0);
            for (k, (member, &p)) in self.member.iter_mut().zip(&solution.pressure).enumerate() {
                *member = p > 0.0 && problem.possible(k);
            }
        }
        self.list_cells(problem);
        let mut fresh = false;
        for (body, active) in self.bodies.iter_mut().enumerate() {
            if active.patch.cells.is_empty() && (!upright || self.passes.runs.count() == 0) && !problem.released(body) {
                // a guess without positive pressure may hold negative ones, of which v speaks
                fresh |= solution.pressure.iter().any(|&p| p != 0.0);
                // K⁻¹ of a uniform displacement, but for its scale, is the pressure under a flat punch
                let sharpen = |cells: &[u32], solution: &mut Solution| {
                    let shape = &mut self.preconditioned;
                    shape.fill(0.0);
                    cells.iter().for_each(|&k| shape[k as usize] = solution.pressure[k as usize]);
                    self.preconditioner.apply(shape);
                    solution.counts.preconditioner_applications += 1;
                    let sum = |field: &[f64]| cells.iter().map(|&k| field[k as usize].max(0.0)).sum::<f64>();
                    let scale = sum(&solution.pressure) / sum(shape);
                    cells.iter().for_each(|&k| solution.pressure[k as usize] = scale * shape[k as usize].max(0.0));
                };
                if !cold_start(problem, body, &mut active.patch, solution, sharpen) {
                    return Err(body);
                }
                adopt_pressed(problem, body, active, &mut self.member, solution);
                fresh |= !active.patch.cells.is_empty();
            }
        }
        if fresh {
            self.find_runs(problem);
            solution.convolve(problem, work);
        }
        self.bodies.iter_mut().for_each(|active| active.leaving.clear());
        for (k, (&p, &member)) in solution.pressure.iter().zip(&self.member).enumerate() {
            if (p != 0.0) & !member {
                self.bodies[problem.owner(k)].leaving.push(k as u32);
            }
        }
        self.balance(problem, Shape::Pressure, solution, work)
    }

    /// Whether the next direction has pressures to bring to zero or into balance.
    fn pending(&self) -> bool {
        self.bodies.iter().any(|active| !active.leaving.is_empty() || active.correction.is_some())
    }

    /// Finds the runs of members of A.
    fn find_runs(&mut self, problem: &Problem<'_>) {
        self.passes.runs.find(&self.member);
        self.height = self.passes.runs.greatest(problem.gap);
    }

    /// Lists the members of A.
    fn list_cells(&mut self, problem: &Problem<'_>) {
        self.find_runs(problem);
        self.bodies.iter_mut().for_each(|active| active.patch.cells.clear());
        if self.is_upright(problem) {
            return; // the runs say it all
        }
        for k in self.passes.runs.ranges().flatten() {
            self.bodies[problem.owner(k)].patch.cells.push(k as u32);
        }
        for (body, active) in self.bodies.iter_mut().enumerate() {
            active.patch.gram = problem.modes(body).gram(&active.patch.cells);
        }
    }

    /// Makes the shape of corrections on A.
    fn fill_shape(&mut self, shape: Shape, solution: &mut Solution) {
        self.shape.resize(self.member.len(), 0.0);
        match shape {
            Shape::Pressure => self.shape.copy_from_slice(&solution.pressure),
            Shape::Punch => {
                self.shape
                    .iter_mut()
                    .zip(&self.member)
                    .for_each(|(shape, &member)| *shape = f64::from(u8::from(member)));
                self.preconditioner.apply(&mut self.shape);
                solution.counts.preconditioner_applications += 1;
            }
        }
        // cells that join A before the correction is made bring nothing to it
        for (shape, &member) in self.shape.iter_mut().zip(&self.member) {
            *shape = if member { shape.max(0.0) } else { 0.0 };
        }
    }

    /// Sees to it that the pressure on A carries the force and moments of each body: at once, scaling p and
    /// v, where the force of a single body is all there is; else by the next direction.
    fn balance(
        &mut self,
        problem: &Problem<'_>,
        shape: Shape,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Result<(), usize> {
        let single = self.bodies.len() == 1;
        if !single || problem.modes(0).tilts() {
            self.fill_shape(shape, solution);
        }
        for body in 0..self.bodies.len() {
            let (active, modes) = (&mut self.bodies[body], problem.modes(body));
            active.correction = None;
            if problem.released(body) || !(modes.translates() || modes.tilts()) {
                continue;
            }
            if single && !modes.tilts() {
                let scale = problem.bodies[body].total / self.passes.runs.sum(&solution.pressure);
                if scale != 1.0 {
                    solution.pressure.iter_mut().for_each(|p| *p *= scale);
                    solution.potential.iter_mut().for_each(|v| *v *= scale);
                }
                continue;
            }
            let p = |k: usize| solution.pressure[k].max(0.0);
            match modes.balance(&active.patch.cells, p, |k| self.shape[k]) {
                Some(y) => {
                    active.correction = (y != ModeCoefficients::default()).then_some(y);
                }
                None => {
                    // the load acts outside the hull of what is left of A: begin again under this body
                    active.patch.cells.iter().for_each(|&k| self.member[k as usize] = false);
                    active.leaving.drain(..).for_each(|k| solution.pressure[k as usize] = 0.0);
                    if !modes.translates() {
                        // held at a pivot, and touching on one side of it only: unloaded, it may turn away
                        active.patch.cells.iter().for_each(|&k| solution.pressure[k as usize] = 0.0);
                    } else if shape == Shape::Punch {
                        // a cold start may be where the iterations came from
                        press_everywhere(problem, body, &mut active.patch, solution);
                    } else if !cold_start(problem, body, &mut active.patch, solution, |_, _| ()) {
                        return Err(body);
                    }
                    adopt_pressed(problem, body, active, &mut self.member, solution);
                    self.find_runs(problem);
                    solution.convolve(problem, work);
                }
            }
        }
        Ok(())
    }

    /// Takes from a converged pressure what rounding has left of force and moments: too little to show in v.
    /// False if it is more than rounding.
    fn close(&self, problem: &Problem<'_>, solution: &mut Solution) -> bool {
        if self.is_upright(problem) {
            // scaled, not by more than rounding
            if problem.modes(0).translates() {
                let scale = problem.bodies[0].total / self.passes.runs.sum(&solution.pressure);
                for run in self.passes.runs.ranges() {
                    solution.pressure[run].iter_mut().for_each(|p| *p *= scale);
                }
                return (scale - 1.0).abs() <= CLOSED;
            }
            return true;
        }
        for (body, active) in self.bodies.iter().enumerate().filter(|(body, _)| !problem.released(*body)) {
            let sum =
                |solution: &Solution| active.patch.cells.iter().map(|&k| solution.pressure[k as usize]).sum::<f64>();
            let before = sum(solution);
            let closed = balance(problem, body, &active.patch.cells, solution);
            // without a force to carry, what presses may be rounding itself
            let forced = problem.modes(body).translates();
            if forced && (!closed || (sum(solution) - before).abs() > CLOSED * before) {
                return false;
            }
        }
        true
    }

    /// Whether there is one body that does not tilt: then everything is done in a few passes ([`Passes`]).
    fn is_upright(&self, problem: &Problem<'_>) -> bool {
        self.bodies.len() == 1 && !problem.modes(0).tilts()
    }

    /// Takes the deeper ones of the penetrating cells into A, but for those that are about to leave: they would
    /// bring a negative pressure with them, and change the force. A body that sinks in deeper than the surface
    /// yields is not yet where it belongs: then the deepest cells stop it first.
    fn join(&mut self, problem: &Problem<'_>, state: Measure, penetration: f64, solution: &Solution) {
        let least = penetration * if penetration > state.yielding() { 0.5 } else { DEEP };
        let upright = self.is_upright(problem);
        let (c, motion) = (problem.compliance, solution.motions[0].0[0]);
        for k in 0..self.member.len() {
            self.member[k] |= solution.pressure[k] == 0.0
                && if upright {
                    motion - (c * solution.potential[k] + problem.gap[k]) > least
                } else {
                    problem.possible(k) && problem.depth(solution, k) > least
                };
        }
        self.list_cells(problem);
    }

    /// Whether negative pressures are the larger part of the error, or all that is left of it.
    fn should_evict(&self, problem: &Problem<'_>, stop: Stop, state: Measure) -> bool {
        let worth = problem.compliance / self.preconditioner.diagonal();
        let solved = state.square <= stop.tolerance * stop.tolerance * state.displacement;
        solved || worth * worth * state.negative > EVICT * EVICT * state.square
    }

    /// Takes cells with negative pressure out of A.
    fn evict(&mut self, problem: &Problem<'_>, solution: &mut Solution, work: &mut Workspace) -> Result<(), usize> {
        if self.is_upright(problem) {
            for k in self.passes.runs.ranges().flatten().filter(|&k| solution.pressure[k] < 0.0) {
                self.member[k] = false;
                self.bodies[0].leaving.push(k as u32);
            }
        } else {
            for active in &mut self.bodies {
                for &k in active.patch.cells.iter().filter(|&&k| solution.pressure[k as usize] < 0.0) {
                    self.member[k as usize] = false;
                    active.leaving.push(k);
                }
            }
        }
        self.list_cells(problem);
        self.balance(problem, Shape::Punch, solution, work)
    }
}

/// Makes the cells of a body that a new guess presses, of those its patch lists, its part of A.
fn adopt_pressed(
    problem: &Problem<'_>,
    body: usize,
    active: &mut ActiveBody,
    member: &mut [bool],
    solution: &Solution,
) {
    active.patch.cells.retain(|&k| solution.pressure[k as usize] > 0.0);
    active.patch.cells.iter().for_each(|&k| member[k as usize] = true);
    active.patch.gram = problem.modes(body).gram(&active.patch.cells);
}
