//! The length of steps chosen by an estimate of their error.

use crate::contact::step::error_in_time::SHORTEST_TOUCH;
use crate::contact::{Computation, Scene, State};
use crate::error::Result;
use crate::extent::Extent;
use crate::hereditary::{ExponentialRule, LastingError, Meeting, StepContext, TimeError};
use crate::load::{Load, LoadHistory};
use crate::rheology::CreepSpectrum;
use crate::run::run_scale::RunScale;
use crate::solver::Freedom;

/// Chooses steps whose error stays below the tolerance. Two errors count: the error of the displacement within the step
/// ([`History::time_error`](crate::hereditary::History::time_error)), and the deviation of the load from the polynomial
/// through its values at the last three nodes and the end of the step.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct StepControl {
    pub(super) tolerance: f64,
    /// Length of the next step, in reduced time like all lengths and times here; `None` where earlier steps suggest
    /// none.
    pub(super) next: Option<f64>,
    /// Error over tolerance of the last step accepted.
    last: f64,
    /// Times and loads of the last nodes since the last jump or corner, newest first.
    pub(super) nodes: Vec<(f64, Load)>,
    /// Length of the last step before a corner, and the slope of the load over it, per second of reduced time.
    pub(super) corner: Option<(f64, f64)>,
    pub(super) scale: Option<RunScale>,
    defects: Option<DefectAccumulation>,
    /// Mean errors of u left by the steps so far, in contact and outside.
    lasting: Option<[LastingError; 2]>,
    /// Number of accepted steps, and the time of the last jump or corner.
    steps: u64,
    pub(super) since: f64,
    /// Number of rejected steps.
    pub(super) rejected: u64,
}

/// Bounds of the change of the step length. Beyond 1 + √2 the order of steps with an immediate dashpot is lower.
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
/// Surfaces that attract each other end their passes at a hundred tolerances of the solver.
const SHARE_OF_PASSES: f64 = 0.03;
/// An error of the solver counts so many times as much as its response to the surface that the body meets later: the errors of many
/// steps add up.
const SOLVER_ON_MEETING: f64 = 3.0;
/// A corner of the temperature is one of the second derivative of u. The steps before do not show it: the estimate of the first step
/// after it, which the next step does not put right, is too low by this factor times the ratio of the step before to this one.
const AT_TURN: f64 = 5.0;
/// An error of u before a switch to a given approach counts at most so many times: the force by which stiffer glass answers is over
/// before the first step ends.
const MOST_ON_SWITCH: f64 = 3e3;
/// The solver attains this tolerance in all scenes.
pub(super) const LEAST_TOLERANCE: f64 = 1e-10;
/// Events shorter than this fraction of the time between corners, times the tolerance, are not resolved.
const SHORTEST: f64 = 0.03;
/// Nodes of the quadratic and its correction, besides the end of the step.
pub(super) const NODES: usize = 3;

impl StepControl {
    pub(super) fn new(tolerance: f64) -> StepControl {
        StepControl { tolerance, last: 1.0, nodes: Vec::with_capacity(NODES + 1), ..StepControl::default() }
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        self.nodes.len() <= NODES
            && self.nodes.windows(2).all(|pair| pair[0].0 > pair[1].0)
            && self.nodes.iter().all(|(time, load)| time.is_finite() && load.validate().is_ok())
            && self.defects.as_ref().is_none_or(DefectAccumulation::fits)
            && self.lasting.iter().flatten().all(LastingError::fits)
            && self.scale.as_ref().is_none_or(RunScale::fits)
    }

    /// Starts anew at a jump of the load.
    pub(super) fn jump(&mut self) {
        (self.next, self.last, self.corner) = (None, 1.0, None);
        self.nodes.clear();
    }

    /// Starts anew at a corner of the load at the end of the last step.
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

    /// Records an accepted step of length `dt` to `load` at `time`. Its length without stops and corners was `wanted`.
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

    /// Shortens a step to a fifth after the solver has failed to converge.
    pub(super) fn shorten(&mut self, dt: f64) {
        self.next = Some(MAX_SHRINKAGE * dt);
        self.rejected += 1;
    }

    /// Tolerance of the solver that suits the tolerance in time, at least the tolerance of the settings, where no given approach is to come.
    pub(super) fn solver_tolerance(&self, scene: &Scene) -> f64 {
        let share = if scene.attraction.is_some() { SHARE_OF_PASSES } else { 1.0 } * SOLVER_SHARE;
        scene.settings.tolerance.max(share * self.tolerance)
    }

    /// Tolerance of the solver in a step of length `dt` to the time `now`, at most `tolerance`: where a given approach is to come,
    /// the bodies respond to an error of u by more than in the steps that leave it.
    pub(super) fn solver_tolerance_before_meeting(
        &self,
        scene: &Scene,
        tolerance: f64,
        [now, dt]: [f64; 2],
        outlook: &StepContext,
    ) -> f64 {
        let stiffness = self.scale.as_ref().map_or(0.0, |scale| scale.stiffness_after(now));
        let answer = SOLVER_ON_MEETING * stiffness * scene.material.contact_compliance(dt);
        tolerance.min((tolerance / answer.max(outlook.on_switch[1])).max(LEAST_TOLERANCE))
    }

    /// By how much the error of a step of length `dt` exceeds its estimate: after a corner of the temperature, and where a body is
    /// free to tilt on a small contact, whose errors are greater by its lever at the end of the grid. Where cells leave on one side,
    /// errors ±e at the outer cells of the contact, w apart, are a tilt by 2e/w, and e L/w at the ends of a grid of length L.
    pub(super) fn excess(scene: &Scene, tried: &Computation, dt: f64) -> f64 {
        let clock = &tried.state.clock;
        let is_turn = clock.last_dt > 0.0 && scene.next_temperature_corner(clock.time.next_down()).0 == clock.time;
        let of_turn = if is_turn { AT_TURN * (clock.last_dt / dt).max(1.0) } else { 1.0 };
        let tilts = tried.trial.free.iter().any(Freedom::tilts);
        let (cells, reach) = if tilts { tried.pressed() } else { (0, None) };
        let leave = cells < tried.state.current.contact_cells;
        let lever = |Extent { low, high }: Extent| {
            let lever = |axis: usize| {
                let (length, width) = (scene.grid.cells()[axis] as f64, (high[axis] - low[axis]) as f64);
                if leave { length / width.max(1.0) } else { 0.5 * length / (width + 1.0) }
            };
            lever(0).max(lever(1)).max(1.0)
        };
        of_turn * reach.map_or(1.0, lever)
    }

    /// Prepares a step from `state`: computes the scales of the run where needed, and makes the present load a node.
    pub(super) fn begin(&mut self, scene: &Scene, state: &State, history: &dyn LoadHistory, until: f64) -> Result<()> {
        let (now, reduced) = (state.clock.time, state.clock.reduced_time);
        if self.nodes.is_empty() {
            self.nodes.push((reduced, history.checked_at(now, scene.attraction.is_some())?));
            self.since = reduced;
        }
        if self.scale.is_none() {
            let mut scale = RunScale::new(scene, state, history, until)?;
            scale.find_stiffness(scene, self.tolerance);
            self.scale = Some(scale);
        }
        self.scale.iter_mut().for_each(|scale| scale.include(&state.loads[0]));
        if self.defects.is_none() {
            self.defects = scene.material.contact_spectrum()?.map(|creep| DefectAccumulation::new(&creep));
        }
        Ok(())
    }

    /// Includes the defects of a step to be accepted; `motion_is_given` states whether its motion is given.
    pub(super) fn include(
        &mut self,
        rule: Option<&ExponentialRule>,
        dt: f64,
        error: &TimeError,
        motion_is_given: bool,
    ) {
        self.steps += 1;
        self.defects.iter_mut().for_each(|defects| defects.include(dt, error.defect));
        let Some(rule) = rule else { return };
        let [contact, surface] = self.lasting.get_or_insert_with(|| [(); 2].map(|()| LastingError::none(rule)));
        contact.include(rule, error.defect[0], motion_is_given);
        surface.include(rule, error.surface, false);
    }

    /// The time before `stop` at which undisturbed bodies first touch under the load.
    pub(super) fn first_touch(&self, state: &State, history: &dyn LoadHistory, stop: f64) -> f64 {
        let scale = self.scale.as_ref().filter(|_| state.is_undisturbed());
        scale.map_or(f64::INFINITY, |scale| scale.first_touch(history, state.clock.time, stop))
    }

    /// Context of a step under `load` that ends `now`, when the bodies have been loaded for `age`, before a corner or
    /// the end of the run at `stop`.
    pub(super) fn outlook(&self, scene: &Scene, load: &Load, [now, age, dt, stop]: [f64; 4]) -> Result<StepContext> {
        let span = stop - self.since;
        let resolution = SHORTEST * self.tolerance * span;
        let shortest = self.defects.as_ref().map_or(f64::INFINITY, DefectAccumulation::shortest_time);
        let on_switch = self.on_switch(scene, [now, age, dt], SHORTEST_TOUCH * resolution)?;
        let greatest = self.scale.as_ref().map_or(0.0, RunScale::greatest_potential);
        let lasting = self.lasting.as_ref().map(<[_; 2]>::each_ref);
        let soon = 1.0 / scene.material.contact_compliance(SHORTEST_TOUCH * resolution);
        let meeting =
            self.scale.as_ref().map_or(Meeting::default(), |scale| scale.coming_back(scene, load, [age, now]));
        Ok(StepContext {
            expected: self.scale.as_ref().map_or([0.0; 2], |scale| scale.expected(scene, load, age)),
            meeting: Meeting { stiffness: meeting.stiffness.max(soon), ..meeting },
            lasting: lasting.map_or([0.0; 2], |errors| errors.map(LastingError::of_displacement)),
            on_switch,
            greatest_on_switch: if on_switch[1] > 0.0 { greatest } else { 0.0 },
            on_jump: 0.0,
            is_last: false,
            tolerance: self.tolerance,
            agreement: self.defects.as_ref().map_or(1.0, DefectAccumulation::agreement),
            steps: self.steps as f64 + 1.0,
            resolution,
            beginning: SHORTEST * self.tolerance * span.min(shortest),
            length_is_given: false,
        })
    }

    /// Errors of u where the next given approach follows a given force, each over the glassy compliance, that a unit of a defect of
    /// v leaves: in a step of length `dt` that ends `now`, and in all steps of bodies that have been loaded for `age`. Bodies without
    /// elastic response have the compliance of a `touch`.
    fn on_switch(&self, scene: &Scene, [now, age, dt]: [f64; 3], touch: f64) -> Result<[f64; 2]> {
        let switch = self.scale.as_ref().map_or(f64::INFINITY, |scale| scale.next_switch(now));
        if switch.is_infinite() {
            return Ok([0.0; 2]);
        }
        let left = scene.reduced_length([now, switch], switch - now)?;
        let compliance = |t: f64| scene.material.contact_compliance(t);
        let glassy = if compliance(0.0) > 0.0 { compliance(0.0) } else { compliance(touch) };
        let responses = [dt, age].map(|length| (compliance(left + length) - compliance(left)) / glassy);
        Ok(responses.map(|response| response * (MOST_ON_SWITCH / responses[1]).min(1.0)))
    }

    /// Chooses the length of the next step after a step of length `dt` with the given error, which grows with the power
    /// `order` of the length. Returns whether the step is accepted.
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

/// How far the defects of v of the steps so far add up. Under a given force a defect of v makes the bodies creep as a
/// force does. Defects of one sign leave an error in u that grows with the compliance; defects of changing sign cancel.
///
/// Holds the creep response to the defects and to their absolute values. The ratio of the two responses measures the
/// agreement of signs.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct DefectAccumulation {
    fluidity: f64,
    flow: [f64; 2],
    terms: Vec<CreepTerm>,
}

/// One term of the creep spectrum.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct CreepTerm {
    compliance: f64,
    /// Retardation time.
    time: f64,
    /// Response to the defects, and to their absolute values.
    crept: [f64; 2],
}

impl DefectAccumulation {
    fn new(creep: &CreepSpectrum) -> DefectAccumulation {
        let terms =
            creep.terms().iter().map(|&(compliance, time)| CreepTerm { compliance, time, crept: [0.0; 2] }).collect();
        DefectAccumulation { fluidity: creep.fluidity(), flow: [0.0; 2], terms }
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    fn fits(&self) -> bool {
        let known = |values: [f64; 2]| values.iter().all(|value| value.is_finite());
        known(self.flow)
            && self.fluidity >= 0.0
            && self.terms.iter().all(|term| term.compliance >= 0.0 && term.time > 0.0 && known(term.crept))
    }

    /// The shortest retardation time; infinite if there is none.
    fn shortest_time(&self) -> f64 {
        self.terms.iter().map(|term| term.time).fold(f64::INFINITY, f64::min)
    }

    /// Includes a step of length `dt`; `defect` holds the mean defect of v and the mean of its absolute value.
    fn include(&mut self, dt: f64, defect: [f64; 2]) {
        for which in [0, 1] {
            self.flow[which] += self.fluidity * dt * defect[which];
            for CreepTerm { compliance, time, crept } in &mut self.terms {
                let decay = (-dt / *time).exp();
                crept[which] = decay * crept[which] + *compliance * (1.0 - decay) * defect[which];
            }
        }
    }

    /// Agreement of the signs of the defects so far: 1 if all have one sign, 0 if they cancel.
    fn agreement(&self) -> f64 {
        let [signed, absolute] =
            [0, 1].map(|which| self.flow[which] + self.terms.iter().map(|term| term.crept[which]).sum::<f64>());
        if absolute > 0.0 { (signed / absolute).abs().min(1.0) } else { 1.0 }
    }
}
