//! The length of steps in space.

use crate::contact::{Scene, Settings, State};
use crate::error::{Error, Result, StepError};
use crate::hereditary::TimeError;
use crate::load::Load;
use crate::run::error_budget::ErrorBudget;
use crate::run::halves::Halves;
use crate::run::histories::Histories;
use crate::run::passage::Span;
use crate::run::past_steps::PastSteps;
use crate::run::progress::Stepping;
use crate::run::run_scale::RunScale;
use crate::run::track::Track;

/// Controls the steps of a run in space: the one owner of their length. Adaptive steps keep their error below the
/// tolerance. Two errors count: the error of the displacement within the step
/// ([`History::time_error`](crate::hereditary::History::time_error)), and the deviation of the load from the
/// polynomial through its values at the last three nodes and the end of the step.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct StepControl {
    /// Tolerance of adaptive steps; 0 for given ones.
    pub(super) tolerance: f64,
    /// Length of the next step, in reduced time like all lengths and times here; `None` where earlier steps suggest
    /// none.
    next: Option<f64>,
    /// Error over tolerance of the last step accepted.
    last: f64,
    /// The loads of each rigid body.
    pub(super) tracks: Vec<Track>,
    /// The loads at the end of the step under way.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) loads: Vec<Load>,
    pub(super) past: PastSteps,
    /// The time of the last jump or corner.
    pub(super) since: f64,
    /// Number of rejected steps.
    pub(super) rejected: u64,
    /// The maximum errors so far; the errors of fields and of the present mesh are added when the budget is read.
    pub(super) worst: ErrorBudget,
    /// The last step of surfaces that attract each other.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) halves: Option<Box<Halves>>,
}

/// Errors over the tolerance count as this at least, in the step that follows and in those after it: steps of less grow
/// by the most that they may anyway.
const NO_ERROR: [f64; 2] = [1e-10, 1e-3];
/// A step that ends so near a stop ends there.
const NEARLY: f64 = 0.99;
/// Bounds of the change of the step length. Beyond 1 + √2 the order of steps with an immediate dashpot is lower.
const MAX_GROWTH: f64 = 3.0;
const MAX_GROWTH_OF_DASHPOT: f64 = 2.4;
const MIN_GROWTH: f64 = 0.2;
/// Safety factor of the step length.
const SAFETY: f64 = 0.9;
/// Exponents of the integral and the proportional control of an error that grows with the step, over its order
/// (Hairer, Wanner, *Solving Ordinary Differential Equations II*, IV.2).
const INTEGRAL: f64 = 0.7;
const PROPORTIONAL: f64 = 0.2;
/// Lengths per decade tried for the first step after a jump, which is chosen from the material alone, ...
const LENGTHS_PER_DECADE: i32 = 4;
/// ... and decades tried below the remaining time.
const DECADES: i32 = 40;
/// First step of a body without elastic response, as a fraction of the remaining time: such a body has no shortest
/// time.
const FIRST_FRACTION: f64 = 1e-6;
/// Steps of one rounding of the time are accepted within so many of them after a jump or a corner.
const ROUNDINGS: f64 = 1e3;

/// The end of a step to be tried.
#[derive(Debug, Clone, Copy)]
pub(super) struct Proposal {
    pub(super) time: f64,
    /// Length of the step without stops and corners.
    pub(super) wanted: f64,
    /// Whether no step can be shorter.
    pub(super) unresolved: bool,
    pub(super) order: u32,
    /// Whether the body responds by an immediate dashpot.
    dashpot: bool,
}

impl StepControl {
    pub(super) fn new(stepping: Stepping, bodies: usize) -> StepControl {
        let (_, tolerance) = stepping.lengths();
        let (tracks, loads) = ((0..bodies).map(|_| Track::new()).collect(), Vec::with_capacity(bodies));
        StepControl { tolerance, last: 1.0, tracks, loads, ..StepControl::default() }
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        self.tracks.iter().all(Track::fits) && self.past.fits()
    }

    /// Looks at the whole history, once, for adaptive steps. Given steps look at no load but their own.
    pub(super) fn look_ahead(
        &mut self,
        scene: &Scene,
        state: &State,
        histories: &Histories<'_>,
        until: f64,
    ) -> Result<()> {
        if self.tolerance == 0.0 || self.know(until) {
            return Ok(());
        }
        let ahead = histories.each().enumerate();
        let scale = |(body, history)| RunScale::new(scene, state, (body, history), until, self.tolerance);
        let scales = ahead.map(scale).collect::<Result<Vec<_>>>()?;
        if !self.know(f64::NEG_INFINITY) {
            // nothing has been looked at
            self.past = PastSteps::none(&scene.material)?;
        }
        self.tracks.iter_mut().zip(scales).for_each(|(track, scale)| track.scale = scale.after(&track.scale));
        Ok(())
    }

    /// Whether all histories have been looked at up to a time.
    fn know(&self, until: f64) -> bool {
        self.tracks.iter().all(|track| track.scale.knows(until))
    }

    /// Prepares a step from `state`: looks at the history where needed, and makes the present load a node.
    pub(super) fn begin(&mut self, scene: &Scene, state: &State, histories: &Histories<'_>, until: f64) -> Result<()> {
        let (now, reduced) = (state.clock.time, state.clock.reduced_time);
        for (track, history) in self.tracks.iter_mut().zip(histories.each()).filter(|(track, _)| track.nodes.is_empty())
        {
            track.nodes.push((reduced, history.checked_at(now, scene.ground.attraction.is_some())?));
            self.since = reduced;
        }
        self.look_ahead(scene, state, histories, until)?;
        for (body, (track, load)) in self.tracks.iter_mut().zip(&state.held.loads).enumerate() {
            track.scale.include(load);
            let (cells, pressure) = (state.held.current.contact_cells, &state.held.current.solution.pressure);
            let is_apart = cells == 0 || scene.ground.bodies > 1 && !state.held.presses(&scene.ground, pressure, body);
            track.is_apart = is_apart && !state.attracts;
            // a run that begins on bodies that were stepped does not know how their load came: at worst all of it in
            // the last step
            if self.next.is_none() && track.corner.is_none() && state.clock.last_dt > 0.0 {
                track.corner = Some((state.clock.last_dt, track.scale.magnitude(load) / state.clock.last_dt));
            }
        }
        Ok(())
    }

    /// Starts anew at a jump of the load, or at a corner at the end of the last step.
    pub(super) fn anew(&mut self, at: fn(&mut Track)) {
        (self.next, self.last) = (None, 1.0);
        self.tracks.iter_mut().for_each(at);
    }

    /// The next step to try, towards `stop`, shorter than the one `tried` before. An error if no step is short enough.
    pub(super) fn propose(
        &mut self,
        scene: &Scene,
        state: &State,
        histories: &Histories<'_>,
        left: f64,
        stop: f64,
        tried: f64,
    ) -> Result<Proposal> {
        let (clock, now) = (&state.clock, state.clock.time);
        let (length, wanted) = match self.next {
            Some(next) => (scene.length_of(clock, next, left)?, next),
            None => {
                let first = self.first(scene, state, histories, left)?.min(left);
                (first, scene.reduced_length(now, now + first, first)?)
            }
        };
        // a jump may come so late that the creep after it is faster than times are resolved
        let is_late = || {
            let rounding = scene.reduced_time(clock, now.next_up())? - clock.reduced_time;
            Ok::<_, Error>(clock.reduced_time - self.since <= ROUNDINGS * rounding)
        };
        let mut time = towards(now, stop, length);
        if (time <= now || time >= tried) && is_late()? {
            time = tried.next_down().min(time.max(now.next_up()));
        }
        let unresolved = time == now.next_up() && is_late()?;
        // near the resolution of the time, a shortened step may round to the same end again and again
        if time <= now || time >= tried {
            let (dt, tolerance) = (time - now, self.tolerance);
            return Err(Error::Step(StepError::StepTooShort { time: now, dt, tolerance }));
        }
        let (order, dashpot) = order_of(state, &scene.ground.settings);
        Ok(Proposal { time, wanted, unresolved, order, dashpot })
    }

    /// The length of the first step after a jump or a corner: the longest over which the creep is linear to within the
    /// tolerance. After a corner, only the departure of the load from its previous slope makes the bodies creep.
    fn first(&mut self, scene: &Scene, state: &State, histories: &Histories<'_>, left: f64) -> Result<f64> {
        let (clock, now, jumped) = (&state.clock, state.clock.time, state.clock.last_dt == 0.0);
        // the approach of a paraboloid is proportional to force and compliance to the power 2/3
        let compliance = |t: f64| scene.material.contact_compliance(t).powf(2.0 / 3.0);
        let glassy = compliance(0.0);
        if glassy == 0.0 {
            return Ok(FIRST_FRACTION * left);
        }
        let turned = |track: &Track| track.corner.filter(|_| !jumped);
        let before = self.tracks.iter().filter_map(turned).map(|(before, _)| before).reduce(f64::min);
        let longest = before.map_or(Ok(left), |before| scene.length_of(clock, before, left))?;
        for k in 0..=LENGTHS_PER_DECADE * DECADES {
            let dt = longest * 10f64.powf(-f64::from(k) / f64::from(LENGTHS_PER_DECADE));
            let reduced = scene.reduced_length(now, now + dt, dt)?;
            let creep = compliance(reduced);
            let mut deviation = if jumped { (compliance(0.5 * reduced) - 0.5 * (glassy + creep)) / creep } else { 0.0 };
            let bodies = self.tracks.iter().zip(histories.each()).zip(&state.held.loads);
            for ((track, history), start) in bodies.filter(|_| !jumped) {
                let load = history.checked_before(now + dt, scene.ground.attraction.is_some())?;
                let (held, slope) = (track.scale.magnitude(start), turned(track).map_or(0.0, |(_, slope)| slope));
                let change = (track.scale.magnitude(&load) - held - slope * reduced).abs();
                let scale = track.scale.of_load(start, &load).max(held + change);
                // a parabola is off its chord by an eighth of its second difference
                let own = 0.125 * (creep - glassy) / creep * change / scale.max(f64::MIN_POSITIVE);
                deviation = deviation.max(own.abs());
            }
            if deviation.abs() <= self.tolerance {
                self.look(histories, Span { now, end: now + dt })?;
                if self.straying(scene, state, histories, |_| true)? <= self.tolerance {
                    return Ok(dt);
                }
            }
        }
        Ok(longest * 10f64.powi(-DECADES))
    }

    /// Chooses the length of the next step after the one proposed, of length `dt`, with the given error, which grows
    /// with the power `order` of the length. Returns whether the error allows the step.
    pub(super) fn accept_or_shorten(&mut self, Proposal { order, dashpot, .. }: Proposal, dt: f64, error: f64) -> bool {
        // an error that overflows is no number
        let error = if error.is_nan() { f64::INFINITY } else { error };
        let (ratio, order) = ((error / self.tolerance).max(NO_ERROR[0]), f64::from(order));
        let accepted = ratio <= 1.0;
        let factor = if accepted {
            SAFETY * ratio.powf(-INTEGRAL / order) * (self.last / ratio).powf(PROPORTIONAL / order)
        } else {
            SAFETY * ratio.powf(-1.0 / order)
        };
        let growth = if dashpot { MAX_GROWTH_OF_DASHPOT } else { MAX_GROWTH };
        self.next = Some(dt * factor.clamp(MIN_GROWTH, if accepted { growth } else { SAFETY }));
        if accepted {
            self.last = ratio.max(NO_ERROR[1]);
        }
        accepted
    }

    /// Shortens a step to a fifth after the solver has failed to converge.
    pub(super) fn shorten(&mut self, dt: f64) {
        self.next = Some(MIN_GROWTH * dt);
        self.rejected += 1;
    }

    /// Looks at the loads within a step.
    pub(super) fn look(&mut self, histories: &Histories<'_>, span: Span) -> Result<()> {
        self.tracks.iter_mut().zip(histories.each()).try_for_each(|(track, history)| track.look(history, span))
    }

    /// Maximum deviation of the loads in the step from what the step takes them for, of the bodies that count
    /// ([`Track::straying`]).
    pub(super) fn straying(
        &self,
        scene: &Scene,
        state: &State,
        histories: &Histories<'_>,
        counts: impl Fn(&Track) -> bool,
    ) -> Result<f64> {
        let mut bodies = self.tracks.iter().zip(histories.each()).filter(|(track, _)| counts(track));
        bodies.try_fold(0.0_f64, |most, (track, history)| {
            Ok(most.max(track.straying(scene, state, history, self.tolerance)?))
        })
    }

    /// The first time before `stop` at which undisturbed bodies touch, as [`RunScale::first_touch`].
    pub(super) fn first_touch(&mut self, histories: &Histories<'_>, span: Span) -> Result<f64> {
        if !span.end.is_finite() {
            return Ok(f64::INFINITY);
        }
        self.look(histories, span)?;
        let bodies = self.tracks.iter().zip(histories.each());
        Ok(bodies
            .map(|(track, history)| track.scale.first_touch(history, &track.passage))
            .fold(f64::INFINITY, f64::min))
    }

    /// The first top within the step, as [`RunScale::first_top`], of the bodies that count.
    pub(super) fn first_top(&self, histories: &Histories<'_>, counts: impl Fn(usize, &Track) -> bool) -> Option<f64> {
        let bodies = self.tracks.iter().zip(histories.each()).enumerate();
        let tops = bodies.filter(|(body, (track, _))| counts(*body, track));
        tops.filter_map(|(_, (track, history))| track.scale.first_top(history, &track.passage)).reduce(f64::min)
    }

    /// Records an accepted step of length `dt` to `loads` at `time`, as it was proposed.
    pub(super) fn accept(&mut self, time: f64, loads: &[Load], dt: f64, at_corner: bool, proposal: Proposal) {
        let Proposal { wanted, order, .. } = proposal;
        self.tracks.iter_mut().zip(loads).for_each(|(track, load)| track.accept(time, *load));
        if at_corner {
            self.anew(Track::turn);
        } else if dt < NEARLY * wanted && self.last * (wanted / dt).powi(order as i32) <= 1.0 {
            self.next = self.next.map(|next| next.max(wanted));
        }
    }

    /// Includes the errors of a step with this residual of its contact problem.
    pub(super) fn include(&mut self, error: &TimeError, residual: f64) {
        let ErrorBudget { time, solver, .. } = &mut self.worst;
        let in_time = error.relative.max(error.lasting);
        *time = Some(time.map_or(in_time, |worst| worst.max(in_time)));
        *solver = solver.max(residual);
    }
}

/// The order of the error of a step in its length, and whether the body responds by an immediate dashpot.
fn order_of(state: &State, settings: &Settings) -> (u32, bool) {
    let rule = state.history.rule();
    (rule.order(settings.adaptive_interpolant()), rule.has_dashpot())
}

/// The end of a step of about `wanted` towards `stop`: `stop` if this is near, or halfway if the remainder would be
/// much shorter than the step.
fn towards(now: f64, stop: f64, wanted: f64) -> f64 {
    let left = stop - now;
    if wanted >= NEARLY * left { stop } else { now + wanted.min(0.5 * left) }
}
