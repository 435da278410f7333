//! What the error of a step depends on, besides the step, and the tolerance of its solver.

use crate::contact::{Computation, Scene, State, Step};
use crate::equilibrium::DEFAULT_TOLERANCE;
use crate::equilibrium::pressed::Pressed;
use crate::error::Result;
use crate::extent::Extent;
use crate::hereditary::{ERROR_FACTORS, Interval, Meeting, Outlook};
use crate::run::control::Course;
use crate::run::step_control::StepControl;
use crate::run::track::is_held;
use crate::solver::Freedom;

/// Error of the solver relative to that in time.
const SOLVER_SHARE: f64 = 0.03;
/// The same for surfaces that attract each other, whose passes end at up to a hundred tolerances of the solver.
const SHARE_OF_PASSES: f64 = 0.03;
/// An error of the solver counts so many times as much as its response to the surface that the body meets later: the
/// errors of many steps add up.
const SOLVER_ON_MEETING: f64 = 3.0;
/// The solver attains this tolerance in all scenes.
const LEAST_TOLERANCE: f64 = 1e-10;

impl StepControl {
    /// Tolerance of the solver that suits the tolerance in time, where no prescribed approach is to come. A tolerance
    /// of the settings that is stricter than the default was asked for, and counts if it is stricter than that, too.
    pub(super) fn solver_tolerance(&self, scene: &Scene) -> f64 {
        let share = if scene.ground.attraction.is_some() { SHARE_OF_PASSES } else { 1.0 } * SOLVER_SHARE;
        let own = scene.ground.settings.tolerance;
        if own < DEFAULT_TOLERANCE { own } else { own.max(share * self.tolerance) }
    }

    /// Tolerance of the solver in a step, at most its own: where a given approach is to come, the bodies respond to
    /// an error of u by more than in the steps that leave it.
    pub(super) fn solver_tolerance_before_meeting(&self, scene: &Scene, step: &Step<'_>, outlook: &Outlook) -> f64 {
        let Step { interval: Interval { time, dt, .. }, tolerance, .. } = *step;
        let stiffness = self.tracks.iter().map(|track| track.scale.stiffness_after(time)).fold(0.0, f64::max);
        let answer = SOLVER_ON_MEETING * stiffness * scene.material.contact_compliance(dt);
        tolerance.min((tolerance / answer.max(outlook.on_switch[1])).max(LEAST_TOLERANCE))
    }

    /// Context of a step from a state, with a kink of the displacement to come at `kink`.
    pub(super) fn outlook(
        &self,
        scene: &Scene,
        State { clock, .. }: &State,
        step: &Step<'_>,
        Course { histories, until, .. }: &Course<'_>,
        kink: f64,
    ) -> Result<Outlook> {
        let Interval { time, reduced, .. } = step.interval;
        let bodies = || self.tracks.iter().zip(step.loads);
        let age = reduced - clock.undisturbed_until;
        let end = scene.reduced_time(clock, kink.min(*until))?;
        let span = end - self.since;
        let resolution = ERROR_FACTORS.shortest * self.tolerance * span;
        let on_switch = self.on_switch(scene, step.interval, age, resolution)?;
        let soon = 1.0 / scene.material.contact_compliance(resolution);
        let meetings = bodies().map(|(track, load)| track.scale.coming_back(scene, load, age, time));
        let meeting = meetings.reduce(Meeting::worst).unwrap_or(Meeting::NONE);
        let expected = bodies().map(|(track, load)| track.scale.expected(scene, load, age));
        let greatest = || bodies().map(|(track, _)| track.scale.greatest_potential()).fold(0.0, f64::max);
        Ok(Outlook {
            expected: expected.fold([0.0; 2], |[a, b], [c, d]| [f64::max(a, c), f64::max(b, d)]),
            meeting: Meeting { stiffness: meeting.stiffness.max(soon), ..meeting },
            lasting: self.past.lasting(),
            on_switch,
            greatest_on_switch: if on_switch[1] > 0.0 { greatest() } else { 0.0 },
            is_last: time == kink && !histories.each().all(|history| is_held(history, clock.time, time)),
            agreement: self.past.agreement(),
            steps: self.past.count() + 1.0,
            resolution,
            beginning: ERROR_FACTORS.shortest * self.tolerance * span.min(self.past.shortest_time()),
            length_is_given: false,
        })
    }

    /// What a unit of a defect of v has become of the error of u, over the glassy compliance, when a given force is
    /// next followed by a given approach, under which the error of u counts: by a defect in this step alone, and in
    /// all steps since the load acts, its `age`. Bodies without elastic response have the compliance of a `touch`.
    fn on_switch(&self, scene: &Scene, Interval { time, dt, .. }: Interval, age: f64, touch: f64) -> Result<[f64; 2]> {
        let switches = self.tracks.iter().map(|track| track.scale.next_switch(time));
        let switch = switches.fold(f64::INFINITY, f64::min);
        if switch.is_infinite() {
            return Ok([0.0; 2]);
        }
        let left = scene.reduced_length(time, switch, switch - time)?;
        let compliance = |t: f64| scene.material.contact_compliance(t);
        let glassy = if compliance(0.0) > 0.0 { compliance(0.0) } else { compliance(touch) };
        let responses = [dt, age].map(|length| (compliance(left + length) - compliance(left)) / glassy);
        Ok(responses.map(|response| response * (ERROR_FACTORS.most_on_switch / responses[1]).min(1.0)))
    }
}

/// By how much the error of a step of length `dt` exceeds its estimate: after a corner of the temperature, and where
/// a body is free to tilt on a small contact, whose errors are greater by its lever at the end of the grid. Where
/// cells leave on one side, errors ±e at the outer cells of the contact, w apart, are a tilt by 2e/w, and e L/w at
/// the ends of a grid of length L.
pub(super) fn excess(scene: &Scene, tried: &Computation, dt: f64) -> f64 {
    let clock = &tried.state.clock;
    let corner = scene.temperature.as_ref().and_then(|history| history.next_corner(clock.time.next_down()));
    let is_turn = clock.last_dt > 0.0 && corner == Some(clock.time);
    let of_turn = if is_turn { ERROR_FACTORS.at_turn * (clock.last_dt / dt).max(1.0) } else { 1.0 };
    let tilts = tried.trial.free.iter().any(Freedom::tilts);
    let Pressed { cells, reach, .. } = if tilts { tried.pressed(scene) } else { Pressed::default() };
    let leave = tried.state.held.region.images() * cells < tried.state.held.current.contact_cells;
    let lever = |Extent { low, high }: Extent| {
        let lever = |axis: usize| {
            let (length, width) = (scene.ground.grid.cells()[axis] as f64, (high[axis] - low[axis]) as f64);
            if leave { length / width.max(1.0) } else { 0.5 * length / (width + 1.0) }
        };
        lever(0).max(lever(1)).max(1.0)
    };
    of_turn * reach.map_or(1.0, lever)
}
