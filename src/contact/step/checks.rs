//! Whether the end of a step may be accepted.

use crate::contact::scene::Scene;
use crate::contact::settings::{Edge, Solver};
use crate::contact::state::State;
use crate::contact::step::request::Step;
use crate::contact::step::trial::Trial;
use crate::contact::window::window::Window;
use crate::error::{Convergence, Error, Result};
use crate::hereditary::Interval;
use crate::load::{Load, Tilt};
use crate::rheology::is_known;
use crate::solver::{Counts, Outcome, Solution};

/// Rejects a step whose loading time is longer than the material is known for, if the bodies are `touched`: what
/// was never touched has no history.
pub(super) fn material_is_known(scene: &Scene, state: &State, step: &Step<'_>, touched: bool) -> Result<()> {
    let Interval { time, reduced, .. } = step.interval;
    let (age, known_until) = (reduced - state.clock.undisturbed_until, scene.material.known_until());
    if !touched || is_known(age, known_until) { Ok(()) } else { Err(Error::BeyondMaterial { time, age, known_until }) }
}

/// Rejects a compliance that left the range of numbers; it is 0 in jumps of bodies without elastic response alone.
pub(super) fn compliance_is_usable(c: f64, step: &Step<'_>) -> Result<()> {
    let Interval { time, dt, .. } = step.interval;
    let usable = c > 0.0 && c.is_finite() || c == 0.0 && dt == 0.0;
    if usable { Ok(()) } else { Err(Error::Overflow { time, what: "the compliance of the step" }) }
}

/// Rejects an approach beyond that which closes every gap, where the mean displacement is held: Σ h = Σ gap ≥ 0.
pub(super) fn below_full_contact(window: &Window, trial: &Trial, step: &Step<'_>) -> Result<()> {
    let held = step.loads.iter().all(|load| matches!(load, Load::Approach { .. }));
    let (true, true, &[Load::Approach { approach, .. }, ..]) = (held, window.kernel().mean_is_held(), step.loads)
    else {
        return Ok(());
    };
    let rows = window.kernel().rows();
    let left = rows.sum(&trial.gap) / rows.len() as f64;
    let greatest = approach + left;
    if left > 0.0 { Ok(()) } else { Err(Error::BeyondFullContact { time: step.interval.time, approach, greatest }) }
}

/// Rejects what the solver did not solve.
pub(super) fn converged(outcome: Outcome, scene: &Scene, solution: &Solution, step: &Step<'_>) -> Result<()> {
    let Solution { residual, counts: Counts { iterations, .. }, ref trace, .. } = *solution;
    let (time, dt, tolerance) = (step.interval.time, step.interval.length, step.tolerance);
    match outcome {
        Outcome::Converged => Ok(()),
        Outcome::NotANumber => Err(Error::Overflow { time, what: "the residual of the contact problem" }),
        Outcome::Unbalanced(body) => {
            let at = step.loads[body].tilt().map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 });
            Err(Error::LoadOutsideHull { time, body, at })
        }
        Outcome::OutOfIterations | Outcome::Stagnated => {
            let stagnated = outcome == Outcome::Stagnated;
            let convergence =
                Convergence::new(trace.samples(), tolerance, scene.settings.solver == Solver::ActiveSet, stagnated)
                    .into();
            Err(Error::NotConverged { time, dt, iterations, residual, tolerance, convergence })
        }
    }
}

/// Rejects results that left the range of numbers, and contact at the edge of the grid; returns Σ p.
pub(super) fn acceptable(scene: &Scene, state: &State, trial: &Trial, step: &Step<'_>) -> Result<f64> {
    let time = step.interval.time;
    let overflow = |what: &'static str| Err(Error::Overflow { time, what });
    let (Solution { pressure, motions, .. }, rows) = (&trial.solution, state.region.rows());
    if !motions.iter().flat_map(|motion| motion.0).all(f64::is_finite) {
        return overflow("the approach");
    }
    let sum_of_pressure = rows.sum(pressure);
    let pressures = state.region.images() as f64 * sum_of_pressure;
    let force = scene.grid.cell_area() * pressures;
    if !force.is_finite() {
        return overflow("the force");
    }
    // no moment is greater than the moment of the whole force at the end of the longer side
    let arm = scene.grid.lengths().into_iter().fold(0.0, f64::max);
    if !(arm * pressures.max(force)).is_finite() {
        return overflow("the moment of the force");
    }
    if scene.settings.edge == Edge::Refuse {
        let cells = state.region.positive_on_edge(pressure, scene.kernel.periodic_axes());
        if cells > 0 {
            return Err(Error::ContactAtEdge { time, cells });
        }
    }
    if !rows.sum(state.history.trial()).is_finite() {
        return overflow("the displacement");
    }
    Ok(sum_of_pressure)
}
