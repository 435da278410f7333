//! Loads near the limit, by the motion that they cause.
//!
//! With the motion Δd prescribed the tractions have no loads to meet, and are found wherever the body goes. What they
//! then carry, Bᵀ τ(Δd), is monotone in Δd: Newton's method finds the motion that carries the load, also where it is far,
//! since little is missing to the limit.

use crate::friction::kernel::TangentialKernel;
use crate::friction::newton::{Outcome, Work};
use crate::friction::problem::{Problem, Solution};
use crate::linalg;

/// Newton steps.
const STEPS: usize = 40;
/// Changes of the motion by which slopes are found, over the motion.
const CHANGE: f64 = 1e-5;
/// The most accurate tractions under a prescribed motion.
const MOST_ACCURATE: f64 = 1e-12;

impl Solution {
    pub(super) fn find_by_motion(
        &mut self,
        problem: &Problem<'_>,
        kernel: &mut TangentialKernel,
        tolerance: f64,
        work: &mut Work,
    ) -> Outcome {
        let n = problem.cells();
        let driven: Vec<usize> = problem.driven().collect();
        let tight = (1e-3 * tolerance).max(MOST_ACCURATE.min(tolerance));
        let (mut drift, mut outcome) = (problem.drift.to_vec(), Outcome::default());
        // what is missing of the loads, over what friction can carry
        let sizes = [0, 1, 2].map(|k| problem.wanted[k].unwrap_or(0.0).abs() + 1e-3 * problem.reach(k));
        let mut missing = |solution: &mut Solution, motion: [f64; 3], outcome: &mut Outcome, work: &mut Work| {
            drift.copy_from_slice(problem.drift);
            for i in problem.touching() {
                for &k in &driven {
                    let (mode, by) = (problem.mode(k, i), problem.entered[i] * motion[k]);
                    (drift[i], drift[n + i]) = (drift[i] - by * mode[0], drift[n + i] - by * mode[1]);
                }
            }
            let held = Problem { drift: &drift, wanted: [None; 3], ..*problem };
            for is_cold in [false, true] {
                if is_cold {
                    solution.begin_cold(&held);
                }
                let found = solution.solve(&held, kernel, tight, work);
                (outcome.iterations, outcome.residual) = (outcome.iterations + found.iterations, found.residual);
                if found.is_solved {
                    return Some([0, 1, 2].map(|k| {
                        problem.wanted[k]
                            .map_or(0.0, |wanted| (wanted - problem.carried(k, &solution.traction)) / sizes[k])
                    }));
                }
            }
            None
        };
        let size = |missing: [f64; 3]| missing.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        // a displacement that friction could cause, and the angle that moves the mean cell by as much
        let largest = problem.touching().map(|i| problem.bound[i]).fold(0.0, f64::max);
        let natural = problem.compliance * problem.side * largest;
        let arm = problem.reach(2) / problem.reach(0);
        let units = [natural, natural, natural / arm.max(f64::MIN_POSITIVE)];
        let mut motion = [0.0; 3];
        self.begin_cold(problem);
        let Some(mut lacking) = missing(self, motion, &mut outcome, work) else { return outcome };
        for _ in 0..STEPS {
            if size(lacking) <= tolerance.max(10.0 * tight) {
                self.motion = motion;
                return Outcome { is_solved: true, ..outcome };
            }
            let start = self.clone();
            let mut slopes = [[0.0; 3]; 3];
            for &k in &driven {
                let by = CHANGE * (motion[k].abs() + units[k]);
                let mut beside = motion;
                beside[k] += by;
                let Some(there) = missing(self, beside, &mut outcome, work) else { return outcome };
                (0..3).for_each(|row| slopes[row][k] = (lacking[row] - there[row]) / by);
                self.clone_from(&start);
            }
            let scaled: [[f64; 3]; 3] = std::array::from_fn(|a| std::array::from_fn(|b| slopes[a][b] * units[b]));
            let (step, _) = linalg::solve(scaled, lacking, 0.0);
            let mut share = 1.0;
            loop {
                let next = [0, 1, 2].map(|k| motion[k] + share * step[k] * units[k]);
                let found = missing(self, next, &mut outcome, work);
                if let Some(there) = found.filter(|there| size(*there) < (1.0 - 0.1 * share) * size(lacking)) {
                    (motion, lacking) = (next, there);
                    break;
                }
                share *= 0.5;
                if share < 1e-3 {
                    return outcome;
                }
                self.clone_from(&start);
            }
        }
        outcome
    }
}
