//! Steps as long as their error allows.

use crate::contact::step::error_in_time::error_in_time;
use crate::contact::{Computation, Scene, Settings, State, StepReport, ViscoelasticContact};
use crate::error::{AdhesionError, Error, Result, StepError};
use crate::events;
use crate::hereditary::StepContext;
use crate::load::{Load, LoadHistory, Tilt};
use crate::run::driven::Course;
use crate::run::error_budget::StepErrors;
use crate::run::step_control::{NODES, StepControl};

/// Number of shorter attempts after the solver has failed to converge.
const MAX_SOLVER_RETRIES: u32 = 5;
/// Order in the step length of the error due to cells that join the contact within the step: a shorter step ends sooner
/// after they join.
const ORDER_OF_KINKS: u32 = 2;
/// Lengths per decade tried for the first step after a jump, which is chosen from the material alone, ...
const LENGTHS_PER_DECADE: i32 = 4;
/// ... and decades tried below the remaining time.
const DECADES: i32 = 40;
/// First step of a body without elastic response, as a fraction of the remaining time: such a body has no shortest
/// time.
const FIRST_FRACTION: f64 = 1e-6;
/// Greatest factor by which the response of surfaces that attract each other enlarges the error of a step. It has no bound at a jump.
const MOST_RESPONSE: f64 = 10.0;
/// Steps of one rounding of the time are accepted within so many of them after a jump or a corner.
const ROUNDINGS: f64 = 1e3;
/// Positions within a step at which the load is evaluated. They are uneven, so that no oscillation is zero at all of
/// them.
const SHARES: [f64; 5] = [0.153, 0.381, 0.5, 0.677, 0.891];

/// Takes one step as long as its error allows: proposes a length, checks the load within the step, tries the step, judges its
/// error, and accepts it or tries a shorter one.
pub(super) fn adaptive_step(
    contact: &mut ViscoelasticContact,
    control: &mut StepControl,
    course: Course<'_>,
) -> Result<(StepReport, StepErrors)> {
    let Course { history, until, .. } = course;
    let ViscoelasticContact { scene, computation, .. } = &*contact;
    let now = computation.state.clock.time;
    control.begin(scene, &computation.state, history, until)?;
    let tolerance = control.solver_tolerance(scene);
    let touch = control.first_touch(&computation.state, history, course.stop);
    let (kink, stop) = (course.kink.min(touch), course.stop.min(touch));
    let (mut wasted, mut failures, mut tried) = ([0; 2], 0, f64::INFINITY);
    loop {
        let ViscoelasticContact { scene, computation, .. } = &*contact;
        let (state, clock) = (&computation.state, &computation.state.clock);
        let [wanted, reduced] = control.length(scene, state, history, until - now)?;
        let (order, dashpot) = order_of(state, &scene.settings);
        // a jump may come so late that the creep after it is faster than times are resolved
        let is_late = || {
            let rounding = scene.reduced_time(clock, now.next_up())? - clock.reduced_time;
            Ok::<_, Error>(clock.reduced_time - control.since <= ROUNDINGS * rounding)
        };
        let mut time = towards(now, stop, wanted);
        if (time <= now || time >= tried) && is_late()? {
            time = tried.next_down().min(time.max(now.next_up()));
        }
        let (dt, unresolved) = (time - now, time == now.next_up() && is_late()?);
        // near the resolution of the time, a shortened step may round to the same end again and again
        if time <= now || time >= tried {
            return Err(Error::Step(StepError::StepTooShort { time: now, dt, tolerance: control.tolerance }));
        }
        tried = time;
        let loads = [history.checked_before(time, scene.attraction.is_some())?];
        let mut step = contact.request(time, dt, &loads, tolerance)?;
        step.cancelled = course.cancelled;
        let straying = control.watch(history, [now, time], |time| scene.reduced_time(clock, time))?;
        let parted = !state.attracts && state.current.contact_cells == 0 && control.stays_away(history, now, time);
        if straying > control.tolerance && !parted {
            control.judge(step.interval.dt, straying, order, dashpot);
            continue;
        }
        let age = step.interval.reduced - clock.undisturbed_until;
        let end = scene.reduced_time(clock, kink.min(until))?;
        let on_jump = stiffness_on_jump(scene, [&loads[0], &history.at(time)]);
        let is_last = time == kink && !is_held(history, [now, time]);
        let outlook = control.outlook(scene, &loads[0], [time, age, step.interval.dt, end])?;
        let outlook = StepContext { on_jump, is_last, ..outlook };
        step.interval.interpolant = scene.settings.adaptive_interpolant();
        step.tolerance = control.solver_tolerance_before_meeting(scene, tolerance, [time, step.interval.dt], &outlook);
        let attempt = match contact.attempt(&step) {
            Err(Error::Step(StepError::NotConverged { .. }) | Error::Adhesion(AdhesionError::NotConverged { .. }))
                if failures < MAX_SOLVER_RETRIES =>
            {
                failures += 1;
                control.shorten(step.interval.dt);
                add_work(&mut wasted, &contact.computation);
                continue;
            }
            // the bodies separate within the step: a shorter one shows when
            Err(Error::Adhesion(AdhesionError::PulledOff { .. })) if dt > outlook.resolution => {
                control.shorten(step.interval.dt);
                add_work(&mut wasted, &contact.computation);
                continue;
            }
            other => other?,
        };
        let ViscoelasticContact { scene, computation, .. } = &*contact;
        let computed = attempt.computation(computation);
        let mut error = error_in_time(scene, computed, &step, outlook);
        computed.state.region.rows().intact()?;
        // the path of bodies that stay apart does not matter
        if !parted || computed.state.region.is_positive_anywhere(&computed.trial.solution.pressure) {
            error.relative = error.relative.max(straying);
        }
        let excess = StepControl::excess(scene, computed, step.interval.dt);
        error.relative *=
            excess * computed.trial.passes.as_ref().map_or(1.0, |passes| passes.report.response.min(MOST_RESPONSE));
        // a jump takes no time: shorter steps would show nothing but its moment
        let jumps = scene.attraction.is_some() && dt <= outlook.resolution && error.relative > control.tolerance;
        if jumps {
            error.relative = 0.0;
        }
        let by_kinks = error.by_kinks && error.relative > control.tolerance;
        let order = if by_kinks || excess > 1.0 { ORDER_OF_KINKS } else { order };
        // the report gives the error of a step that cannot be shorter
        let unresolved = unresolved && error.relative.is_finite();
        if !control.judge(step.interval.dt, error.relative, order, dashpot) && !unresolved {
            events::rejected(time, dt, error.relative, control.tolerance);
            add_work(&mut wasted, computed);
            continue;
        }
        let motion_is_given = !computed.trial.free.iter().any(|freedom| freedom.translation);
        control.include(computed.state.history.exponential_rule(), step.interval.dt, &error, motion_is_given);
        let is_kink = outlook.is_last;
        control.accept(step.interval.reduced, loads[0], [reduced, step.interval.dt], is_kink, order);
        let mut report = contact.accept(attempt, step, error)?;
        if jumps {
            contact.computation.state.history.reset_differences();
        }
        // bodies apart do not respond to a given approach before they touch
        let apart = !matches!(loads[0], Load::Force { .. }) && report.contact_cells == 0 && time < touch;
        if is_kink && !apart {
            contact.computation.state.history.reset_differences();
        }
        report.convolutions += wasted[0];
        report.preconditioner_applications += wasted[1];
        let time = error.relative.max(error.lasting);
        let errors = StepErrors { time, pressure: error.greatest, residual: report.residual };
        return Ok((report, errors));
    }
}

impl StepControl {
    /// Proposed length of the next step, at most `left`, and its length in reduced time.
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
    /// tolerance. After a corner, only the departure of the load from its previous slope makes the bodies creep.
    fn first(&self, scene: &Scene, state: &State, history: &dyn LoadHistory, left: f64) -> Result<f64> {
        let (now, jumped) = (state.clock.time, state.clock.last_dt == 0.0);
        // the approach of a paraboloid is proportional to force and compliance to the power 2/3
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
                let load = history.checked_before(now + dt, scene.attraction.is_some())?;
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

    /// Whether a body of given approach comes no nearer between `now` and `time` than at these two times.
    pub(super) fn stays_away(&self, history: &dyn LoadHistory, now: f64, time: f64) -> bool {
        let approach = |load: Load| match load {
            Load::Approach { approach: at, tilt: [Tilt::Fixed(0.0), Tilt::Fixed(0.0)] }
            | Load::Spring { drive: at, tilt: [Tilt::Fixed(0.0), Tilt::Fixed(0.0)], .. } => at,
            _ => f64::NAN,
        };
        let nearest = approach(history.at(now)).max(approach(history.before(time)));
        let mut away = !nearest.is_nan();
        for share in SHARES {
            away &= approach(history.at(now + share * (time - now))) <= nearest;
        }
        away
    }

    /// Greatest deviation of the load between `now` and `time` from the polynomial through its last nodes and the load
    /// at `time`, relative to the load or to a fraction of the greatest load of the run. Rejects invalid loads of the
    /// history.
    pub(super) fn watch(
        &self,
        history: &dyn LoadHistory,
        [now, time]: [f64; 2],
        reduced: impl Fn(f64) -> Result<f64>,
    ) -> Result<f64> {
        let attracts = self.scale.as_ref().is_some_and(|scale| scale.attracts);
        let end = history.checked_before(time, attracts)?;
        let mut nodes = [(reduced(time)?, end); NODES + 1];
        let known = self.nodes.len().min(NODES);
        nodes[1..=known].copy_from_slice(&self.nodes[..known]);
        let nodes = &nodes[..=known];
        let start = nodes[known.min(1)].1;
        let scale = self.scale.as_ref().map_or(0.0, |scale| scale.of_load(&start, &end));
        let mut most = 0.0_f64;
        for share in SHARES {
            let between = now + share * (time - now);
            let load = history.checked_at(between, attracts)?;
            let like = load.is_like(&start) && load.is_like(&end);
            most = most.max(if like { load.deviation(reduced(between)?, nodes, scale) } else { f64::INFINITY });
        }
        Ok(most)
    }
}

/// The order of the error of a step in its length, and whether the body responds by an immediate dashpot.
fn order_of(state: &State, settings: &Settings) -> (u32, bool) {
    match state.history.exponential_rule() {
        Some(rule) => (rule.order(settings.adaptive_interpolant()), rule.has_dashpot()),
        None => (1, false),
    }
}

/// The response of v to an error of u of the cells that are met where the load jumps, if a force does so upwards: glassy.
fn stiffness_on_jump(scene: &Scene, [before, after]: [&Load; 2]) -> f64 {
    let compliance = scene.material.contact_compliance(0.0);
    match (before, after) {
        (Load::Force { normal: before, .. }, Load::Force { normal: after, .. })
            if after > before && compliance > 0.0 =>
        {
            1.0 / compliance
        }
        _ => 0.0,
    }
}

/// Whether the load is the same from `now` to `time`, and for as long after it.
fn is_held(history: &dyn LoadHistory, [now, time]: [f64; 2]) -> bool {
    let load = history.at(now);
    load == history.at(time) && load == history.at(time + (time - now))
}

/// Adds the convolutions and preconditioner applications of a rejected step.
fn add_work(work: &mut [usize; 2], tried: &Computation) {
    let counts = tried.trial.solution.counts;
    *work = [work[0] + counts.convolutions, work[1] + counts.preconditioner_applications];
}

/// The end of a step of about `wanted` towards `stop`: `stop` if this is near, or halfway if the remainder would be much
/// shorter than the step.
fn towards(now: f64, stop: f64, wanted: f64) -> f64 {
    let left = stop - now;
    if wanted >= 0.99 * left { stop } else { now + wanted.min(0.5 * left) }
}
