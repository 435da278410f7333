//! A first guess of the pressure when there is none to go by.

use crate::solver::{Problem, Solution};

/// Fills `solution.pressure` with p ∝ √(level − gap) where the gap is below a level, summing to the
/// total of the problem.
///
/// The shape is Hertz's exact answer for a paraboloid, and uniform on a flat face. The level comes
/// from balance: pressing m cells with mean pressure total/m sinks their middle by about
/// (2/√π) c total/m √(m A), A the area of a cell (a uniformly loaded circle), and that depth
/// is what the gap must rise by over these cells; it is found by bisection.
pub(crate) fn cold_start(problem: &Problem<'_>, solution: &mut Solution) {
    let gap = problem.gap;
    let finite = || gap.iter().copied().filter(|h| h.is_finite());
    let lowest = finite().fold(f64::INFINITY, f64::min);
    let highest = finite().fold(f64::NEG_INFINITY, f64::max);
    let area = problem.kernel.grid().cell_area();
    let depth = |cells: usize| {
        2.0 / std::f64::consts::PI.sqrt() * problem.compliance * problem.total * (area / cells as f64).sqrt()
    };
    let cells_below = |level: f64| gap.iter().filter(|&&h| h <= level).count();

    // the depth falls and the level rises with the number of cells: their balance is unique
    let (mut low, mut high) = (lowest, highest);
    for _ in 0..40 {
        let level = 0.5 * (low + high);
        if level - lowest < depth(cells_below(level)) {
            low = level;
        } else {
            high = level;
        }
    }
    let level =
        if highest - lowest < depth(cells_below(highest)) { lowest + depth(cells_below(highest)) } else { high };

    let mut sum = 0.0;
    for (p, &h) in solution.pressure.iter_mut().zip(gap) {
        *p = if h <= level && level > lowest { (level - h).sqrt() } else { 0.0 };
        sum += *p;
    }
    if sum == 0.0 {
        // the rise of the gap is below rounding: press the lowest cells evenly
        for (p, &h) in solution.pressure.iter_mut().zip(gap) {
            *p = if h <= lowest { 1.0 } else { 0.0 };
            sum += *p;
        }
    }
    let scale = problem.total / sum;
    solution.pressure.iter_mut().for_each(|p| *p *= scale);
}
