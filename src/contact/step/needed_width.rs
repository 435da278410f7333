//! The width of the grid that a contact needs which reaches the edge.

use std::f64::consts::PI;

use crate::contact::{Scene, State, Step, Trial};
use crate::load::Load;

/// Exponents of a gap between these are fitted; a surface that is rough or flat has none.
const EXPONENTS: std::ops::RangeInclusive<f64> = 0.7..=6.0;

/// Estimates the lengths of a grid that holds the contact of a trial, which reaches the edge; `None` where the gap does not rise
/// towards the edge like a power of the distance, along periodic axes, of several bodies and on ranks.
///
/// On an elastic half-space an indenter whose gap is A rⁿ touches within a radius a at the approach κ A aⁿ. Cut off at the radius L,
/// at the edge of the grid, it carries the same force at the approach ω with (a / L)ⁿ⁺¹ = ((n + 1) ω / (κ A Lⁿ) − 1) / n.
pub(super) fn needed_lengths(scene: &Scene, state: &State, trial: &Trial, step: &Step<'_>) -> Option<[f64; 2]> {
    let (grid, gap) = (&scene.grid, step.indenter.gap());
    let single = step.indenter.bodies() == 1 && !state.region.is_shared();
    if !single || scene.kernel.periodic_axes() != [false; 2] {
        return None;
    }
    let free = state.region.modes(trial.free[0]).physical(trial.solution.motions[0]);
    let depth = step.prescribed(0).approach + free.approach;
    let n2 = grid.cells()[1];
    let lowest = gap.above.iter().position(|&h| h == 0.0)?;
    let lowest = [lowest / n2, lowest % n2];
    let mut needed = grid.lengths();
    for (axis, needed) in needed.iter_mut().enumerate() {
        for end in [0, grid.cells()[axis] - 1] {
            let height = |index: usize| {
                let mut cell = lowest;
                cell[axis] = index;
                gap.above[cell[0] * n2 + cell[1]]
            };
            let distance = |index: usize| (index as f64 - lowest[axis] as f64) * grid.spacing()[axis];
            let half = usize::midpoint(end, lowest[axis]);
            let (rise, at) = (height(end) / height(half), distance(end) / distance(half));
            let exponent = rise.ln() / at.ln();
            if !rise.is_finite() || !EXPONENTS.contains(&exponent) {
                return None;
            }
            let over = depth / (factor(exponent) * height(end));
            let wider = match step.loads[0] {
                Load::Approach { .. } => over.powf(1.0 / exponent),
                _ => (((exponent + 1.0) * over - 1.0) / exponent).powf(1.0 / (exponent + 1.0)),
            };
            let [i, j] = lowest;
            let reach = grid.center(i, j)[axis] + wider * distance(end);
            *needed = needed.max(2.0 * reach.abs());
        }
    }
    (needed != grid.lengths() && needed.iter().all(|length| length.is_finite())).then_some(needed)
}

/// κ = n √π/2 Γ(n/2) / Γ((n + 1)/2), to 1 %: π/2 for a cone, 2 for a paraboloid.
fn factor(exponent: f64) -> f64 {
    let half = 0.5 * exponent;
    half * PI.sqrt() * (half + 0.5) / half / (half + 0.75).sqrt()
}
