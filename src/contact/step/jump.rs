//! Jumps of the load on bodies without elastic response.

use std::ops::Range;

use crate::contact::state::State;
use crate::contact::step::initial_guess::{begin, fill_guess};
use crate::contact::step::request::{Step, Trial};
use crate::contact::window::window::Window;
use crate::error::{Error, Result};
use crate::geometry::Gap;
use crate::solver::PENETRATION_SLACK;
use crate::sum::named_sums;

/// Rounding of the gap of a cell, relative to the numbers that it is the sum of.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Writes the end of a jump to the trial where the compliance of the step is 0, so that the displacement stays: with the
/// pressure as it is if that satisfies the loads, else with none if none is needed. Other loads are rejected.
pub(super) fn jump_without_response(
    state: &State,
    window: &mut Window,
    trial: &mut Trial,
    step: &Step<'_>,
) -> Result<()> {
    begin(state, trial, step);
    let initial = window.gap(&step.indenter);
    let greatest = |pressed: bool| {
        let residuals = (0..step.loads.len()).map(|body| residual(state, initial, trial, step, body, pressed));
        residuals.fold(0.0, f64::max)
    };
    let as_it_is = greatest(true);
    if as_it_is <= step.tolerance {
        fill_guess(state, window, trial, |now, _| now);
        trial.solution.residual = as_it_is;
    } else if greatest(false) <= step.tolerance {
        trial.solution.release();
    } else {
        let what = "a jump of the load that changes the pressure (ramp the load over a short time instead)";
        return Err(Error::NoElasticResponse { time: step.interval.time, what });
    }
    Ok(())
}

/// How far `body`, pressed as it is or not at all, is from satisfying its load without any change of the displacement: gap
/// and penetration relative to the displacement in contact, force and moments relative to the force.
fn residual(state: &State, initial: &Gap, trial: &Trial, step: &Step<'_>, body: usize, pressed: bool) -> f64 {
    let freedom = trial.free[body];
    let (modes, motion) = (state.region.modes(freedom), trial.solution.motions[body]);
    let released = freedom.translation && freedom.total == 0.0;
    let prescribed = step.prescribed(body).approach.abs() + initial.datum.abs();
    let own = |&k: &usize| initial.owner(k) == body && initial.above[k].is_finite();
    let part = |band: Range<usize>| {
        let mut sums = Misfit::default();
        for k in band.filter(own) {
            let p = if pressed { state.current.solution.pressure[k] } else { 0.0 };
            let (u, moved) = (state.history.trial()[k], modes.displacement(motion, k));
            let h = trial.gap[k] - moved;
            if !h.is_finite() {
                sums.penetration = f64::INFINITY;
                continue;
            }
            let rounding = ROUNDING * (prescribed + initial.above[k] + u.abs() + trial.gap[k].abs() + moved.abs());
            if p > 0.0 {
                let (distance, [mode0, mode1, mode2]) = ((h.abs() - rounding).max(0.0), modes.at(k));
                sums.cells += 1.0;
                sums.distance += distance * distance;
                sums.displacement += u * u;
                sums.pressure += p;
                sums.mode0 += p * mode0;
                sums.mode1 += p * mode1;
                sums.mode2 += p * mode2;
            } else if !released {
                sums.penetration = sums.penetration.max(-h - rounding);
            }
        }
        sums.numbers()
    };
    let sums = Misfit::of(state.region.rows().merge(part, Misfit::joined));
    let (penetration, balance) = (sums.penetration, [sums.mode0, sums.mode1, sums.mode2]);
    if penetration == f64::INFINITY {
        return penetration;
    }
    let force = sums.pressure.max(freedom.total);
    let imbalance = (0..3).map(|m| (balance[m] - modes.load()[m] * freedom.total).abs() / force);
    let root_mean = |sum: f64| (sum / f64::max(sums.cells, 1.0)).sqrt();
    let distance = root_mean(sums.distance).max(penetration / PENETRATION_SLACK) / root_mean(sums.displacement);
    // nothing over nothing is nothing, but numbers that left their range satisfy no load
    let parts =
        imbalance.filter(|_| force > 0.0).chain([distance].into_iter().filter(|_| sums.distance + penetration > 0.0));
    parts.fold(0.0, |most, part| if part.is_nan() { f64::INFINITY } else { part.max(most) })
}

named_sums! {
    /// Sums over the cells of a body: how far the last state is from a solution of the step.
    Misfit[8] {
        /// Cells in contact.
        cells: +,
        /// Σ h² over these.
        distance: +,
        /// Σ u² over these.
        displacement: +,
        /// Σ p, and Σ p B for each mode B of the motion.
        pressure: +,
        mode0: +,
        mode1: +,
        mode2: +,
        /// The deepest penetration of the others.
        penetration: max,
    }
}
