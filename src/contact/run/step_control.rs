//! The length of steps chosen by an estimate of their error.

use crate::contact::run::drift::Drift;
use crate::contact::run::run_scale::RunScale;
use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::contact::step::error_in_time::Outlook;
use crate::error::Result;
use crate::hereditary::{ExponentialRule, LastingError, TimeError};
use crate::load::{Load, LoadHistory, Tilt};

/// Chooses steps whose error stays below the tolerance: the error of the displacement within the step
/// ([`History::time_error`](crate::hereditary::History::time_error)), and the error of the load, which is taken to be the polynomial
/// through its values at the last three nodes and the end of the step.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct StepControl {
    pub(super) tolerance: f64,
    /// Length of the next step, as all lengths and times here in reduced time; `None` where earlier steps do not suggest one.
    next: Option<f64>,
    /// Error over tolerance of the last step accepted.
    last: f64,
    /// Times and loads of the last nodes since the last jump or corner, the newest first.
    nodes: Vec<(f64, Load)>,
    /// Length of the last step before a corner, and what the load would change by in a (reduced) second had it gone on straight.
    corner: Option<(f64, f64)>,
    scale: Option<RunScale>,
    drift: Option<Drift>,
    /// The mean errors of u that the steps so far have left, in contact and outside.
    lasting: Option<[LastingError; 2]>,
    /// Steps accepted, and the time of the last jump or corner.
    steps: u64,
    since: f64,
    /// Steps that were rejected.
    pub(super) rejected: u64,
}

/// Bounds of the change of the step length; beyond 1 + √2 an immediate dashpot needs steps of lower order.
const MAX_GROWTH: f64 = 3.0;
const MAX_GROWTH_OF_DASHPOT: f64 = 2.4;
const MAX_SHRINKAGE: f64 = 0.2;
/// Safety factor of the step length.
const SAFETY: f64 = 0.9;
/// Exponents of the integral and the proportional control of an error that grows with the step, over its order (Hairer, Wanner,
/// *Solving Ordinary Differential Equations II*, IV.2).
const INTEGRAL: f64 = 0.7;
const PROPORTIONAL: f64 = 0.2;
/// Error of the solver relative to that in time.
const SOLVER_SHARE: f64 = 0.03;
/// The first step after a jump is chosen from the material alone: this many lengths per decade are tried, ...
const LENGTHS_PER_DECADE: i32 = 4;
/// ... over this many decades below the time that is left.
const DECADES: i32 = 40;
/// A body without elastic response has no shortest time: its first step is this fraction of the time left.
const FIRST_FRACTION: f64 = 1e-6;
/// Events shorter than this part of the time between corners, times the tolerance, do not matter.
const SHORTEST: f64 = 0.03;
/// Where loads are looked at within a step: unevenly, so that no oscillation hits a zero at all of them.
const SHARES: [f64; 5] = [0.153, 0.381, 0.5, 0.677, 0.891];
/// Nodes that a quadratic and its correction go through, besides the end of the step.
const NODES: usize = 3;

impl StepControl {
    pub(super) fn new(tolerance: f64) -> StepControl {
        let nodes = Vec::with_capacity(NODES + 1);
        StepControl {
            tolerance,
            next: None,
            last: 1.0,
            nodes,
            corner: None,
            scale: None,
            drift: None,
            lasting: None,
            steps: 0,
            since: 0.0,
            rejected: 0,
        }
    }

    /// Whether a run can be continued with it: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        self.nodes.len() <= NODES
            && self.nodes.windows(2).all(|pair| pair[0].0 > pair[1].0)
            && self.nodes.iter().all(|(time, load)| time.is_finite() && load.validate().is_ok())
            && self.drift.as_ref().is_none_or(Drift::fits)
            && self.lasting.iter().flatten().all(LastingError::fits)
            && self.scale.as_ref().is_none_or(RunScale::fits)
    }

    /// At a jump of the load.
    pub(super) fn jump(&mut self) {
        (self.next, self.last, self.corner) = (None, 1.0, None);
        self.nodes.clear();
    }

    /// At a corner of the load, which is the end of the last step.
    fn corner(&mut self) {
        let slope = match self.nodes[..] {
            [(end, load), (start, before), ..] => {
                let scale = self.scale.as_ref();
                let [load, before] = [load, before].map(|load| scale.map_or(0.0, |scale| scale.magnitude(&load)));
                Some((end - start, (load - before) / (end - start)))
            }
            _ => None,
        };
        self.jump();
        self.corner = slope;
    }

    /// After a step of length `dt` to `load` at `time`, which was `wanted` longer but had to end at a stop, perhaps a corner.
    pub(super) fn accept(&mut self, time: f64, load: Load, [wanted, dt]: [f64; 2], at_corner: bool, order: u32) {
        if self.nodes.first().is_some_and(|(_, last)| !last.is_like(&load)) {
            self.nodes.clear();
        }
        self.nodes.truncate(NODES - 1);
        self.nodes.insert(0, (time, load));
        if at_corner {
            self.corner();
        } else if dt < 0.99 * wanted && self.last * (wanted / dt).powi(order as i32) <= 1.0 {
            self.next = self.next.map(|next| next.max(wanted));
        }
    }

    /// Shortens a step that the solver could not solve to a fifth.
    pub(super) fn shorten(&mut self, dt: f64) {
        self.next = Some(MAX_SHRINKAGE * dt);
        self.rejected += 1;
    }

    /// The tolerance of the solver that matches that in time.
    pub(super) fn solver_tolerance(&self, wanted: f64) -> f64 {
        wanted.max(SOLVER_SHARE * self.tolerance)
    }

    /// Prepares for a step from `state`: the sizes of the run are known, and the load there is a node.
    pub(super) fn begin(&mut self, scene: &Scene, state: &State, history: &dyn LoadHistory, until: f64) -> Result<()> {
        let (now, reduced) = (state.clock.time, state.clock.reduced_time);
        if self.nodes.is_empty() {
            self.nodes.push((reduced, history.at(now).validated_at(now)?));
            self.since = reduced;
        }
        if self.scale.is_none() {
            self.scale = Some(RunScale::new(scene, state, history, until)?);
        }
        self.scale.iter_mut().for_each(|scale| scale.include(&state.loads[0]));
        if self.drift.is_none() {
            self.drift = scene.material.contact_spectrum()?.map(|creep| Drift::new(&creep));
        }
        Ok(())
    }

    /// Takes account of the defects of a step that is to be accepted; `is_given` is true if a motion is given.
    pub(super) fn include(&mut self, rule: Option<&ExponentialRule>, dt: f64, error: &TimeError, is_given: bool) {
        self.steps += 1;
        self.drift.iter_mut().for_each(|drift| drift.include(dt, error.defect));
        let Some(rule) = rule else { return };
        let [contact, surface] = self.lasting.get_or_insert_with(|| [(); 2].map(|()| LastingError::none(rule)));
        contact.include(rule, error.defect[0], is_given);
        surface.include(rule, error.surface, false);
    }

    /// The time before `stop` at which the bodies first touch, as far as the load alone determines it.
    pub(super) fn first_touch(&self, state: &State, history: &dyn LoadHistory, stop: f64) -> f64 {
        let scale = self.scale.as_ref().filter(|_| state.is_undisturbed());
        scale.map_or(f64::INFINITY, |scale| scale.first_touch(history, state.clock.time, stop))
    }

    /// What is known of the run at a step under `load` that ends `now`, when the bodies have been pressed for `age`, before a
    /// corner or the end of the run at `stop`.
    pub(super) fn outlook(&self, scene: &Scene, load: &Load, [now, age, stop]: [f64; 3]) -> Outlook {
        let span = stop - self.since;
        let shortest = self.drift.as_ref().map_or(f64::INFINITY, Drift::shortest_time);
        Outlook {
            expected: self.scale.as_ref().map_or([0.0; 2], |scale| scale.expected(scene, load, age)),
            coming_back: self.scale.as_ref().map_or(0.0, |scale| scale.coming_back(scene, load, [age, now])),
            lasting: self
                .lasting
                .as_ref()
                .map_or([0.0; 2], |errors| errors.each_ref().map(LastingError::of_displacement)),
            tolerance: self.tolerance,
            agreement: self.drift.as_ref().map_or(1.0, Drift::agreement),
            steps: self.steps as f64 + 1.0,
            resolution: SHORTEST * self.tolerance * span,
            beginning: SHORTEST * self.tolerance * span.min(shortest),
            is_given: false,
        }
    }

    /// The length to try next, at most `left`, and the same in reduced time.
    pub(super) fn length(
        &self,
        scene: &Scene,
        state: &State,
        history: &dyn LoadHistory,
        left: f64,
    ) -> Result<[f64; 2]> {
        let clock = &state.clock;
        if let Some(next) = self.next {
            return Ok([scene.length_of(clock, next, left)?, next]);
        }
        let first = self.first(scene, state, history, left)?.min(left);
        Ok([first, scene.reduced_length([clock.time, clock.time + first], first)?])
    }

    /// The length of the first step after a jump or a corner: the longest over which the creep is linear to within the
    /// tolerance. After a corner, the bodies creep under the load's departure from its course before.
    fn first(&self, scene: &Scene, state: &State, history: &dyn LoadHistory, left: f64) -> Result<f64> {
        let (now, jumped) = (state.clock.time, state.clock.last_dt == 0.0);
        // the approach of a paraboloid grows with the power 2/3 of force and compliance
        let compliance = |t: f64| scene.material.contact_compliance(t).powf(2.0 / 3.0);
        let glassy = compliance(0.0);
        if glassy == 0.0 {
            return Ok(FIRST_FRACTION * left);
        }
        let magnitude = |load: &Load| self.scale.as_ref().map_or(0.0, |scale| scale.magnitude(load));
        let held = magnitude(&state.loads[0]);
        let (longest, slope) = match self.corner {
            Some((before, slope)) if !jumped => (scene.length_of(&state.clock, before, left)?, slope),
            _ => (left, 0.0),
        };
        for k in 0..=LENGTHS_PER_DECADE * DECADES {
            let dt = longest * 10f64.powf(-f64::from(k) / f64::from(LENGTHS_PER_DECADE));
            let reduced = scene.reduced_length([now, now + dt], dt)?;
            let creep = compliance(reduced);
            let deviation = if jumped {
                (compliance(0.5 * reduced) - 0.5 * (glassy + creep)) / creep
            } else {
                let load = history.before(now + dt).validated_at(now + dt)?;
                let change = (magnitude(&load) - held - slope * reduced).abs();
                let scale =
                    self.scale.as_ref().map_or(0.0, |scale| scale.of_load(&state.loads[0], &load)).max(held + change);
                0.125 * (creep - glassy) / creep * change / scale.max(f64::MIN_POSITIVE)
            };
            if deviation.abs() <= self.tolerance
                && self.watch(history, [now, now + dt], |time| scene.reduced_time(&state.clock, time))?
                    <= self.tolerance
            {
                return Ok(dt);
            }
        }
        Ok(longest * 10f64.powi(-DECADES))
    }

    /// Whether a body whose approach is given comes no nearer between now and `time` than at these ends.
    pub(super) fn stays_away(&self, history: &dyn LoadHistory, now: f64, time: f64) -> bool {
        let approach = |load: Load| match load {
            Load::Approach { approach, tilt: [Tilt::Fixed(0.0), Tilt::Fixed(0.0)] } => approach,
            _ => f64::NAN,
        };
        let nearest = approach(history.at(now)).max(approach(history.before(time)));
        let mut away = !nearest.is_nan();
        for share in SHARES {
            away &= approach(history.at(now + share * (time - now))) <= nearest;
        }
        away
    }

    /// How far the load strays between now and `time` from the polynomial through its last nodes and that at `time`, relative
    /// to itself or to a fraction of the greatest of the run. Rejects invalid loads of the history.
    pub(super) fn watch(
        &self,
        history: &dyn LoadHistory,
        [now, time]: [f64; 2],
        reduced: impl Fn(f64) -> Result<f64>,
    ) -> Result<f64> {
        let end = history.before(time).validated_at(time)?;
        let mut nodes = [(reduced(time)?, end); NODES + 1];
        let known = self.nodes.len().min(NODES);
        nodes[1..=known].copy_from_slice(&self.nodes[..known]);
        let nodes = &nodes[..=known];
        let start = nodes[known.min(1)].1;
        let scale = self.scale.as_ref().map_or(0.0, |scale| scale.of_load(&start, &end));
        let mut most = 0.0_f64;
        for share in SHARES {
            let between = now + share * (time - now);
            let load = history.at(between).validated_at(between)?;
            let like = load.is_like(&start) && load.is_like(&end);
            most = most.max(if like { load.deviation(reduced(between)?, nodes, scale) } else { f64::INFINITY });
        }
        Ok(most)
    }

    /// Chooses the length of the next step after one of length `dt` with the given error, which grows with such an `order` of
    /// the length; whether that is accepted.
    pub(super) fn judge(&mut self, dt: f64, error: f64, order: u32, dashpot: bool) -> bool {
        let (ratio, order) = ((error / self.tolerance).max(1e-10), f64::from(order));
        let accepted = ratio <= 1.0;
        let factor = if accepted {
            SAFETY * ratio.powf(-INTEGRAL / order) * (self.last / ratio).powf(PROPORTIONAL / order)
        } else {
            SAFETY * ratio.powf(-1.0 / order)
        };
        let growth = if dashpot { MAX_GROWTH_OF_DASHPOT } else { MAX_GROWTH };
        self.next = Some(dt * factor.clamp(MAX_SHRINKAGE, if accepted { growth } else { SAFETY }));
        if accepted {
            self.last = ratio.max(1e-3);
        } else {
            self.rejected += 1;
        }
        accepted
    }
}
