//! A first guess of the pressure when there is none to go by.

use std::f64::consts::PI;

use crate::solver::{Problem, Solution};

/// Bisections for the level, far beyond the accuracy that a guess needs.
const HALVINGS: usize = 40;

/// Fills `solution.pressure` with p ∝ √(level − gap) where the gap is below a level, summing to the
/// total of the problem: Hertz's shape for a paraboloid, uniform on a flat face.
///
/// On a contact of m cells of area A, Hertz's a³ = (3/4) R c W says that the gap rises by
/// a²/2R = (3√π/8) c W/√(m A) from its lowest point to its edge. This is taken for every geometry; the
/// level that it balances at is found by bisection.
pub(crate) fn cold_start(problem: &Problem<'_>, solution: &mut Solution) {
    let gap = problem.gap;
    let finite = || gap.iter().copied().filter(|h| h.is_finite());
    let lowest = finite().fold(f64::INFINITY, f64::min);
    let highest = finite().fold(f64::NEG_INFINITY, f64::max);
    let area = problem.kernel.grid().cell_area();
    let rise = |level: f64| {
        let cells = gap.iter().filter(|&&h| h <= level).count();
        0.375 * PI.sqrt() * problem.compliance * problem.total * (area / cells as f64).sqrt()
    };

    // the rise falls with the level: the balance is unique, and above the highest gap if the load
    // presses the whole face
    let mut level = highest;
    if level - lowest < rise(level) {
        level = lowest + rise(level);
    } else {
        let mut low = lowest;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + level);
            if middle - lowest < rise(middle) {
                low = middle;
            } else {
                level = middle;
            }
        }
    }

    let mut sum = 0.0;
    for (p, &h) in solution.pressure.iter_mut().zip(gap) {
        *p = (level - h).max(0.0).sqrt();
        sum += *p;
    }
    if sum == 0.0 {
        // the rise is below rounding: press the lowest cells evenly
        for (p, &h) in solution.pressure.iter_mut().zip(gap) {
            *p = if h <= lowest { 1.0 } else { 0.0 };
            sum += *p;
        }
    }
    let scale = problem.total / sum;
    solution.pressure.iter_mut().for_each(|p| *p *= scale);
}
