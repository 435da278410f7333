//! The length of steps chosen by an estimate of their error.

use crate::contact::computation::Computation;
use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::contact::window::region::Region;
use crate::error::Result;
use crate::load::LoadHistory;

/// The rule takes u to be linear within a step, which errs by u″ Δ²/8 in its middle. With u″ from the change of
/// slope between two steps, the estimate is
///
/// e = Σ p |u″| (Δ²/8) / Σ p |u|,
///
/// weighted by the pressure: the greatest error over all cells is that of the kink of u at a moving edge, which
/// carries no force. A load that is not linear in time within the step adds its own deviation.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct StepControl {
    pub(super) tolerance: f64,
    /// Length of the next step; `None` where earlier steps do not suggest one.
    next: Option<f64>,
    /// Error over tolerance of the last step accepted.
    last: f64,
    /// ∂u/∂t in the last step and its length, 0 if there is none to compare with.
    rate: Vec<f64>,
    /// The region of that field.
    region: Option<Region>,
    rate_dt: f64,
    /// The time at which that was kept.
    kept_at: f64,
    /// Whether a jump or a corner lies between that step and the next.
    cornered: bool,
    /// Greatest strength of the load so far.
    strongest: f64,
    /// Steps that were rejected.
    pub(super) rejected: u64,
}

/// Bounds of the change of the step length.
const MAX_GROWTH: f64 = 3.0;
const MAX_SHRINKAGE: f64 = 0.2;
/// Safety factor of the step length.
const SAFETY: f64 = 0.9;
/// Exponents of the proportional and the integral control of an error that grows with Δ² (Hairer, Wanner, *Solving
/// Ordinary Differential Equations II*, IV.2).
const INTEGRAL: f64 = 0.35;
const PROPORTIONAL: f64 = 0.1;
/// Error of the solver relative to that in time.
const SOLVER_SHARE: f64 = 0.02;
/// The first step after a jump is chosen from the material alone: this many lengths per decade are tried, ...
const LENGTHS_PER_DECADE: i32 = 4;
/// ... over this many decades below the time that is left.
const DECADES: i32 = 40;
/// A body without elastic response has no shortest time: its first step is this fraction of the time left.
const FIRST_FRACTION: f64 = 1e-6;
/// Error of a run relative to the estimate, before amplification by C(age)/C(Δ), and the bound of the latter: see
/// docs/accuracy.md.
const ERROR_OVER_ESTIMATE: f64 = 0.25;
const MAX_AMPLIFICATION: f64 = 5.0;
/// Loads below this fraction of the greatest so far are measured relative to that.
const SMALL_LOAD: f64 = 0.05;

impl StepControl {
    pub(super) fn new(tolerance: f64) -> StepControl {
        StepControl {
            tolerance,
            next: None,
            last: 1.0,
            rate: Vec::new(),
            region: None,
            rate_dt: 0.0,
            kept_at: f64::NAN,
            cornered: true,
            strongest: 0.0,
            rejected: 0,
        }
    }

    /// Whether its rate belongs to a region of the grid: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self, grid: &crate::Grid) -> bool {
        match &self.region {
            Some(region) => region.is_of(grid) && self.rate.len() == region.len(),
            None => self.rate_dt == 0.0,
        }
    }

    /// Forgets the last step: at a jump or a corner of the load, which is the end of the step under way.
    pub(super) fn restart(&mut self) {
        (self.next, self.last, self.cornered) = (None, 1.0, true);
    }

    /// After a step of length `dt` that was cut short at a stop: returns to the length `wanted`.
    pub(super) fn resume(&mut self, wanted: f64, dt: f64) {
        if dt < wanted && self.last * (wanted / dt).powi(2) <= 1.0 {
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

    /// The length to try next, at most `left`.
    pub(super) fn length(&self, scene: &Scene, state: &State, history: &dyn LoadHistory, left: f64) -> Result<f64> {
        let wanted = self.next.map_or_else(|| self.first(scene, state, history, left), Ok)?;
        Ok(wanted.min(left))
    }

    /// The length of the first step after a jump or a corner: the longest over which the creep is linear to within the
    /// tolerance.
    fn first(&self, scene: &Scene, state: &State, history: &dyn LoadHistory, left: f64) -> Result<f64> {
        let (now, jumped) = (state.clock.time, state.clock.last_dt == 0.0);
        // a paraboloid answers with the power 2/3 of force and compliance
        let compliance = |t: f64| scene.material.contact_compliance(t).powf(2.0 / 3.0);
        let glassy = compliance(0.0);
        if glassy == 0.0 {
            return Ok(FIRST_FRACTION * left);
        }
        let held = state.loads[0].strength();
        for k in 0..=LENGTHS_PER_DECADE * DECADES {
            let dt = left * 10f64.powf(-f64::from(k) / f64::from(LENGTHS_PER_DECADE));
            let creep = compliance(dt);
            let deviation = if jumped {
                (compliance(0.5 * dt) - 0.5 * (glassy + creep)) / creep
            } else {
                let change = (history.before(now + dt).validated_at(now + dt)?.strength() - held).abs();
                0.125 * (creep - glassy) / creep * change / (held + change).max(f64::MIN_POSITIVE)
            };
            if deviation.abs() <= self.tolerance && self.watch(history, now, now + dt)? <= self.tolerance {
                return Ok(dt);
            }
        }
        Ok(left * 10f64.powi(-DECADES))
    }

    /// How far the load strays from a straight line between now and `time`, relative to itself or to a
    /// fraction of the greatest so far. Rejects invalid loads of the history.
    pub(super) fn watch(&self, history: &dyn LoadHistory, now: f64, time: f64) -> Result<f64> {
        let (start, end) = (history.at(now).validated_at(now)?, history.before(time).validated_at(time)?);
        let scale = start.strength().max(end.strength()).max(SMALL_LOAD * self.strongest);
        // unevenly, so that no oscillation hits a zero at all of them
        let shares = [0.153, 0.381, 0.5, 0.677, 0.891];
        let mut most = 0.0_f64;
        for share in shares {
            let between = now + share * (time - now);
            most = most.max(start.deviation(&end, share, &history.at(between).validated_at(between)?, scale));
        }
        Ok(most)
    }

    /// Keeps the slope of u in the last step, before its beginning is overwritten.
    pub(super) fn keep_slope(&mut self, state: &State) {
        let clock = state.clock;
        if self.kept_at == clock.time && clock.last_dt != 0.0 {
            return;
        }
        self.kept_at = clock.time;
        self.strongest = self.strongest.max(state.loads[0].strength());
        self.rate_dt = 0.0;
        let cornered = std::mem::take(&mut self.cornered);
        let Some(before) = state.history.displacement_before().filter(|_| !cornered && clock.last_dt > 0.0) else {
            return;
        };
        self.rate_dt = clock.last_dt;
        if self.region.as_ref() != Some(&state.region) {
            self.region = Some(state.region.clone());
        }
        self.rate.resize(before.len(), 0.0);
        for ((rate, &new), &old) in self.rate.iter_mut().zip(state.history.displacement()).zip(before) {
            *rate = (new - old) / self.rate_dt;
        }
    }

    /// The error of a step that was tried, 0 where there is no last step to compare it with.
    pub(super) fn estimate(&mut self, scene: &Scene, tried: &Computation, dt: f64) -> f64 {
        if self.rate_dt == 0.0 || dt == 0.0 {
            return 0.0;
        }
        let Computation { state, trial, .. } = tried;
        if let Some(old) = self.region.as_ref().filter(|old| **old != state.region) {
            // the region grew with this step; on its rim, which carries no force yet, any rate will do
            self.rate = old.carry(&self.rate, &state.region, |_| 0.0);
            self.region = Some(state.region.clone());
        }
        let (pressure, history) = (&trial.solution.pressure, &state.history);
        let bend = 2.0 / (dt + self.rate_dt) * 0.125 * dt * dt * self.amplification(scene, state, dt);
        // bodies apart: the surface recovers everywhere alike
        let apart = pressure.iter().all(|&p| p == 0.0);
        let (mut error, mut size) = (0.0, 0.0);
        let fields = pressure.iter().zip(history.trial()).zip(history.displacement()).zip(&self.rate);
        for (((&p, &new), &old), &rate) in fields {
            let weight = if apart { 1.0 } else { p };
            error += weight * ((new - old) / dt - rate).abs();
            size += weight * new.abs();
        }
        let error = if size > 0.0 { bend * error / size } else { 0.0 };
        // overflow must not pass for accuracy
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// The factor by which an error of u in one step grows in the end: the next steps answer it with the stiffness of a
    /// step, the surface with that of its age.
    fn amplification(&self, scene: &Scene, state: &State, dt: f64) -> f64 {
        let compliance = |t: f64| scene.material.contact_compliance(t);
        let age = state.clock.time - state.clock.undisturbed_until;
        let (old, young) = (compliance(age + dt), compliance(dt));
        ERROR_OVER_ESTIMATE * if old > young { (old / young).min(MAX_AMPLIFICATION) } else { 1.0 }
    }

    /// Chooses the length of the next step after one of length `dt` with the given error; whether that is accepted.
    pub(super) fn judge(&mut self, dt: f64, error: f64) -> bool {
        let ratio = (error / self.tolerance).max(1e-10);
        let accepted = ratio <= 1.0;
        let factor = if accepted {
            SAFETY * ratio.powf(-INTEGRAL) * (self.last / ratio).powf(PROPORTIONAL)
        } else {
            SAFETY * ratio.powf(-0.5)
        };
        self.next = Some(dt * factor.clamp(MAX_SHRINKAGE, if accepted { MAX_GROWTH } else { 0.9 }));
        if accepted {
            self.last = ratio.max(1e-3);
        } else {
            self.rejected += 1;
        }
        accepted
    }
}
