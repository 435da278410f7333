//! A first guess of the pressure under a body without pressure.

use std::f64::consts::PI;

use super::{ContactSet, ModeCoefficients, Problem, RestingPosition, Solution};
use crate::quadrature::bisect;

/// Clips a guess to p ≥ 0 on cells that may carry pressure, balances it, and sets the contact to the cells with
/// pressure. Fails with the body whose load no pressure can balance.
pub(crate) fn make_feasible(problem: &Problem<'_>, set: &mut ContactSet, solution: &mut Solution) -> Result<(), usize> {
    for (k, p) in solution.pressure.iter_mut().enumerate() {
        *p = if problem.possible(k) { p.max(0.0) } else { 0.0 };
    }
    set.find_pressed(problem, &solution.pressure);
    for body in problem.loaded_bodies() {
        let balanced = set.count_under(body) > 0 && balance(problem, body, set, solution);
        if !balanced {
            cold_start(problem, body, set, solution)?;
        }
    }
    set.find_pressed(problem, &solution.pressure);
    Ok(())
}

/// Fills the pressure under `body` with a guess whose force and moments are in balance; adds all cells that it
/// may touch to `set`.
///
/// Fails with the body if no pressure on these cells can balance the load.
pub(crate) fn cold_start(
    problem: &Problem<'_>,
    body: usize,
    set: &mut ContactSet,
    solution: &mut Solution,
) -> Result<(), usize> {
    set.press_possible(problem, body);
    fill_hertz(problem, body, set, solution);
    if balance_with_supports(problem, body, set, solution) { Ok(()) } else { Err(body) }
}

/// Presses every cell that the body may touch, evenly but for the moments: a guess that does not depend on the gap.
pub(crate) fn press_everywhere(problem: &Problem<'_>, body: usize, set: &mut ContactSet, solution: &mut Solution) {
    set.press_possible(problem, body);
    let mean = problem.bodies[body].total / set.count_under(body) as f64;
    set.cells(problem, body).for_each(|k| solution.pressure[k] = mean);
    balance_with_supports(problem, body, set, solution);
}

/// Balances the pressures in contact. If they have no balance, as under a load so near the rim that next to no cell
/// can carry it, the cells on which the rigid body would rest are pressed more: they balance the load if any cells
/// do.
fn balance_with_supports(problem: &Problem<'_>, body: usize, set: &ContactSet, solution: &mut Solution) -> bool {
    if balance(problem, body, set, solution) {
        return true;
    }
    let freedom = problem.bodies[body];
    if freedom.translation {
        let cells = set.cells(problem, body);
        let resting = RestingPosition::new(problem.rows(), &problem.modes(body), problem.gap, cells);
        for (k, share) in resting.supports.into_iter().flatten() {
            solution.pressure[k] += share * freedom.total;
        }
    }
    balance(problem, body, set, solution)
}

/// Fills the pressure in contact with p ∝ √(level − gap) where the gap is below a level: Hertz's shape for a
/// paraboloid, uniform on a flat face.
///
/// Under a force, the level is where the gap has risen by Hertz's a²/2R = (3√π/8) c W/√(m A) on m cells of
/// area A, from a³ = (3/4) R c W. At a given approach δ below the first touch it is half of that,
/// a²/2R = δ/2, and the peak pressure is (2/π) δ/(c a).
fn fill_hertz(problem: &Problem<'_>, body: usize, set: &ContactSet, solution: &mut Solution) {
    let (freedom, modes, rows) = (problem.bodies[body], problem.modes(body), problem.rows());
    let cells = || set.cells(problem, body);
    cells().for_each(|k| solution.pressure[k] = 0.0);
    // a body that tilts under a force starts from its resting position
    let motion = if modes.freedom.tilts() && modes.freedom.translation {
        RestingPosition::new(rows, &modes, problem.gap, cells()).motion
    } else {
        ModeCoefficients::default()
    };
    if modes.freedom.tilts() {
        solution.motions[body] = motion;
    }
    let gap = |k: usize| problem.gap[k] - modes.displacement(motion, k);
    let heights = || cells().map(gap);
    let lowest = rows.least(heights().fold(f64::INFINITY, f64::min));
    let highest = rows.greatest(heights().fold(f64::NEG_INFINITY, f64::max));
    let (area, images) = (problem.kernel.grid().cell_area(), problem.kernel.images());
    let cells_below = |level: f64| rows.count(heights().filter(|&h| h <= level).count()) as f64;

    let (level, peak) = if freedom.translation {
        let rise = |level: f64| {
            0.375 * PI.sqrt() * problem.compliance * freedom.total * (images * area / cells_below(level)).sqrt()
        };
        // the rise falls with the level: the balance is unique, and above the highest gap if the load presses the
        // whole face
        let is_low = |level: f64| level - lowest < rise(level);
        let between = || bisect(lowest, highest, 40, is_low)[1];
        (if is_low(highest) { lowest + rise(highest) } else { between() }, 1.0)
    } else if lowest < 0.0 {
        let level = 0.5 * lowest;
        let radius = (images * cells_below(level) * area / PI).sqrt();
        (level, 2.0 / PI * -lowest / (problem.compliance * radius))
    } else {
        return; // the body does not reach the surface
    };

    let depth = level - lowest;
    for k in cells() {
        // where the rise is below rounding, the lowest cells are pressed evenly
        let evenly = || f64::from(u8::from(gap(k) <= lowest));
        solution.pressure[k] = peak * if depth > 0.0 { ((level - gap(k)) / depth).max(0.0).sqrt() } else { evenly() };
    }
    if freedom.translation {
        let scale = freedom.total / set.sum_of(problem, body, |k| solution.pressure[k]);
        cells().for_each(|k| solution.pressure[k] *= scale);
    }
}

/// Brings pressures ≥ 0 in contact into balance with the load by a factor 1 + B y, clipped at zero; false
/// if there is no such balance.
pub(crate) fn balance(problem: &Problem<'_>, body: usize, set: &ContactSet, solution: &mut Solution) -> bool {
    let modes = problem.modes(body);
    if !modes.freedom.tilts() && !modes.freedom.translation {
        return true;
    }
    let pressure = &mut solution.pressure;
    let admissible = || !problem.rows().any(!set.cells(problem, body).all(|k| pressure[k] >= 0.0));
    if !modes.freedom.tilts() && admissible() {
        let scale = problem.bodies[body].total / set.sum(problem, body, pressure);
        if !scale.is_finite() {
            return false;
        }
        set.cells(problem, body).for_each(|k| pressure[k] *= scale);
        return true;
    }
    let Some(y) = set.balance(problem, body, |k| pressure[k], |k| pressure[k]) else { return false };
    for (k, factor) in set.displacements(problem, body, y) {
        pressure[k] = (pressure[k] + pressure[k] * factor).max(0.0);
    }
    true
}
