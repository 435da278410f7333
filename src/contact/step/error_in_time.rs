//! The estimated error in time of a step that was tried.

use std::ops::Range;

use crate::contact::{Computation, Scene, State, Step};
use crate::equilibrium::spring::share_of_force;
use crate::hereditary::{ErrorMeasure, Outlook, TimeError};
use crate::load::Load;
use crate::solver::RigidMotion;
use crate::sum;
use crate::sum::greatest;

impl Computation {
    /// Whether a free body was pressed by nothing before the step tried.
    fn was_at_rest(&self, body: usize) -> bool {
        let Computation { state, trial, .. } = self;
        let released =
            matches!(state.held.loads[body], Load::Force { normal: 0.0, .. }) || state.held.current.contact_cells == 0;
        released && trial.free[body].translation
    }

    /// Weights of the errors: the pressure at the end of the step tried, at its start, and at the start of the
    /// step before, or the net traction where surfaces attract each other.
    fn weights(&self) -> [&[f64]; 3] {
        let Computation { state, trial, attracted, .. } = self;
        let solutions = [&trial.solution, &state.held.current.solution, &state.previous.solution];
        attracted.as_ref().map_or(solutions.map(|solution| &solution.pressure[..]), |own| own.weights())
    }

    /// By how much the body above a cell advances in the step tried. A body that nothing pressed `rests_at` such an
    /// approach, from the datum of the gap; NaN if that is not known. One that a spring lowers onto the surface
    /// advances at the rate that it has from then on.
    fn advance(&self, step: &Step<'_>, rests_at: Option<f64>, k: usize) -> f64 {
        let Computation { state, window, trial, .. } = self;
        let body = window.gap(&step.indenter).owner(k);
        let end = trial.motion(&state.held.region, step.request(), body);
        if self.was_at_rest(body) {
            let advance =
                |start: f64| (end.at(state.held.region.center(k)) - start) / self.since_touch(step, body, start);
            return rests_at.map_or(f64::NAN, advance);
        }
        let start = state.held.current.motions[body];
        let approach = step.indenter.gap().datum + end.approach - start.approach;
        let tilt = [0, 1].map(|axis| end.tilt[axis] - start.tilt[axis]);
        RigidMotion { approach, tilt }.at(state.held.region.center(k))
    }

    /// The part of the step tried in which a body touches a surface at this approach, from the datum of the gap: all
    /// of it where it lies on the surface. A body apart is where the far end of its spring is.
    fn since_touch(&self, step: &Step<'_>, body: usize, surface: f64) -> f64 {
        let (start, surface) = (self.state.held.current.motions[body].approach, step.indenter.gap().datum + surface);
        match step.loads[body] {
            Load::Spring { drive, .. } if drive > surface && surface > start => (drive - surface) / (drive - start),
            _ => 1.0,
        }
    }
}

/// The approach at which a body would touch the surface at the start of a step, from the datum of its gap.
fn first_touch(tried: &Computation, gap: &[f64]) -> f64 {
    let surface = gap.iter().zip(tried.state.history.displacement()).map(|(gap, u)| gap + u);
    tried.state.held.region.rows().least(surface.fold(f64::INFINITY, f64::min))
}

/// Displacements, and v, below this part of the largest are measured relative to that part.
const SMALL: [f64; 2] = [0.05, 0.2];

/// The means of displacement and v that errors are relative to at least.
pub(crate) fn least_sizes(state: &State, outlook: &Outlook) -> [f64; 2] {
    [0, 1].map(|which| SMALL[which] * outlook.expected[which].max(state.greatest[which]))
}

/// The estimated error in time of the step that was `tried`: under a given force relative to the mean displacement in
/// contact, under a given motion to the mean of v = K p, both weighted by the pressure. Where they are small, it is
/// relative to the parts [`SMALL`] of the largest of the run, expected ones included.
pub(crate) fn error_in_time(scene: &Scene, tried: &Computation, step: &Step<'_>, outlook: &Outlook) -> TimeError {
    let Outlook { expected, on_switch: [one, all], agreement, steps, length_is_given, .. } = *outlook;
    let (Computation { state, trial, .. }, interval) = (tried, step.interval);
    if interval.dt == 0.0 || interval.stride != [0; 2] {
        return TimeError::default();
    }
    let greatest = [0, 1].map(|which| expected[which].max(state.greatest[which]));
    let least = least_sizes(state, outlook);
    let compliance = |t: f64| scene.material.contact_compliance(t);
    let age = state.clock.age();
    let (old, young) = (compliance(age + interval.dt), compliance(interval.dt));
    // so many steps cannot add up to more than as many times the error of one
    let amplified = |one: f64, all: f64| if one > 0.0 { (all / one).clamp(1.0, steps.max(1.0)) } else { 1.0 };
    let forces = trial.free.iter().filter(|freedom| freedom.translation).count();
    // an attraction pulls at a surface whose displacement is free
    let attracted = scene.ground.attraction.is_some();
    let is_given = forces < trial.free.len() || attracted;
    let c = state.history.rule().compliance();
    let of_force = if is_given { 1.0 } else { share_of_force(&scene.ground, &state.held, step.request(), c) };
    let matters = [if forces > 0 || attracted { 1.0 } else { 0.0 }, of_force];
    let gap = &tried.window.gap(&step.indenter).above;
    let was_at_rest = trial.free.len() == 1 && tried.was_at_rest(0);
    let rests_at = was_at_rest.then(|| first_touch(tried, gap));
    let from_rest = rests_at.is_some_and(|start| tried.since_touch(step, 0, start) == 1.0);
    let advance = |k: usize| tried.advance(step, rests_at, k);
    let measure = ErrorMeasure {
        rows: &state.held.region.rows(),
        pressure: tried.weights(),
        potential: &trial.solution.potential,
        matters,
        greatest,
        least,
        gap,
        from_rest,
        advance: &advance,
        amplification: amplified(young, old),
        on_switch: one * (1.0 + agreement * (amplified(one, all) - 1.0)),
        give: if is_given { 0.0 } else { outlook.meeting.give },
        context: outlook,
    };
    let error = state.history.time_error(measure);
    if !length_is_given || forces == 0 {
        return error;
    }
    TimeError { relative: error.relative.max(first_step_error(scene, tried, step, least[0])), ..error }
}

/// The mean of the compliance over a step is the sum of trapezia between so many times, each 1/√2 of the one before.
const TIMES: i32 = 60;
/// The approach of a paraboloid under a given force is this power of the compliance; of a punch, the first.
const POWER: f64 = 2.0 / 3.0;

/// The error of the displacement, relative to its mean in contact, of the first step after a jump or a corner of the
/// load.
///
/// To a v that jumps by V₀ at the start of the step, and changes by V₁ on it, undisturbed bodies respond with C(Δ)
/// V₀ + C̄ V₁, where C̄ is the mean of C over the step, and the rule with responses of its own. Means over the
/// contact, weighted by the pressure. The creep of what pressed the bodies before is taken to be followed.
pub(super) fn first_step_error(scene: &Scene, tried: &Computation, step: &Step<'_>, least: f64) -> f64 {
    let (Computation { state, trial, .. }, dt) = (tried, step.interval.dt);
    let Some([held, grown]) = state.history.rule().first_step_responses() else {
        return 0.0;
    };
    let jumped = state.clock.last_dt == 0.0;
    let [now, before] = [&state.held.current, &state.previous].map(|ends| &ends.solution.potential);
    let ([pressure, ..], potential, displacement) =
        (tried.weights(), &trial.solution.potential, state.history.tried_displacement());
    // products of great pressures and displacements would overflow
    let rows = state.held.region.rows();
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
