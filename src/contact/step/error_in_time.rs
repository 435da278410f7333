//! The estimated error in time of a step that was tried.

use crate::contact::computation::Computation;
use crate::contact::scene::Scene;
use crate::contact::settings::TimeRule;
use crate::hereditary::{ErrorMeasure, Interval, TimeError};

/// A direct sum assigns an increment to one end of its step: on average it answers it half a step too early or too late.
const SHARE_OF_DIRECT_SUM: f64 = 0.5;

/// Displacements below this part of the greatest are measured relative to that part.
const SMALL: f64 = 0.05;

/// The estimated error in time of the step that was `tried`, relative to the displacement, or to a small part of the greatest
/// so far, or of that which is `expected` \[m\].
pub(in crate::contact) fn error_in_time(scene: &Scene, tried: &Computation, step: Interval, expected: f64) -> TimeError {
    let Computation { state, trial, .. } = tried;
    if step.dt == 0.0 || step.stride != [0; 2] {
        return TimeError::default();
    }
    let least = SMALL * expected.max(state.greatest_displacement);
    let compliance = |t: f64| scene.material.contact_compliance(t);
    let (pressure, before) = (&trial.solution.pressure, &state.current.solution);
    if let TimeRule::Rectangle | TimeRule::Backward = scene.settings.time_rule {
        let (mut change, mut size, mut sum) = (0.0, 0.0, 0.0);
        let fields = pressure.iter().zip(state.history.trial()).zip(trial.solution.potential.iter().zip(&before.potential));
        for ((&p, &u), (&v, &old)) in fields {
            (change, size, sum) = (change + p * (v - old).abs(), size + p * u.abs(), sum + p);
        }
        let creep = compliance(step.dt) - compliance(0.0);
        let over = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        let relative = SHARE_OF_DIRECT_SUM * creep * over(change, size.max(least * sum));
        return TimeError { relative, displacement: over(size, sum) };
    }
    let age = state.clock.time - state.clock.undisturbed_until;
    let (old, young) = (compliance(age + step.dt), compliance(step.dt));
    let amplification = if young > 0.0 { (old / young).max(1.0) } else { 1.0 };
    let pressure = [&pressure[..], &before.pressure, &state.previous.solution.pressure];
    state.history.time_error(ErrorMeasure { pressure, least, amplification })
}
