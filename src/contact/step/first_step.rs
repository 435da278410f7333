//! The error in time of a step without steps before it to compare with.

use std::ops::Range;

use crate::contact::computation::Computation;
use crate::contact::scene::Scene;
use crate::contact::step::request::Step;
use crate::sum::{self, greatest};

/// The mean of the compliance over a step is the sum of trapezia between so many times, each 1/√2 of the one before.
const TIMES: i32 = 60;
/// The approach of a paraboloid under a given force is this power of the compliance; of a punch, the first.
const POWER: f64 = 2.0 / 3.0;

/// The error of the displacement, relative to its mean in contact, of the first step after a jump or a corner of the load.
///
/// To a v that jumps by V₀ at the start of the step, and changes by V₁ on it, undisturbed bodies respond with C(Δ) V₀ + C̄ V₁,
/// where C̄ is the mean of C over the step, and the rule with responses of its own. Means over the contact, weighted by the
/// pressure. The creep of what pressed the bodies before is taken to be followed.
pub(super) fn first_step_error(scene: &Scene, tried: &Computation, step: &Step<'_>, least: f64) -> f64 {
    let (Computation { state, trial, .. }, dt) = (tried, step.interval.dt);
    let Some([held, grown]) = state.history.exponential_rule().and_then(|rule| rule.first_step_responses()) else {
        return 0.0;
    };
    let jumped = state.clock.last_dt == 0.0;
    let [now, before] = [&state.current, &state.previous].map(|ends| &ends.solution.potential);
    let (pressure, potential, displacement) =
        (&trial.solution.pressure, &trial.solution.potential, state.history.trial());
    // products of great pressures and displacements would overflow
    let rows = state.region.rows();
    let most = rows.greatest(greatest(pressure));
    let part = |cells: Range<usize>| {
        let (mut sum, mut size, mut jump, mut change) = (0.0, 0.0, 0.0, 0.0);
        for k in cells.filter(|&k| pressure[k] > 0.0) {
            let p = pressure[k] / most;
            (sum, size) = (sum + p, size + p * displacement[k].abs());
            change += p * (potential[k] - now[k]);
            jump += if jumped { p * (now[k] - before[k]) } else { 0.0 };
        }
        [sum, size, jump, change]
    };
    let [sum, size, jump, change] = rows.merge(part, sum::add);
    let compliance = |t: f64| scene.material.contact_compliance(t);
    let time = |k: i32| dt * 2f64.powf(-0.5 * f64::from(k));
    let (mut mean, mut later) = (0.0, compliance(dt));
    for k in 1..TIMES {
        let earlier = compliance(time(k));
        mean += 0.5 * (later + earlier) * (time(k - 1) - time(k)) / dt;
        later = earlier;
    }
    mean += later * time(TIMES - 1) / dt;
    let error = ((compliance(dt) - held) * jump + (mean - grown) * change).abs();
    let whole = size.max(least * sum);
    if error > 0.0 && whole > 0.0 { POWER * error / whole } else { 0.0 }
}
