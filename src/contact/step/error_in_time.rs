//! The estimated error in time of a step that was tried.

use crate::contact::computation::Computation;
use crate::contact::scene::Scene;
use crate::contact::request::Step;
use crate::contact::settings::TimeRule;
use crate::contact::window::growth::motion_tried;
use crate::hereditary::{ErrorMeasure, TimeError};

/// A direct sum assigns an increment to one end of its step: on average it answers it half a step too early or too late.
const SHARE_OF_DIRECT_SUM: f64 = 0.5;

/// Displacements below this part of the greatest are measured relative to that part.
const SMALL: f64 = 0.05;

/// The estimated error in time of the step that was `tried`, relative to the displacement, or to a small part of the greatest
/// so far, or of those of displacement and v that are `expected`; `agreement` is how far the defects of the run agree in sign.
pub(in crate::contact) fn error_in_time(
    scene: &Scene,
    tried: &Computation,
    step: &Step<'_>,
    expected: [f64; 2],
    agreement: f64,
) -> TimeError {
    let (Computation { state, trial, .. }, interval) = (tried, step.interval);
    if interval.dt == 0.0 || interval.stride != [0; 2] {
        return TimeError::default();
    }
    let least = [0, 1].map(|which| SMALL * expected[which].max(state.greatest[which]));
    let compliance = |t: f64| scene.material.contact_compliance(t);
    let (pressure, before) = (&trial.solution.pressure, &state.current.solution);
    if let TimeRule::Rectangle | TimeRule::Backward = scene.settings.time_rule {
        let (mut change, mut size, mut sum) = (0.0, 0.0, 0.0);
        let fields = pressure.iter().zip(state.history.trial()).zip(trial.solution.potential.iter().zip(&before.potential));
        for ((&p, &u), (&v, &old)) in fields {
            (change, size, sum) = (change + p * (v - old).abs(), size + p * u.abs(), sum + p);
        }
        let creep = compliance(interval.dt) - compliance(0.0);
        let over = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        let relative = SHARE_OF_DIRECT_SUM * creep * over(change, size.max(least[0] * sum));
        return TimeError { relative, sizes: [over(size, sum), 0.0], defect: [0.0; 2] };
    }
    let age = state.clock.time - state.clock.undisturbed_until;
    let (old, young) = (compliance(age + interval.dt), compliance(interval.dt));
    let amplification = if young > 0.0 { (old / young).max(1.0) } else { 1.0 };
    let pressure = [&pressure[..], &before.pressure, &state.previous.solution.pressure];
    let forces = trial.free.iter().filter(|freedom| freedom.translation).count();
    let matters = [forces > 0, forces < trial.free.len()];
    let gap = tried.window.gap(&step.indenter);
    let advance = |k: usize| {
        let body = gap.owner(k);
        let end = motion_tried(&state.region, trial, step, body);
        let mut advance = end;
        let start = state.current.motions[body];
        advance.approach += step.indenter.gap().datum - start.approach;
        (0..2).for_each(|axis| advance.tilt[axis] -= start.tilt[axis]);
        advance.at(state.region.center(k))
    };
    let potential = &trial.solution.potential;
    let measure = ErrorMeasure { pressure, potential, matters, least, advance: &advance, amplification, agreement };
    state.history.time_error(measure)
}
