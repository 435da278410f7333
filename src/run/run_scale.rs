//! What the whole history tells beforehand: the size of loads and displacements, and when it bends, rises and switches.

use crate::contact::{Scene, State};
use crate::equilibrium::window::placement::resting_depth;
use crate::error::{Error, Result, within};
use crate::hereditary::Meeting;
use crate::load::{Load, LoadHistory, Tilt};
use crate::quadrature::bisect;
use crate::run::passage::{Passage, Span};
use crate::run::rises::{Rise, rises};
use crate::run::trace::{bends, looks};

/// Errors of smaller loads and displacements are relative to this fraction of the largest of the run.
const SMALL: f64 = 0.05;
/// Number of equal parts of a history at whose ends it is evaluated before the run, ...
const EQUAL_PARTS: i32 = 64;
/// ... number of times per decade, and of decades before its end, ...
const TIMES_PER_DECADE: i32 = 4;
const DECADES: i32 = 12;
/// ... and maximum number of breakpoints.
const BREAKPOINTS: usize = 1000;
/// Lower limit of the maximum force \[N\] and depth \[m\] of a run. Fractions of smaller values underflow, so that no
/// step would be short enough.
const LEAST: f64 = 1e-290;
/// The force of a circular contact over its depth is this part of its response to a small change of the depth.
const SECANT: f64 = 2.0 / 3.0;

/// Scale of small values in a run: the maximum loads of its history, and an estimate of the displacement that they
/// cause. At first touch, when bodies part, or under a load that starts like a power of time, errors relative to the
/// state alone would never become small.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct RunScale {
    /// The time up to which the history of the run has been looked at; `None` before that.
    known_until: Option<f64>,
    /// Approach at first touch.
    touch: f64,
    /// Whether bodies pull at each other, so that heights above first touch are loads, too.
    pub(super) attracts: bool,
    /// Maximum force.
    force: f64,
    /// Maximum prescribed depth below first touch, of the far end of a spring where there is one, and an estimate of
    /// the largest v that it requires.
    depth: f64,
    stress: f64,
    /// Estimated diameter of the contact under the spring that is driven deepest.
    width: f64,
    /// Estimated final depth under the maximum force, divided by the final compliance.
    depth_over_compliance: f64,
    /// Times at which the load bends, ascending.
    pub(super) bends: Vec<f64>,
    /// Rises of the history, ascending in time.
    rises: Vec<Rise>,
    /// Times at which a given approach or a spring follows a given force, ascending.
    switches: Vec<f64>,
}

/// What a run sees of its load, with both sides of jumps.
fn seen(history: &dyn LoadHistory, now: f64, until: f64, attracts: bool) -> Result<Vec<(f64, f64)>> {
    let mut seen = Vec::new();
    for look in looks(history, now, until, attracts) {
        let (time, [before, at]) = look?;
        let both = [before, at].into_iter().skip(usize::from(before == at));
        seen.extend(both.map(|load| (time, load.main())));
    }
    Ok(seen)
}

impl RunScale {
    /// The scale of a run from `state` along the history of a body to the time `until`. Rejects invalid loads of the
    /// history. Finds how the bodies respond where they meet, to within such a tolerance of the steps.
    pub(super) fn new(
        scene: &Scene,
        state: &State,
        (body, history): (usize, &dyn LoadHistory),
        until: f64,
        tolerance: f64,
    ) -> Result<RunScale> {
        let touch = state.held.indenter.first_touch().get(body).map_or(0.0, |motion| motion.approach);
        let now = state.clock.time;
        let span = until - now;
        let compliance_at = |time: f64| {
            let age = scene.reduced_length(now, time, time - now)?;
            Ok::<_, Error>(scene.material.contact_compliance(age.min(scene.material.known_until())))
        };
        let compliance = compliance_at(until)?;
        let mut scale = RunScale { known_until: Some(until), touch, attracts: state.attracts, ..RunScale::default() };
        let equal = (0..=EQUAL_PARTS).map(|k| now + span * f64::from(k) / f64::from(EQUAL_PARTS));
        let decades = (1..=TIMES_PER_DECADE * DECADES)
            .map(|k| now + span * 10f64.powf(-f64::from(k) / f64::from(TIMES_PER_DECADE)));
        let corners: Vec<f64> = history.breakpoints(now).take_while(|&next| next <= until).take(BREAKPOINTS).collect();
        let seen = seen(history, now, until, state.attracts)?;
        let mut passage = Passage::default();
        scale.bends = bends(&seen);
        passage.show(&seen);
        let mut times: Vec<f64> = equal.chain(corners).chain(passage.turns().map(|turn| turn.0)).collect();
        times.sort_by(f64::total_cmp);
        scale.rises = rises(scene, history, touch, &times)?;
        let mut times: Vec<f64> = times.into_iter().chain(decades).collect();
        times.sort_by(f64::total_cmp);
        let mut loads: Vec<(f64, Load)> = Vec::new();
        for time in times {
            for load in [<dyn LoadHistory>::checked_before, <dyn LoadHistory>::checked_at] {
                let load = load(history, time, state.attracts)?;
                scale.include(&load);
                if !load.is_force() && loads.last().is_some_and(|(_, before)| before.is_force()) {
                    scale.switches.push(time);
                }
                loads.push((time, load));
            }
        }
        scale.include_spring(scene, state, body, compliance, &loads);
        for (time, load) in loads.iter().filter(|(time, load)| !load.is_force() && *time > now) {
            let compliance = compliance_at(*time)? + SECANT * scale.give(load);
            scale.stress = scale.stress.max(scale.magnitude(load) / compliance);
        }
        let large_enough = |size: f64| size == 0.0 || size >= LEAST;
        let allowed = "0, or 1e-290 at least, for adaptive steps: choose other units, or Stepping::fixed";
        within("maximum force of the run", scale.force, large_enough(scale.force), allowed)?;
        within("maximum depth of the run", scale.depth, large_enough(scale.depth), allowed)?;
        if scale.force > 0.0 && compliance > 0.0 {
            scale.depth_over_compliance =
                resting_depth(&scene.ground, &state.held, body, scale.force * compliance) / compliance;
        }
        let most = tolerance * scale.stress;
        scale.rises.iter_mut().for_each(|rise| rise.find_stiffness(scene, most));
        Ok(scale)
    }

    /// Whether the history has been looked at as far as a run goes.
    pub(super) fn knows(&self, until: f64) -> bool {
        self.known_until.is_some_and(|known| known >= until)
    }

    /// The scale of a run that goes on: what has acted so far counts.
    pub(super) fn after(self, before: &RunScale) -> RunScale {
        let [force, depth] = [self.force.max(before.force), self.depth.max(before.depth)];
        let depth_over_compliance = self.depth_over_compliance.max(before.depth_over_compliance);
        RunScale { force, depth, depth_over_compliance, stress: self.stress.max(before.stress), ..self }
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        let sizes = [self.force, self.depth, self.stress, self.width, self.depth_over_compliance];
        !self.touch.is_nan()
            && self.bends.is_sorted()
            && self.rises.iter().all(Rise::fits)
            && sizes.iter().all(|&size| size >= 0.0)
    }

    /// Includes a load that acts.
    pub(super) fn include(&mut self, load: &Load) {
        let magnitude = self.magnitude(load);
        match load {
            Load::Force { .. } => self.force = self.force.max(magnitude),
            Load::Approach { .. } | Load::Spring { .. } => self.depth = self.depth.max(magnitude),
        }
    }

    /// Includes the force of the spring that is driven deepest, by z, in bodies of this `compliance`. Under the force
    /// k z of a spring that stays compressed they would yield by h; spring and bodies in series yield about h
    /// z/(z + h). The force of a paraboloid grows with the power 3/2 of its depth, its width with the root.
    fn include_spring(&mut self, scene: &Scene, state: &State, body: usize, compliance: f64, loads: &[(f64, Load)]) {
        let springs = loads.iter().filter_map(|(_, load)| match load {
            Load::Spring { stiffness, .. } => Some((self.magnitude(load), stiffness)),
            _ => None,
        });
        let deepest = springs.max_by(|(one, _), (other, _)| one.total_cmp(other));
        if let Some((drive, stiffness)) = deepest.filter(|&(drive, _)| drive > 0.0 && compliance > 0.0) {
            let force = stiffness * drive;
            let depth = 2.0 * resting_depth(&scene.ground, &state.held, body, force * compliance);
            let part = drive / (drive + depth);
            self.width = force * compliance / (SECANT * depth) * part.sqrt();
            self.force = self.force.max(force * part.powf(1.5));
        }
    }

    /// The compliance \[1/Pa\] that the spring of a load adds to the compliance of the bodies, as a circular contact
    /// answers a small change of its depth; infinite for a given force.
    fn give(&self, load: &Load) -> f64 {
        match load {
            Load::Force { .. } => f64::INFINITY,
            Load::Approach { .. } => 0.0,
            Load::Spring { stiffness, .. } => self.width / stiffness,
        }
    }

    /// The force, or the prescribed depth below first touch, of the body or of the far end of its spring. 0 while the
    /// bodies are apart: the gap is no scale for the load.
    pub(super) fn magnitude(&self, load: &Load) -> f64 {
        match load {
            Load::Force { normal, .. } => normal.abs(),
            Load::Approach { approach: depth, .. } | Load::Spring { drive: depth, .. } if self.attracts => {
                (depth - self.touch).abs()
            }
            Load::Approach { approach: depth, .. } | Load::Spring { drive: depth, .. } => (depth - self.touch).max(0.0),
        }
    }

    /// The scale of deviations of loads between `start` and `end`.
    pub(super) fn of_load(&self, start: &Load, end: &Load) -> f64 {
        let greatest = if let Load::Force { .. } = end { self.force } else { self.depth };
        self.magnitude(start).max(self.magnitude(end)).max(SMALL * greatest)
    }

    /// Estimated displacement and v under the maximum load of the kind of `load`, in bodies loaded for the time `age`.
    pub(super) fn expected(&self, scene: &Scene, load: &Load, age: f64) -> [f64; 2] {
        match load {
            Load::Force { .. } if self.depth_over_compliance > 0.0 => {
                [self.depth_over_compliance * scene.material.contact_compliance(age), 0.0]
            }
            Load::Force { .. } => [0.0; 2],
            Load::Approach { .. } => [self.depth, self.stress],
            Load::Spring { .. } => [0.5 * self.depth * self.share(scene, load, age), self.stress],
        }
    }

    /// The part of the drive of a spring by which it presses the bodies down, when they have been loaded for the time
    /// `age`.
    fn share(&self, scene: &Scene, load: &Load, age: f64) -> f64 {
        let compliance = scene.material.contact_compliance(age);
        let whole = compliance + SECANT * self.give(load);
        if whole > 0.0 { compliance / whole } else { 1.0 }
    }

    /// Estimated mean v under the maximum loads.
    pub(super) fn greatest_potential(&self) -> f64 {
        self.depth_over_compliance.max(self.stress)
    }

    /// The first time from `now` on at which a given approach follows a given force; infinite if there is none.
    pub(super) fn next_switch(&self, now: f64) -> f64 {
        self.switches.iter().copied().find(|&time| time >= now).unwrap_or(f64::INFINITY)
    }

    /// How bodies that have been loaded for the time `age` may meet again after `now`; to the depth 0 if they do not.
    pub(super) fn coming_back(&self, scene: &Scene, load: &Load, age: f64, now: f64) -> Meeting {
        let own = self.give(load);
        if let Load::Force { .. } = load {
            return Meeting { depth: self.expected(scene, load, age)[0], stiffness: 0.0, give: own };
        }
        let Meeting { depth, stiffness, give } = self.meeting_after(now, |rise| rise.again);
        Meeting { depth: depth * self.share(scene, load, age), stiffness, give: give.min(own) }
    }

    /// The response of v to an error of u when the bodies meet more cells after `now`; 0 if no approach is given then.
    pub(super) fn stiffness_after(&self, now: f64) -> f64 {
        let Meeting { stiffness, give, .. } = self.meeting_after(now, |_| true);
        if stiffness > 0.0 { stiffness / (1.0 + give * stiffness) } else { 0.0 }
    }

    /// Maximum depth and stiffness, and least give, of such rises that end at `now` or later; the depth and the
    /// stiffness are 0 if there are none.
    fn meeting_after(&self, now: f64, is_meant: impl Fn(&Rise) -> bool) -> Meeting {
        let rises = self.rises.iter().filter(|rise| rise.end >= now && is_meant(rise));
        let meeting =
            |&Rise { depth, stiffness, spring, .. }: &Rise| Meeting { depth, stiffness, give: self.width * spring };
        rises.map(meeting).fold(Meeting::NONE, Meeting::worst)
    }

    /// The first top of a prescribed approach, or of the far end of a spring, in a step at which an upright body is
    /// below the undeformed surface. Wherever the surface is by then, a body that is still above it there was so ever
    /// since the start of the step: surfaces that nothing presses recover, and rise.
    pub(super) fn first_top(&self, history: &dyn LoadHistory, passage: &Passage) -> Option<f64> {
        let is_below = |top: f64| approach(&history.at(top)).is_some_and(|approach| approach > self.touch);
        passage.turns().find(|&(time, is_top)| is_top && is_below(time)).map(|turn| turn.0)
    }

    /// The time in a step at which a prescribed approach or a spring first brings undisturbed bodies into contact. The
    /// displacement grows from this time on, as after a corner. Infinite if there is none.
    pub(super) fn first_touch(&self, history: &dyn LoadHistory, passage: &Passage) -> f64 {
        let apart = |time: f64| match history.at(time) {
            Load::Approach { approach: depth, .. } | Load::Spring { drive: depth, .. } => depth < self.touch,
            Load::Force { .. } => true,
        };
        let Span { now, end } = passage.span();
        if matches!(history.at(now), Load::Force { .. }) || !apart(now) {
            return f64::INFINITY;
        }
        let mut last = now;
        for time in passage.inside().map(|point| point.0).chain([end]) {
            if !apart(time) {
                return bisect(last, time, 64, apart)[1];
            }
            last = time;
        }
        f64::INFINITY
    }
}

/// The prescribed approach of an upright body, or of the far end of its spring: of a body that is apart, where it is.
pub(super) fn approach(load: &Load) -> Option<f64> {
    match *load {
        Load::Approach { approach: at, tilt: [Tilt::Fixed(0.0), Tilt::Fixed(0.0)] }
        | Load::Spring { drive: at, tilt: [Tilt::Fixed(0.0), Tilt::Fixed(0.0)], .. } => Some(at),
        _ => None,
    }
}
