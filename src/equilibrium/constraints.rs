//! The free motions of a step, checks of its loads and results, and the width of the grid that a contact at the edge
//! needs.

use std::f64::consts::PI;

use crate::Grid;
use crate::axis::Axis;
use crate::equilibrium::held::net_sum;
use crate::equilibrium::{Edge, Ground, Held, Region, Request, Trial, Window};
use crate::error::{Error, Result, StepError, exact_length};
use crate::load::{Load, Tilt, load_point};
use crate::solver::{Counts, Freedom, Outcome, Solution};

/// Rejects loads that no pressure can balance.
pub(crate) fn validate_loads(ground: &Ground, request: Request<'_>) -> Result<()> {
    let Request { time, loads, indenter, .. } = request;
    let grid = &ground.grid;
    exact_length("loads of the rigid bodies", loads.len(), ground.bodies)?;
    for (body, load) in loads.iter().enumerate() {
        load.validate_in(ground.attraction.is_some())?;
        let Freedom { translation, tilt, point, total } = freedom(load, grid);
        let tilts = load.tilt().map(|tilt| tilt != Tilt::Fixed(0.0));
        let tilts_of_periodic = |axis: &Axis| tilts[axis.index()] && ground.kernel.periodic_axes()[axis.index()];
        if let Some(axis) = Axis::BOTH.into_iter().find(tilts_of_periodic) {
            return Err(Error::Step(StepError::TiltOfPeriodic { time, axis }));
        }
        let lost = total == 0.0 && matches!(load, Load::Force { normal, .. } if *normal > 0.0);
        if lost || !total.is_finite() {
            return Err(Error::Step(StepError::Overflow { time, what: "the force over the area of a cell" }));
        }
        let pressed = !translation || total > 0.0 || matches!(load, Load::Spring { .. });
        let balanced = tilt != [false; 2] && pressed;
        if balanced && indenter.hull(body, grid).balanced_at(point, tilt).is_none() {
            return Err(Error::Step(StepError::LoadOutsideHull { time, body, at: point }));
        }
    }
    Ok(())
}

/// Writes the free motions of each body. A tilt along a folded axis vanishes by symmetry.
pub(crate) fn find_free_motions(ground: &Ground, region: &Region, request: Request<'_>, free: &mut [Freedom]) {
    for (body, (own, load)) in free.iter_mut().zip(request.loads).enumerate() {
        *own = freedom(load, &ground.grid);
        if own.tilts()
            && let Some(point) = request.indenter.hull(body, &ground.grid).balanced_at(own.point, own.tilt)
        {
            own.point = point;
        }
        own.tilt = [0, 1].map(|axis| own.tilt[axis] && !region.folded()[axis]);
        own.total /= region.images() as f64;
    }
}

/// The free motions of a body under a load.
fn freedom(load: &Load, grid: &Grid) -> Freedom {
    let tilt = load.tilt().map(|tilt| matches!(tilt, Tilt::Free { .. }));
    let point = load_point(load.tilt());
    let (translation, total) = match load {
        Load::Force { normal, .. } => (true, normal / grid.cell_area()),
        Load::Approach { .. } => (false, 0.0),
        // found with the pressure
        Load::Spring { .. } => (true, 0.0),
    };
    Freedom { translation, tilt, point, total }
}

/// Rejects an approach greater than the one that closes every gap, if the mean displacement is fixed: Σ h = Σ gap ≥ 0.
pub(crate) fn below_full_contact(window: &Window, trial: &Trial, request: Request<'_>) -> Result<()> {
    let held = request.loads.iter().all(|load| matches!(load, Load::Approach { .. }));
    let (true, true, &[Load::Approach { approach, .. }, ..]) =
        (held, window.kernel.whole.mean_is_held(), request.loads)
    else {
        return Ok(());
    };
    let rows = window.kernel.rows();
    let left = rows.sum(&trial.gap) / rows.len() as f64;
    let maximum = approach + left;
    if left > 0.0 {
        Ok(())
    } else {
        Err(Error::Step(StepError::BeyondFullContact { time: request.time, approach, maximum }))
    }
}

/// Rejects a contact problem that the solver did not solve.
pub(crate) fn converged(outcome: Outcome, ground: &Ground, solution: &Solution, request: Request<'_>) -> Result<()> {
    let Solution { residual, counts: Counts { iterations, .. }, .. } = *solution;
    let Request { time, length: dt, tolerance, .. } = request;
    match outcome {
        Outcome::Converged => Ok(()),
        Outcome::Cancelled => Err(Error::Cancelled { what: "a step" }),
        Outcome::NotANumber => {
            Err(Error::Step(StepError::Overflow { time, what: "the residual of the contact problem" }))
        }
        Outcome::Unbalanced(body) => {
            let at = freedom(&request.loads[body], &ground.grid).point;
            Err(Error::Step(StepError::LoadOutsideHull { time, body, at }))
        }
        Outcome::OutOfIterations | Outcome::Stagnated => {
            let stagnated = outcome == Outcome::Stagnated;
            Err(Error::Step(StepError::NotConverged { time, dt, iterations, residual, tolerance, stagnated }))
        }
    }
}

/// Rejects results that overflow, contact at the edge of the grid, and bodies pressed through a layer on a rigid
/// base. Returns Σ p. `displaced` is the sum of the displacements.
pub(crate) fn acceptable(
    ground: &Ground,
    held: &Held,
    displaced: f64,
    trial: &Trial,
    request: Request<'_>,
) -> Result<f64> {
    let (Solution { pressure, motions, .. }, rows) = (&trial.solution, held.region.rows());
    let sum_of_pressure = net_sum(&rows, &trial.solution);
    let pressures = held.region.images() as f64 * sum_of_pressure;
    let force = ground.grid.cell_area() * pressures;
    // no moment is greater than the moment of the whole force at the end of the longer side
    let arm = ground.grid.lengths().into_iter().fold(0.0, f64::max);
    let greatest_moment = arm * pressures.abs().max(force.abs());
    let time = request.time;
    let within_range = [
        (motions.iter().flat_map(|motion| motion.0).all(f64::is_finite), "the approach"),
        (force.is_finite(), "the force"),
        (greatest_moment.is_finite(), "the moment of the force"),
        (displaced.is_finite(), "the displacement"),
    ];
    if let Some((_, what)) = within_range.into_iter().find(|(is_finite, _)| !is_finite) {
        return Err(Error::Step(StepError::Overflow { time, what }));
    }
    if ground.settings.edge == Edge::Refuse {
        let cells = held.region.positive_on_edge(pressure, ground.kernel.periodic_axes());
        if cells > 0 {
            let (lengths, needed) = (ground.grid.lengths(), needed_lengths(ground, held, trial, request));
            return Err(Error::Step(StepError::ContactAtEdge { time, cells, lengths, needed }));
        }
    }
    let motion = |body: usize| trial.motion(&held.region, request, body);
    if let Some(layer) = ground.kernel.layer_of().filter(|layer| layer.is_on_rigid())
        && let Some(compression) = ground.compression(request.indenter, &held.region, pressure, motion)
        && compression >= 1.0
    {
        let thickness = layer.thickness();
        return Err(Error::Step(StepError::ThroughLayer { time, depth: compression * thickness, thickness }));
    }
    Ok(sum_of_pressure)
}

/// Exponents of a gap between these are fitted; a surface that is rough or flat has none.
const EXPONENTS: std::ops::RangeInclusive<f64> = 0.7..=6.0;

/// Estimates the lengths of a grid that holds the contact of a trial, which reaches the edge; `None` where the gap
/// does not rise towards the edge like a power of the distance, along periodic axes, of several bodies and on ranks.
///
/// On an elastic half-space an indenter whose gap is A rⁿ touches within a radius a at the approach κ A aⁿ. Cut off
/// at the radius L, at the edge of the grid, it carries the same force at the approach ω with (a / L)ⁿ⁺¹ = ((n + 1)
/// ω / (κ A Lⁿ) − 1) / n.
fn needed_lengths(ground: &Ground, held: &Held, trial: &Trial, request: Request<'_>) -> Option<[f64; 2]> {
    let (grid, gap) = (&ground.grid, request.indenter.gap());
    let single = request.indenter.bodies() == 1 && !held.region.is_shared();
    if !single || ground.kernel.periodic_axes() != [false; 2] {
        return None;
    }
    let depth = trial.motion(&held.region, request, 0).approach;
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
            let over = depth / (depth_of_power(exponent) * height(end));
            let wider = match request.loads[0] {
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

/// κ of the shape A rⁿ, which touches within a at the depth κ A aⁿ (Galin; Sneddon 1965): √π
/// Γ(n/2 + 1) / Γ((n + 1)/2), π/2 for a cone, 2 for a paraboloid.
pub(crate) fn depth_of_power(exponent: f64) -> f64 {
    PI.sqrt() * libm::tgamma(0.5 * exponent + 1.0) / libm::tgamma(0.5 * exponent + 0.5)
}
