//! The free motions of a step, checks of its loads and results, and the width of the grid that a contact at the edge needs.

use std::f64::consts::PI;

use crate::Grid;
use crate::axis::Axis;
use crate::contact::state::net_sum;
use crate::contact::step::edge::MOST;
use crate::contact::{Edge, Region, Scene, Solver, State, Step, Trial, Window};
use crate::error::{AdhesionError, Convergence, Error, Result, StepError, coverage, exact_length};
use crate::hereditary::Interval;
use crate::load::{Load, Tilt, load_point};
use crate::solver::{Counts, Freedom, Outcome, Solution};

/// Rejects loads that no pressure can balance.
pub(super) fn validate_loads(scene: &Scene, step: &Step<'_>) -> Result<()> {
    let (time, loads, grid) = (step.interval.time, step.loads, &scene.grid);
    exact_length("loads of the rigid bodies", loads.len(), scene.bodies)?;
    for (body, load) in loads.iter().enumerate() {
        load.validate_in(scene.attraction.is_some())?;
        let is_free = !load.is_force() && load.tilt().iter().any(|tilt| matches!(tilt, Tilt::Free { .. }));
        coverage::FREE_TILT.unless(|_| is_free && scene.attraction.is_some())?;
        let Freedom { translation, tilt, point, total } = freedom(load, grid);
        let tilts = load.tilt().map(|tilt| tilt != Tilt::Fixed(0.0));
        let tilts_of_periodic = |axis: &Axis| tilts[axis.index()] && scene.kernel.periodic_axes()[axis.index()];
        if let Some(axis) = Axis::BOTH.into_iter().find(tilts_of_periodic) {
            return Err(Error::Step(StepError::TiltOfPeriodic { time, axis }));
        }
        let lost = total == 0.0 && matches!(load, Load::Force { normal, .. } if *normal > 0.0);
        if lost || !total.is_finite() {
            return Err(Error::Step(StepError::Overflow { time, what: "the force over the area of a cell" }));
        }
        let pressed = !translation || total > 0.0 || matches!(load, Load::Spring { .. });
        let balanced = tilt != [false; 2] && pressed;
        if balanced && step.indenter.hull(body, grid).balanced_at(point, tilt).is_none() {
            return Err(Error::Step(StepError::LoadOutsideHull { time, body, at: point }));
        }
    }
    Ok(())
}

/// Writes the free motions of each body. A tilt along a folded axis vanishes by symmetry.
pub(super) fn find_free_motions(scene: &Scene, region: &Region, step: &Step<'_>, free: &mut [Freedom]) {
    for (body, (own, load)) in free.iter_mut().zip(step.loads).enumerate() {
        *own = freedom(load, &scene.grid);
        if own.tilts()
            && let Some(point) = step.indenter.hull(body, &scene.grid).balanced_at(own.point, own.tilt)
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

/// Rejects a step beyond the loading times for which the material is known. Bodies that were never `touched` have no loading
/// time.
pub(super) fn material_is_known(scene: &Scene, state: &State, step: &Step<'_>, touched: bool) -> Result<()> {
    let Interval { time, reduced, .. } = step.interval;
    scene.limits.check_age(time, reduced - state.clock.undisturbed_until, touched)
}

/// Rejects a compliance that overflows or underflows. It is 0 only in jumps of bodies without elastic response.
pub(super) fn compliance_is_usable(c: f64, step: &Step<'_>) -> Result<()> {
    let Interval { time, dt, .. } = step.interval;
    let usable = c > 0.0 && c.is_finite() || c == 0.0 && dt == 0.0;
    if usable { Ok(()) } else { Err(Error::Step(StepError::Overflow { time, what: "the compliance of the step" })) }
}

/// Rejects an approach greater than the one that closes every gap, if the mean displacement is fixed: Σ h = Σ gap ≥ 0.
pub(super) fn below_full_contact(window: &Window, trial: &Trial, step: &Step<'_>) -> Result<()> {
    let held = step.loads.iter().all(|load| matches!(load, Load::Approach { .. }));
    let (true, true, &[Load::Approach { approach, .. }, ..]) = (held, window.kernel.whole.mean_is_held(), step.loads)
    else {
        return Ok(());
    };
    let rows = window.kernel.rows();
    let left = rows.sum(&trial.gap) / rows.len() as f64;
    let greatest = approach + left;
    if left > 0.0 {
        Ok(())
    } else {
        Err(Error::Step(StepError::BeyondFullContact { time: step.interval.time, approach, greatest }))
    }
}

/// Rejects a contact problem that the solver did not solve.
pub(super) fn converged(outcome: Outcome, scene: &Scene, solution: &Solution, step: &Step<'_>) -> Result<()> {
    let Solution { residual, counts: Counts { iterations, .. }, ref trace, .. } = *solution;
    let (time, dt, tolerance) = (step.interval.time, step.interval.length, step.tolerance);
    match outcome {
        Outcome::Converged => Ok(()),
        Outcome::Cancelled => Err(Error::Cancelled { what: "a step" }),
        Outcome::NotANumber => {
            Err(Error::Step(StepError::Overflow { time, what: "the residual of the contact problem" }))
        }
        Outcome::Unbalanced(body) => {
            let at = freedom(&step.loads[body], &scene.grid).point;
            Err(Error::Step(StepError::LoadOutsideHull { time, body, at }))
        }
        Outcome::OutOfIterations | Outcome::Stagnated => {
            let (active_set, stagnated) = (scene.settings.solver == Solver::ActiveSet, outcome == Outcome::Stagnated);
            let convergence = Convergence::new(trace.samples(), tolerance, active_set, stagnated).into();
            Err(Error::Step(StepError::NotConverged { time, dt, iterations, residual, tolerance, convergence }))
        }
    }
}

/// Rejects results that overflow, contact at the edge of the grid, and bodies pressed through a layer on a rigid base. Returns Σ p.
pub(super) fn acceptable(scene: &Scene, state: &State, trial: &Trial, step: &Step<'_>) -> Result<f64> {
    let (Solution { pressure, motions, .. }, rows) = (&trial.solution, state.region.rows());
    let sum_of_pressure = net_sum(&rows, &trial.solution);
    let pressures = state.region.images() as f64 * sum_of_pressure;
    let force = scene.grid.cell_area() * pressures;
    // no moment is greater than the moment of the whole force at the end of the longer side
    let arm = scene.grid.lengths().into_iter().fold(0.0, f64::max);
    let greatest_moment = arm * pressures.abs().max(force.abs());
    let (time, edge) = (step.interval.time, scene.settings.edge);
    let within_range = [
        (motions.iter().flat_map(|motion| motion.0).all(f64::is_finite), "the approach"),
        (force.is_finite(), "the force"),
        (greatest_moment.is_finite(), "the moment of the force"),
        (rows.sum(state.history.trial()).is_finite(), "the displacement"),
    ];
    if let Some((_, what)) = within_range.into_iter().find(|(is_finite, _)| !is_finite) {
        return Err(Error::Step(StepError::Overflow { time, what }));
    }
    if edge == Edge::Refuse {
        let cells = state.region.positive_on_edge(pressure, scene.kernel.periodic_axes());
        if cells > 0 {
            let (lengths, needed) = (scene.grid.lengths(), needed_lengths(scene, state, trial, step));
            return Err(Error::Step(StepError::ContactAtEdge { time, cells, lengths, needed }));
        }
        let share = trial.passes.as_ref().map_or(0.0, |passes| passes.report.beyond_edge);
        if share > MOST {
            return Err(AdhesionError::BeyondEdge { time, share, lengths: scene.grid.lengths() }.into());
        }
    }
    let motion = |body: usize| {
        step.prescribed(body) + state.region.modes(trial.free[body]).physical(trial.solution.motions[body])
    };
    if let Some(layer) = scene.kernel.layer_of().filter(|layer| layer.is_on_rigid())
        && let Some(compression) = scene.compression(&step.indenter, &state.region, pressure, motion)
        && compression >= 1.0
    {
        let thickness = layer.thickness();
        return Err(Error::Step(StepError::ThroughLayer { time, depth: compression * thickness, thickness }));
    }
    Ok(sum_of_pressure)
}

/// Exponents of a gap between these are fitted; a surface that is rough or flat has none.
const EXPONENTS: std::ops::RangeInclusive<f64> = 0.7..=6.0;

/// Estimates the lengths of a grid that holds the contact of a trial, which reaches the edge; `None` where the gap does not rise
/// towards the edge like a power of the distance, along periodic axes, of several bodies and on ranks.
///
/// On an elastic half-space an indenter whose gap is A rⁿ touches within a radius a at the approach κ A aⁿ. Cut off at the radius L,
/// at the edge of the grid, it carries the same force at the approach ω with (a / L)ⁿ⁺¹ = ((n + 1) ω / (κ A Lⁿ) − 1) / n.
fn needed_lengths(scene: &Scene, state: &State, trial: &Trial, step: &Step<'_>) -> Option<[f64; 2]> {
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
            let over = depth / (depth_of_power(exponent) * height(end));
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

/// κ of the shape A rⁿ, which touches within a at the depth κ A aⁿ (Galin; Sneddon 1965): √π Γ(n/2 + 1) / Γ((n + 1)/2), π/2 for a cone, 2
/// for a paraboloid.
pub(crate) fn depth_of_power(exponent: f64) -> f64 {
    PI.sqrt() * libm::tgamma(0.5 * exponent + 1.0) / libm::tgamma(0.5 * exponent + 0.5)
}
