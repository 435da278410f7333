//! The fall-back of the active set: a primal active-set method, slower, but every step of it lowers the energy.
//!
//! The contact problem is the minimum of the convex
//!
//! E(p) = ½ c p·Kp + gap·p   over   p ≥ 0 in balance with the loads.
//!
//! Pressures remain feasible throughout (J. Nocedal & S. Wright, *Numerical Optimization*, 2006, section 16.5; J.
//! Moré & G. Toraldo, SIAM J. Optim. 1, 1991, for many cells at a time). On the set A conjugate gradients approach
//! the minimum over pressures of either sign. A step that would make some of them negative is replaced by the better
//! of two that do not: the same direction up to the first zero, or the direction towards the clipped and balanced end
//! of the step, with its own exact line search. Cells at zero then leave A, and cells that penetrate join it with
//! p = 0, which does not change E. E falls from step to step, so that no set returns.

use super::iteration::Towards;
use super::{ActiveSet, RULES};
use crate::solver::{Outcome, Problem, ResidualSums, Solution, Solve, add, make_feasible};

/// The best step along a direction.
#[derive(Debug, Clone, Copy, Default)]
struct Gain {
    /// Length of the step.
    length: f64,
    /// Decrease of E.
    energy: f64,
}

impl Gain {
    /// The gain of a step along a direction with Σ r d = `slope` and c Σ d·Kd = `curvature`, up to the minimum or to
    /// `most`.
    fn along(slope: f64, curvature: f64, most: f64) -> Gain {
        if slope <= 0.0 || curvature <= 0.0 {
            return Gain::default();
        }
        let length = (slope / curvature).min(most);
        Gain { length, energy: length * (slope - 0.5 * length * curvature) }
    }
}

impl ActiveSet {
    /// Improves `solution` until its residual is below the tolerance, the iterations are spent, or rounding hides any
    /// gain.
    pub(super) fn descend(&mut self, solve: &mut Solve<'_>) -> Result<Outcome, usize> {
        let (problem, stop) = (solve.problem, solve.stop);
        self.changes.clear();
        make_feasible(problem, &mut self.set, solve.solution)?;
        solve.convolve();
        let (mut gained, mut joins_without_gain, mut blocked) = (true, 0, false);
        self.energy = 0.0;
        loop {
            let mut state = self.advance(problem, solve.solution, 0.0);
            state.note(problem, self.guess_rounding, solve.solution);
            if let Some(outcome) = stop.outcome(solve.solution, || true) {
                return Ok(outcome);
            }
            let penetrates = state.penetration > RULES.join_over_rms * state.rms();
            // cells at zero that blocked the step have left; where they joined again before any gain, they would
            // block the next
            if penetrates && !blocked {
                joins_without_gain = if gained { 0 } else { joins_without_gain + 1 };
                if joins_without_gain > RULES.tries_without_gain {
                    return Ok(Outcome::Stagnated);
                }
                gained = false;
                self.add_deepest_cells(problem, joins_without_gain > 0, state, solve.solution);
                self.advance(problem, solve.solution, 0.0);
            }
            solve.solution.counts.iterations += 1;
            solve.solution.counts.fallback_iterations += 1;
            let cells = self.set.count();
            let towards = if joins_without_gain > 1 { Towards::Residual } else { Towards::Preconditioned };
            let gain = self.step_downhill(towards, solve);
            gained |= gain > 0.0;
            blocked = gain <= 0.0 && self.set.count() < cells;
            if gain <= 0.0 && !blocked && !penetrates {
                return Ok(Outcome::Stagnated);
            }
        }
    }

    /// Takes penetrating cells into A: the deeper ones, or the deepest alone.
    fn add_deepest_cells(&mut self, problem: &Problem<'_>, alone: bool, state: ResidualSums, solution: &Solution) {
        let outside = |k: &usize| !self.set.member[*k] && problem.possible(*k);
        let cells = (0..self.set.member.len()).filter(outside);
        let deepest = problem.rows().greatest(cells.map(|k| problem.depth(solution, k)).fold(0.0, f64::max));
        // where several cells have joined without any gain, only the deepest one
        let least = if alone { deepest } else { ResidualSums { penetration: deepest, ..state }.joining_depth() };
        for k in 0..self.set.member.len() {
            self.set.member[k] |= problem.possible(k) && least > 0.0 && problem.depth(solution, k) >= least;
        }
        self.set.update(problem);
        self.energy = 0.0;
    }

    /// One step; returns the decrease of E.
    fn step_downhill(&mut self, towards: Towards, solve: &mut Solve<'_>) -> f64 {
        let (problem, c) = (solve.problem, solve.problem.compliance);
        self.find_direction(towards, solve);
        self.search.convolve(solve);
        let solution = &mut *solve.solution;
        let [slope, curvature] = self.slope_and_curvature(problem, solution);
        self.energy = curvature;
        let free = Gain::along(slope, c * curvature, f64::INFINITY);
        if free.energy <= 0.0 {
            self.energy = 0.0;
            return 0.0;
        }
        let to_zero = |k: usize| {
            let (p, d) = (solution.pressure[k], self.search.direction[k]);
            if d < 0.0 { -p / d } else { f64::INFINITY }
        };
        let first_zero = problem.rows().least(self.set.segments.cells().map(to_zero).fold(f64::INFINITY, f64::min));
        if free.length <= first_zero {
            for k in self.set.segments.cells() {
                solution.pressure[k] = (solution.pressure[k] + free.length * self.search.direction[k]).max(0.0);
            }
            add(&mut solution.potential, free.length, &self.search.image);
            return free.energy;
        }

        let straight = Gain::along(slope, c * curvature, first_zero);
        let clipped = if self.find_clipped_step(problem, free.length, solution) {
            let ActiveSet { set, buffer: step, shape: image, .. } = self;
            let slope = set.sum_over_all(problem, |k| problem.depth(solution, k) * step[k]);
            image.resize(step.len(), 0.0);
            solve.convolve_field(step, image);
            let curvature = set.sum_over_all(problem, |k| step[k] * image[k]);
            Gain::along(slope, c * curvature, 1.0)
        } else {
            Gain::default()
        };
        let clips = clipped.energy > straight.energy;
        let solution = &mut *solve.solution;
        let ActiveSet { set, buffer: clipped_step, shape: clipped_image, search, .. } = self;
        for k in set.segments.cells() {
            let (p, d) = (&mut solution.pressure[k], search.direction[k]);
            *p = if clips {
                (*p + clipped.length * clipped_step[k]).max(0.0)
            } else if d < 0.0 && -*p / d <= first_zero {
                0.0
            } else {
                (*p + straight.length * d).max(0.0)
            };
            if *p <= 0.0 && d < 0.0 {
                set.member[k] = false;
            }
        }
        let (gain, image) = if clips { (clipped, clipped_image) } else { (straight, &mut search.image) };
        add(&mut solution.potential, gain.length, image);
        set.update(problem);
        self.energy = 0.0;
        gain.energy
    }

    /// Writes the step from p to the balanced max(0, p + a d) to the buffer; false if there is no such balance on A.
    fn find_clipped_step(&mut self, problem: &Problem<'_>, a: f64, solution: &Solution) -> bool {
        let ActiveSet { set, buffer: step, search, .. } = self;
        step.fill(0.0);
        problem.loaded_bodies().all(|body| {
            let clipped = |k: usize| (solution.pressure[k] + a * search.direction[k]).max(0.0);
            let Some(y) = set.balance(problem, body, clipped, clipped) else { return false };
            for (k, factor) in set.displacements(problem, body, y) {
                step[k] = (clipped(k) + clipped(k) * factor).max(0.0) - solution.pressure[k];
            }
            true
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::kernel::InfluenceKernel;
    use crate::solver::Stop;
    use crate::solver::rigid_motion::Freedom;

    /// The fall-back alone, from a bad guess, converges to the solution of the active set, on soft and on nearly
    /// rigid surfaces.
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
        let stop = Stop { tolerance: 1e-10, max_iterations: 1000, cancelled: None };
        let mut work = kernel.workspace();
        for compliance in [5.0, 0.5, 1e-3, 1e-9] {
            let problem = Problem {
                kernel: &kernel,
                compliance,
                gap: &gap,
                prescribed: 0.0,
                bodies: &[freedom],
                owner: None,
                likely: None,
            };
            let mut solver = ActiveSet::new(&kernel, 1, &mut work);
            let mut exact = Solution::zero(grid.len(), 1);
            assert_eq!(
                solver.solve(&mut Solve { problem: &problem, stop, solution: &mut exact, work: &mut work }),
                Outcome::Converged
            );

            let mut slow = Solution::zero(grid.len(), 1);
            slow.pressure.iter_mut().zip(&gap).for_each(|(p, h)| *p = if h.is_finite() { 1.0 } else { 0.0 });
            assert_eq!(
                solver.descend(&mut Solve { problem: &problem, stop, solution: &mut slow, work: &mut work }),
                Ok(Outcome::Converged)
            );
            assert!(slow.counts.fallback_iterations < 60, "{compliance}: {:?}", slow.counts);
            let peak = exact.pressure.iter().copied().fold(0.0, f64::max);
            for (a, b) in slow.pressure.iter().zip(&exact.pressure) {
                assert!((a - b).abs() < 1e-8 * peak, "{compliance}: {a} {b} after {:?}", slow.counts);
            }
        }
    }
}
