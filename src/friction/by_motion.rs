//! Loads near the limit, by the motion that they cause.
//!
//! With the motion Δd prescribed the tractions have no loads to meet, and are found wherever the body goes. What they
//! then carry, Bᵀ τ(Δd), is monotone in Δd: Newton's method finds the motion that carries the load, also where it is
//! far, since little is missing to the limit.

use crate::friction::kernel::TangentialKernel;
use crate::friction::newton::{Convergence, NewtonBuffers};
use crate::friction::problem::{Problem, Solution, take_motion};
use crate::linalg;

/// Newton steps.
const STEPS: usize = 40;
/// Changes of the motion by which slopes are found, over the motion.
const CHANGE: f64 = 1e-5;
/// Parts of a Newton step below this one are not tried.
const LEAST_SHARE: f64 = 1e-3;
/// The most accurate tractions under a prescribed motion.
const MOST_ACCURATE: f64 = 1e-12;

/// The search for the motion that carries a load.
struct Search<'a> {
    problem: &'a Problem<'a>,
    kernel: &'a mut TangentialKernel,
    buffers: &'a mut NewtonBuffers,
    /// The residual of tractions under a prescribed motion.
    tolerance: f64,
    convergence: Convergence,
}

impl Search<'_> {
    /// What is missing of each load under this motion, over its [scale](Problem::size), if the tractions are found.
    fn missing(&mut self, solution: &mut Solution, motion: [f64; 3]) -> Option<[f64; 3]> {
        let problem = self.problem;
        let mut drift = std::mem::take(&mut self.buffers.drift);
        drift.copy_from_slice(problem.drift);
        take_motion(&mut drift, problem.touching(), problem.entered, problem.places, motion);
        let missing = self.missing_of(solution, &Problem { drift: &drift, wanted: [None; 3], ..*problem });
        self.buffers.drift = drift;
        missing
    }

    fn missing_of(&mut self, solution: &mut Solution, held: &Problem<'_>) -> Option<[f64; 3]> {
        let problem = self.problem;
        for is_cold in [false, true] {
            if is_cold {
                solution.begin_cold(held);
            }
            let found = solution.solve(held, self.kernel, self.tolerance, self.buffers);
            self.convergence.iterations += found.iterations;
            self.convergence.residual = found.residual;
            if found.is_solved {
                let missing =
                    |k: usize, wanted: f64| (wanted - problem.carried(k, &solution.traction)) / problem.size(k);
                return Some([0, 1, 2].map(|k| problem.wanted[k].map_or(0.0, |wanted| missing(k, wanted))));
            }
        }
        None
    }

    /// The Newton step, in units of motion: by differences.
    fn step(&mut self, start: &Solution, motion: [f64; 3], lacking: [f64; 3], units: [f64; 3]) -> Option<[f64; 3]> {
        let (mut slopes, mut solution) = ([[0.0; 3]; 3], std::mem::take(&mut self.buffers.beside));
        let mut found = true;
        for k in self.problem.driven() {
            let by = CHANGE * (motion[k].abs() + units[k]);
            let mut beside = motion;
            beside[k] += by;
            solution.clone_from(start);
            let there = self.missing(&mut solution, beside);
            found &= there.is_some();
            let there = there.unwrap_or(lacking);
            (0..3).for_each(|row| slopes[row][k] = (lacking[row] - there[row]) / by * units[k]);
        }
        self.buffers.beside = solution;
        found.then(|| linalg::solve(slopes, lacking, 0.0).0)
    }
}

fn size(missing: [f64; 3]) -> f64 {
    missing.iter().fold(0.0, |most, value| most.max(value.abs()))
}

impl Solution {
    pub(super) fn find_by_motion(
        &mut self,
        problem: &Problem<'_>,
        kernel: &mut TangentialKernel,
        tolerance: f64,
        buffers: &mut NewtonBuffers,
    ) -> Convergence {
        let tight = (1e-3 * tolerance).max(MOST_ACCURATE.min(tolerance));
        let mut search = Search { problem, kernel, buffers, tolerance: tight, convergence: Convergence::default() };
        // a displacement that friction could cause, and the angle that moves the mean cell by as much
        let largest = problem.touching().map(|i| problem.bound[i]).fold(0.0, f64::max);
        let natural = problem.compliance * problem.self_influence * largest;
        let arm = problem.reach(2) / problem.reach(0);
        let units = [natural, natural, natural / arm.max(f64::MIN_POSITIVE)];
        let mut motion = [0.0; 3];
        self.begin_cold(problem);
        let Some(mut lacking) = search.missing(self, motion) else { return search.convergence };
        for _ in 0..STEPS {
            if size(lacking) <= tolerance.max(10.0 * tight) {
                self.motion = motion;
                return Convergence { is_solved: true, ..search.convergence };
            }
            search.buffers.kept.clone_from(self);
            let Some(step) = search.step(self, motion, lacking, units) else { return search.convergence };
            let mut share = 1.0;
            loop {
                let next = [0, 1, 2].map(|k| motion[k] + share * step[k] * units[k]);
                let found = search.missing(self, next);
                if let Some(there) = found.filter(|there| size(*there) < (1.0 - 0.1 * share) * size(lacking)) {
                    (motion, lacking) = (next, there);
                    break;
                }
                share *= 0.5;
                if share < LEAST_SHARE {
                    return search.convergence;
                }
                self.clone_from(&search.buffers.kept);
            }
        }
        search.convergence
    }
}
