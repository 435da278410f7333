//! The fall-back of the active set: a primal active-set method, slower, but every step of it lowers the energy.
//!
//! The contact problem is the minimum of the convex
//!
//! E(p) = ½ c p·Kp + gap·p   over   p ≥ 0 in balance with the loads.
//!
//! Pressures stay feasible throughout (J. Nocedal & S. Wright, *Numerical Optimization*, 2006, section 16.5; J. Moré &
//! G. Toraldo, SIAM J. Optim. 1, 1991, for many cells at a time). On the set A conjugate gradients approach the minimum over
//! pressures of either sign. A step that would make some of them negative is replaced by the better of two that do not: the same
//! direction up to the first zero, or the way towards the clipped and balanced end of the step, with its own exact
//! line search. Cells at zero then leave A, and cells that penetrate join it with p = 0, which leaves E as it is. E falls from
//! step to step, so that no set returns.

use super::{ActiveSet, DEEP, JOIN};
use crate::kernel::Workspace;
use crate::solver::cold_start::{balance, cold_start};
use crate::solver::problem::{Measure, Outcome, Problem, Solution, Stop, relative_residual};
use crate::solver::rigid_motion::ModeCoefficients;

/// Times that cells may join A without any gain before the next ones: then what is left is rounding.
const FRUITLESS: usize = 3;

/// What a step along a direction gains.
#[derive(Debug, Clone, Copy, Default)]
struct Gain {
    /// Length of the step.
    length: f64,
    /// By how much E falls.
    energy: f64,
}

impl Gain {
    /// Of a step along a direction with Σ r d = `slope` and c Σ d·Kd = `curvature`, up to the minimum or to `most`.
    fn along(slope: f64, curvature: f64, most: f64) -> Gain {
        if slope <= 0.0 || curvature <= 0.0 {
            return Gain::default();
        }
        let length = (slope / curvature).min(most);
        Gain { length, energy: length * (slope - 0.5 * length * curvature) }
    }
}

impl ActiveSet {
    /// Improves `solution` until its residual is below the tolerance, the iterations are spent, or rounding hides any gain.
    pub(super) fn descend(
        &mut self,
        problem: &Problem<'_>,
        stop: Stop,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Outcome {
        if let Err(body) = self.make_feasible(problem, solution, work) {
            return Outcome::Unbalanced(body);
        }
        self.shape.resize(self.member.len(), 0.0);
        let (mut gained, mut fruitless) = (true, 0);
        self.energy = 0.0;
        loop {
            let mut state = self.fit_motions(problem, solution);
            let penetration = problem.penetration(solution, |k| !self.member[k]);
            state.cancelled = problem.rounding(&solution.pressure) + self.begun;
            solution.residual = relative_residual(&state, penetration);
            solution.rounding = state.relative_rounding();
            solution.trace.note(solution.counts.iterations, solution.residual);
            if solution.residual <= stop.tolerance {
                self.find_runs(problem);
                return Outcome::Converged;
            }
            if solution.residual.is_nan() {
                return Outcome::NotANumber;
            }
            if solution.counts.iterations >= stop.max_iterations {
                return Outcome::OutOfIterations;
            }
            let joins = penetration > JOIN * state.rms();
            if joins {
                fruitless = if gained { 0 } else { fruitless + 1 };
                if fruitless > FRUITLESS {
                    return Outcome::Stagnated;
                }
                gained = false;
                // where several have not gained anything, the deepest cell alone
                let share = match fruitless {
                    0 if penetration > state.yielding() => 0.5,
                    0 => DEEP,
                    _ => 1.0,
                };
                self.admit(problem, share * penetration, solution);
                self.fit_motions(problem, solution);
            }
            solution.counts.iterations += 1;
            solution.counts.fallback_iterations += 1;
            let cells = state.cells;
            match self.step_downhill(problem, fruitless, solution, work) {
                0.0 if !joins && self.members() == cells => return Outcome::Stagnated,
                gain => gained |= gain > 0.0,
            }
        }
    }

    /// The motions that fit the surface on A best, and r = −h there.
    fn fit_motions(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> Measure {
        let mut state = Measure::default();
        for (body, active) in self.bodies.iter().enumerate() {
            problem.measure(body, &active.patch, solution, &mut self.residual, &mut state);
        }
        state
    }

    /// Pressures that are ≥ 0 and in balance, their K p, and A where they are positive.
    fn make_feasible(
        &mut self,
        problem: &Problem<'_>,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> Result<(), usize> {
        for (k, member) in self.member.iter_mut().enumerate() {
            let p = &mut solution.pressure[k];
            *member = problem.possible(k) && *p > 0.0;
            if !*member {
                *p = 0.0;
            }
        }
        self.list_patches(problem);
        for (body, active) in self.bodies.iter_mut().enumerate() {
            active.leaving.clear();
            active.correction = None;
            if !problem.released(body)
                && (active.patch.cells.is_empty() || !balance(problem, body, &active.patch.cells, solution))
                && !cold_start(problem, body, &mut active.patch, solution, |_, _| ())
            {
                return Err(body);
            }
        }
        self.member.iter_mut().zip(&solution.pressure).for_each(|(member, &p)| *member = p > 0.0);
        self.list_patches(problem);
        solution.convolve(problem, work);
        Ok(())
    }

    /// Lists the members of A by body.
    fn list_patches(&mut self, problem: &Problem<'_>) {
        self.bodies.iter_mut().for_each(|active| active.patch.cells.clear());
        for k in (0..self.member.len()).filter(|&k| self.member[k]) {
            self.bodies[problem.owner(k)].patch.cells.push(k as u32);
        }
        for (body, active) in self.bodies.iter_mut().enumerate() {
            active.patch.gram = problem.modes(body).gram(&active.patch.cells);
        }
    }

    fn members(&self) -> usize {
        self.bodies.iter().map(|active| active.patch.cells.len()).sum()
    }

    /// Takes cells into A that penetrate by `least` or more.
    fn admit(&mut self, problem: &Problem<'_>, least: f64, solution: &Solution) {
        for k in 0..self.member.len() {
            self.member[k] |= problem.possible(k) && least > 0.0 && problem.depth(solution, k) >= least;
        }
        self.list_patches(problem);
        self.energy = 0.0;
    }

    /// One step; returns by how much E falls.
    fn step_downhill(
        &mut self,
        problem: &Problem<'_>,
        fruitless: usize,
        solution: &mut Solution,
        work: &mut Workspace,
    ) -> f64 {
        let c = problem.compliance;
        self.find_descent(problem, fruitless > 1, solution);
        problem.kernel.apply(&self.direction, &mut self.image, work);
        solution.counts.convolutions += 1;
        let [slope, curvature] = self.slope_and_curvature(&self.direction, &self.image);
        self.energy = curvature;
        let free = Gain::along(slope, c * curvature, f64::INFINITY);
        if free.energy <= 0.0 {
            self.energy = 0.0;
            return 0.0;
        }
        let members = || self.bodies.iter().flat_map(|active| &active.patch.cells).map(|&k| k as usize);
        let to_zero = |k: usize| {
            let (p, d) = (solution.pressure[k], self.direction[k]);
            if d < 0.0 { -p / d } else { f64::INFINITY }
        };
        let first_zero = members().map(to_zero).fold(f64::INFINITY, f64::min);
        if free.length <= first_zero {
            for k in self.bodies.iter().flat_map(|active| &active.patch.cells).map(|&k| k as usize) {
                solution.pressure[k] = (solution.pressure[k] + free.length * self.direction[k]).max(0.0);
            }
            add(&mut solution.potential, free.length, &self.image);
            return free.energy;
        }

        let straight = Gain::along(slope, c * curvature, first_zero);
        let bent = if self.clip(problem, free.length, solution) {
            problem.kernel.apply(&self.shape, &mut self.preconditioned, work);
            solution.counts.convolutions += 1;
            let [slope, curvature] = self.slope_and_curvature(&self.shape, &self.preconditioned);
            Gain::along(slope, c * curvature, 1.0)
        } else {
            Gain::default()
        };
        let clips = bent.energy > straight.energy;
        for active in &self.bodies {
            for k in active.patch.cells.iter().map(|&k| k as usize) {
                let (p, d) = (&mut solution.pressure[k], self.direction[k]);
                *p = if clips {
                    (*p + bent.length * self.shape[k]).max(0.0)
                } else if d < 0.0 && -*p / d <= first_zero {
                    0.0
                } else {
                    (*p + straight.length * d).max(0.0)
                };
                if *p <= 0.0 && d < 0.0 {
                    self.member[k] = false;
                }
            }
        }
        let (gain, image) = if clips { (bent, &self.preconditioned) } else { (straight, &self.image) };
        add(&mut solution.potential, gain.length, image);
        self.list_patches(problem);
        self.energy = 0.0;
        gain.energy
    }

    /// d ← z + β d without free motion on A, or the plain residual if that is wanted.
    fn find_descent(&mut self, problem: &Problem<'_>, plain: bool, solution: &mut Solution) {
        let z = &mut self.preconditioned;
        z.fill(0.0);
        for active in &self.bodies {
            active.patch.cells.iter().for_each(|&k| z[k as usize] = self.residual[k as usize]);
        }
        if !plain {
            self.preconditioner.apply(z);
            solution.counts.preconditioner_applications += 1;
        }
        let mut overlap = 0.0;
        for (body, active) in self.bodies.iter().enumerate() {
            let cells = &active.patch.cells;
            problem.modes(body).project_out(&active.patch.gram, cells, z);
            overlap += cells.iter().map(|&k| z[k as usize] * self.image[k as usize]).sum::<f64>();
        }
        let beta = Self::conjugate(self.energy, overlap, false);
        for (body, active) in self.bodies.iter().enumerate().filter(|_| beta != 0.0) {
            let cells = &active.patch.cells;
            cells.iter().for_each(|&k| z[k as usize] += beta * self.direction[k as usize]);
            problem.modes(body).project_out(&active.patch.gram, cells, z);
        }
        self.direction.fill(0.0);
        for active in &self.bodies {
            active.patch.cells.iter().for_each(|&k| self.direction[k as usize] = z[k as usize]);
        }
    }

    /// Makes the way from p to the balanced max(0, p + a d), the shape; false if there is no such balance on A.
    fn clip(&mut self, problem: &Problem<'_>, a: f64, solution: &Solution) -> bool {
        self.shape.fill(0.0);
        for (body, active) in self.bodies.iter().enumerate().filter(|(body, _)| !problem.released(*body)) {
            let modes = problem.modes(body);
            let clipped = |k: usize| (solution.pressure[k] + a * self.direction[k]).max(0.0);
            let y = if modes.tilts() || modes.translates() {
                let Some(y) = modes.balance(&active.patch.cells, clipped, clipped) else { return false };
                y
            } else {
                ModeCoefficients::default()
            };
            for k in active.patch.cells.iter().map(|&k| k as usize) {
                self.shape[k] = modes.balanced(y, k, clipped(k), clipped(k)) - solution.pressure[k];
            }
        }
        true
    }

    /// Σ r d and Σ d·Kd on A.
    fn slope_and_curvature(&self, direction: &[f64], image: &[f64]) -> [f64; 2] {
        let members = self.bodies.iter().flat_map(|active| &active.patch.cells).map(|&k| k as usize);
        members.fold([0.0; 2], |[slope, curvature], k| {
            [slope + self.residual[k] * direction[k], curvature + direction[k] * image[k]]
        })
    }
}

/// x += a y.
fn add(x: &mut [f64], a: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, &y)| *x += a * y);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::kernel::InfluenceKernel;
    use crate::solver::Freedom;

    /// Alone, and from a bad guess, it finds what the active set finds, soft surface or nearly rigid one.
    #[test]
    fn it_converges_on_its_own() {
        let grid = Grid::square(12, 1.2).unwrap();
        let kernel = InfluenceKernel::half_space(&grid).unwrap().on(&grid, [false; 2]);
        let gap: Vec<f64> = (0..grid.len())
            .map(|k| {
                let [x, y] = grid.center(k / 12, k % 12);
                if x.hypot(y) < 0.55 { 0.2 * (x * x + 2.0 * y * y) + 0.01 * (9.0 * x).sin() } else { f64::INFINITY }
            })
            .collect();
        let freedom = Freedom { translation: true, tilt: [true; 2], point: [0.1, -0.05], total: 5.0 };
        let stop = Stop { tolerance: 1e-10, max_iterations: 1000 };
        let mut work = kernel.workspace();
        for compliance in [5.0, 0.5, 1e-3, 1e-9] {
            let problem =
                Problem { kernel: &kernel, compliance, gap: &gap, prescribed: 0.0, bodies: &[freedom], owner: None };
            let mut solver = ActiveSet::new(&kernel, 1);
            let mut exact = Solution::zero(grid.len(), 1);
            assert_eq!(solver.solve(&problem, stop, &mut exact, &mut work), Outcome::Converged);

            let mut slow = Solution::zero(grid.len(), 1);
            slow.pressure.iter_mut().zip(&gap).for_each(|(p, h)| *p = if h.is_finite() { 1.0 } else { 0.0 });
            assert_eq!(solver.descend(&problem, stop, &mut slow, &mut work), Outcome::Converged);
            assert!(slow.counts.fallback_iterations < 60, "{compliance}: {:?}", slow.counts);
            let peak = exact.pressure.iter().copied().fold(0.0, f64::max);
            for (a, b) in slow.pressure.iter().zip(&exact.pressure) {
                assert!((a - b).abs() < 1e-8 * peak, "{compliance}: {a} {b} after {:?}", slow.counts);
            }
        }
    }
}
