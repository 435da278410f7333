//! The fall-back of the active set: slower, but sure.

use crate::kernel::Workspace;
use crate::solver::problem::{Patch, Problem, Solution, Stop};

/// Iterations of the first visit; every further visit in the same step doubles them.
const FIRST_VISIT: usize = 20;

/// Projected gradients with steps after Barzilai & Borwein and an exact line search (Birgin, Martínez &
/// Raydan, SIAM J. Optim. 10, 2000). The contact problem is the minimum of the convex
///
/// ½ c p·Kp + gap·p   over   p ≥ 0 in balance with the loads,
///
/// and every iterate lowers it, so that the method converges from anywhere, at one convolution an iteration.
#[derive(Debug, Clone, Default)]
pub(crate) struct ProjectedGradient {
    /// Made at the first use: most contacts never need them.
    direction: Vec<f64>,
    image: Vec<f64>,
    patches: Vec<Patch>,
    visits: u32,
}

impl ProjectedGradient {
    /// Forgets earlier visits: a new step begins.
    pub(crate) fn reset(&mut self) {
        self.visits = 0;
    }

    /// Lowers the energy of `solution` for a while.
    pub(crate) fn improve(&mut self, problem: &Problem<'_>, stop: Stop, solution: &mut Solution, work: &mut Workspace) {
        self.prepare(problem);
        for k in 0..problem.gap.len() {
            let p = &mut solution.pressure[k];
            *p = if problem.possible(k) { p.max(0.0) } else { 0.0 };
        }
        if !self.project(problem, solution, 0.0) {
            return;
        }
        for (p, d) in solution.pressure.iter_mut().zip(&self.direction) {
            *p += d;
        }
        solution.convolve(problem, work);

        let c = problem.compliance;
        let mut length = 1.0 / (c * problem.kernel.self_influence());
        let visit = FIRST_VISIT << self.visits.min(20);
        self.visits += 1;
        for _ in 0..visit {
            if solution.counts.iterations >= stop.max_iterations {
                return;
            }
            self.fit_motions(problem, solution);
            if !self.project(problem, solution, length) {
                return;
            }
            solution.counts.iterations += 1;
            solution.counts.fallback_iterations += 1;
            problem.kernel.apply(&self.direction, &mut self.image, work);
            solution.counts.convolutions += 1;

            let (mut slope, mut curvature, mut square) = (0.0, 0.0, 0.0);
            for k in self.patches.iter().flat_map(|patch| &patch.cells).map(|&k| k as usize) {
                let d = self.direction[k];
                slope += d * problem.depth(solution, k);
                curvature += c * d * self.image[k];
                square += d * d;
            }
            if slope <= 0.0 || curvature <= 0.0 {
                return; // the minimum, to rounding
            }
            let step = (slope / curvature).min(1.0);
            length = square / curvature;
            for (p, d) in solution.pressure.iter_mut().zip(&self.direction) {
                *p = (*p + step * d).max(0.0);
            }
            for (v, kd) in solution.potential.iter_mut().zip(&self.image) {
                *v += step * kd;
            }
        }
    }

    /// Lists the cells that may carry pressure, and makes the fields at the first use.
    fn prepare(&mut self, problem: &Problem<'_>) {
        self.direction.resize(problem.gap.len(), 0.0);
        self.image.resize(problem.gap.len(), 0.0);
        self.patches.resize_with(problem.bodies.len(), Patch::default);
        self.patches.iter_mut().for_each(|patch| patch.cells.clear());
        for k in (0..problem.gap.len()).filter(|&k| problem.possible(k)) {
            self.patches[problem.owner(k)].cells.push(k as u32);
        }
    }

    /// Fits the free motions on the cells that carry pressure.
    fn fit_motions(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        for (k, raw) in self.image.iter_mut().enumerate() {
            *raw = problem.compliance * solution.potential[k] + problem.gap[k];
        }
        for (body, patch) in self.patches.iter().enumerate() {
            let modes = problem.modes(body);
            let mut pressed = patch.cells.clone();
            pressed.retain(|&k| solution.pressure[k as usize] > 0.0);
            solution.motions[body] = modes.fit(&modes.gram(&pressed), &pressed, &self.image);
        }
    }

    /// Sets the direction to P(p − length h) − p, P being the projection onto pressures that are ≥ 0 and in
    /// balance; false if there are none.
    fn project(&mut self, problem: &Problem<'_>, solution: &Solution, length: f64) -> bool {
        self.direction.fill(0.0);
        for (body, patch) in self.patches.iter().enumerate() {
            if problem.released(body) {
                continue;
            }
            let modes = problem.modes(body);
            let moved = |k: usize| match length {
                0.0 => solution.pressure[k],
                length => solution.pressure[k] + length * problem.depth(solution, k),
            };
            let Some(y) = modes.balance(&patch.cells, moved, |_| 1.0) else { return false };
            for k in patch.cells.iter().map(|&k| k as usize) {
                self.direction[k] = modes.balanced(y, k, moved(k), 1.0) - solution.pressure[k];
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::kernel::InfluenceKernel;
    use crate::solver::{ActiveSet, Freedom};

    /// The fall-back alone finds what the active set finds, from a bad guess, with force and moments.
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
        let problem = Problem { kernel: &kernel, compliance: 0.5, gap: &gap, bodies: &[freedom], owner: None };
        let stop = Stop { tolerance: 1e-10, max_iterations: 100_000 };
        let mut work = kernel.workspace();

        let mut exact = Solution::zero(grid.len(), 1);
        ActiveSet::new(&kernel, 1).solve(&problem, stop, &mut exact, &mut work);
        assert!(exact.residual <= 1e-10 && exact.counts.fallback_iterations == 0);

        let mut slow = Solution::zero(grid.len(), 1);
        slow.pressure.iter_mut().zip(&gap).for_each(|(p, h)| *p = if h.is_finite() { 1.0 } else { 0.0 });
        let mut fallback = ProjectedGradient::default();
        for _ in 0..8 {
            fallback.improve(&problem, stop, &mut slow, &mut work);
        }
        assert!(slow.counts.fallback_iterations > 20);
        let peak = exact.pressure.iter().copied().fold(0.0, f64::max);
        for (a, b) in slow.pressure.iter().zip(&exact.pressure) {
            assert!((a - b).abs() < 1e-6 * peak, "{a} {b} after {}", slow.counts.fallback_iterations);
        }
    }
}
