//! Jumps of the load on bodies without elastic response.

use crate::contact::{State, Step};
use crate::equilibrium::guess::{begin, fill_guess};
use crate::equilibrium::{Trial, Window};
use crate::error::{Error, Result, StepError};
use crate::geometry::Gap;
use crate::solver::PENETRATION_SLACK;
use crate::sum::ROUNDING;

/// Writes the end of a jump of compliance 0 to the trial; the displacement stays. The pressure stays if it satisfies
/// the loads, else it vanishes if zero pressure satisfies them. Other loads are rejected.
pub(super) fn hold_through_load_jump(
    state: &State,
    window: &mut Window,
    trial: &mut Trial,
    step: &Step<'_>,
) -> Result<()> {
    begin(&state.held, trial, step.request());
    let initial = window.gap(&step.indenter);
    let greatest = |pressed: bool| {
        let residuals = (0..step.loads.len()).map(|body| residual(state, initial, trial, step, body, pressed));
        residuals.fold(0.0, f64::max)
    };
    let as_it_is = greatest(true);
    if as_it_is <= step.tolerance {
        fill_guess(&state.held, &state.previous.solution, window, trial, |now, _| now);
        trial.solution.residual = as_it_is;
    } else if greatest(false) <= step.tolerance {
        trial.solution.release();
    } else {
        let what = "a jump of the load that changes the pressure";
        return Err(Error::Step(StepError::NoElasticResponse { time: step.interval.time, what }));
    }
    Ok(())
}

/// The residual of the load of `body` at an unchanged displacement, under the present pressure (`pressed`) or none:
/// gap and penetration relative to the displacement in contact, force and moments relative to the force.
fn residual(state: &State, initial: &Gap, trial: &Trial, step: &Step<'_>, body: usize, pressed: bool) -> f64 {
    let freedom = trial.free[body];
    let (modes, motion) = (state.held.region.modes(freedom), trial.solution.motions[body]);
    let released = freedom.translation && freedom.total == 0.0;
    let prescribed = step.request().prescribed(body).approach.abs() + initial.datum.abs();
    let own = |k: usize| initial.owner(k) == body && initial.above[k].is_finite();
    let (rows, u) = (state.held.region.rows(), state.history.tried_displacement());
    let pressure = |k: usize| if pressed { state.held.current.solution.pressure[k] } else { 0.0 };
    let gap = |k: usize| trial.gap[k] - modes.displacement(motion, k);
    let rounding = |k: usize| {
        let moved = modes.displacement(motion, k);
        ROUNDING * (prescribed + initial.above[k] + u[k].abs() + trial.gap[k].abs() + moved.abs())
    };
    let penetration = |k: usize| match gap(k) {
        h if !h.is_finite() => f64::INFINITY,
        _ if released || pressure(k) > 0.0 => 0.0,
        h => -h - rounding(k),
    };
    let deepest = (0..u.len()).filter(|&k| own(k)).map(penetration).fold(0.0, f64::max);
    let penetration = rows.greatest(deepest);
    if penetration == f64::INFINITY {
        return penetration;
    }
    // over cells in contact: their number, Σ h², Σ u², Σ p, and Σ p B for each mode B of the motion
    let [cells, distances, displacements, pressures, mode0, mode1, mode2] = rows.sum_terms(|k| {
        let p = pressure(k);
        (own(k) && p > 0.0).then(|| {
            let (distance, modes) = ((gap(k).abs() - rounding(k)).max(0.0), modes.at(k).map(|mode| p * mode));
            [1.0, distance * distance, u[k] * u[k], p, modes[0], modes[1], modes[2]]
        })
    });
    let balance = [mode0, mode1, mode2];
    let force = pressures.max(freedom.total);
    let imbalance = (0..3).map(|m| (balance[m] - modes.load()[m] * freedom.total).abs() / force);
    let root_mean = |sum: f64| (sum / f64::max(cells, 1.0)).sqrt();
    let distance = root_mean(distances).max(penetration / PENETRATION_SLACK) / root_mean(displacements);
    // 0/0 counts as 0; any other NaN satisfies no load
    let parts =
        imbalance.filter(|_| force > 0.0).chain([distance].into_iter().filter(|_| distances + penetration > 0.0));
    parts.fold(0.0, |most, part| if part.is_nan() { f64::INFINITY } else { part.max(most) })
}
