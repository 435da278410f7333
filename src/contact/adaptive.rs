//! The length of steps chosen by an estimate of their error.

use crate::contact::region::Region;
use crate::contact::viscoelastic::ViscoelasticContact;
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
pub(super) struct Controller {
    pub(super) tolerance: f64,
    /// Length of the next step; `None` where the past says nothing about it.
    next: Option<f64>,
    /// Error over tolerance of the last step accepted.
    last: f64,
    /// ∂u/∂t in the last step and its length, 0 if there is none to compare with.
    rate: Vec<f64>,
    /// Where that was computed.
    region: Option<Region>,
    rate_dt: f64,
    /// The time for which that was kept.
    kept_at: f64,
    /// Whether a jump or a corner lies between that step and the next.
    cornered: bool,
    /// Greatest strength of the load so far.
    strongest: f64,
    /// Steps tried in vain.
    pub(super) rejected: u64,
}

/// Growth and shrinkage of a step, at most.
const GROWTH: f64 = 3.0;
const SHRINKAGE: f64 = 0.2;
/// Part of the tolerance that a step aims at.
const AIM: f64 = 0.9;
/// Exponents of the proportional and the integral control of an error that grows with Δ² (Hairer, Wanner, *Solving
/// Ordinary Differential Equations II*, IV.2).
const INTEGRAL: f64 = 0.35;
const PROPORTIONAL: f64 = 0.1;
/// Part of the error in time that the solver may add.
const SOLVER_SHARE: f64 = 0.02;
/// Where the material alone says how long a step after a jump may be, its lengths are tried so many a decade, ...
const TRIED: i32 = 4;
/// ... over so many decades below the time that is left.
const DECADES: i32 = 40;
/// A body that creeps without an elastic response has no shortest time: its first step is this part of the time left.
const FIRST_PART: f64 = 1e-6;
/// Part of the estimate that a run really errs by, before and at most after the amplification by C(age)/C(Δ): see
/// docs/accuracy.md.
const SHARE: f64 = 0.25;
const MOST_AMPLIFIED: f64 = 5.0;
/// Loads below this part of the greatest so far are measured against it.
const SMALL_LOAD: f64 = 0.05;

impl Controller {
    pub(super) fn new(tolerance: f64) -> Controller {
        Controller {
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

    /// Forgets the last step: at a jump or a corner of the load, which is the end of the step under way.
    pub(super) fn restart(&mut self) {
        (self.next, self.last, self.cornered) = (None, 1.0, true);
    }

    /// After a step of length `dt` that was cut for the sake of its end: takes up the length `wanted` again.
    pub(super) fn resume(&mut self, wanted: f64, dt: f64) {
        if dt < wanted && self.last * (wanted / dt).powi(2) <= 1.0 {
            self.next = self.next.map(|next| next.max(wanted));
        }
    }

    /// A step that the solver could not do is tried again at a fifth of its length.
    pub(super) fn shorten(&mut self, dt: f64) {
        self.next = Some(SHRINKAGE * dt);
        self.rejected += 1;
    }

    /// The tolerance of the solver that suits.
    pub(super) fn solver_tolerance(&self, wanted: f64) -> f64 {
        wanted.max(SOLVER_SHARE * self.tolerance)
    }

    /// The length to try next, at most `left`.
    pub(super) fn length(&self, contact: &ViscoelasticContact, history: &dyn LoadHistory, left: f64) -> Result<f64> {
        let wanted = self.next.map_or_else(|| self.first(contact, history, left), Ok)?;
        Ok(wanted.max(contact.state.shortest).min(left))
    }

    /// The length of a step that the past says nothing about: the longest over which the creep after a jump, or after
    /// a corner, is linear to within the tolerance.
    fn first(&self, contact: &ViscoelasticContact, history: &dyn LoadHistory, left: f64) -> Result<f64> {
        let (now, jumped) = (contact.time(), contact.last_step_was_a_jump());
        // a paraboloid answers with the power 2/3 of force and compliance
        let compliance = |t: f64| contact.material().contact_compliance(t).powf(2.0 / 3.0);
        let glassy = compliance(0.0);
        if glassy == 0.0 {
            return Ok(FIRST_PART * left);
        }
        let held = contact.load().strength();
        for k in 0..=TRIED * DECADES {
            let dt = left * 10f64.powf(-f64::from(k) / f64::from(TRIED));
            let creep = compliance(dt);
            let deviation = if jumped {
                (compliance(0.5 * dt) - 0.5 * (glassy + creep)) / creep
            } else {
                let change = (history.before(now + dt).validated_at(now + dt)?.strength() - held).abs();
                0.125 * (creep - glassy) / creep * change / (held + change).max(f64::MIN_POSITIVE)
            };
            if deviation.abs() <= self.tolerance && self.watch(history, contact, now + dt)? <= self.tolerance {
                return Ok(dt);
            }
        }
        Ok(left * 10f64.powi(-DECADES))
    }

    /// How far the load strays from a straight line between now and `time`, relative to itself or to a part of the
    /// greatest so far. Refuses what is not a load, wherever it looks.
    pub(super) fn watch(&self, history: &dyn LoadHistory, contact: &ViscoelasticContact, time: f64) -> Result<f64> {
        let now = contact.time();
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

    /// Keeps the slope of u in the step that lies behind, before its beginning is overwritten.
    pub(super) fn remember(&mut self, contact: &ViscoelasticContact) {
        if self.kept_at == contact.time() && !contact.last_step_was_a_jump() {
            return;
        }
        self.kept_at = contact.time();
        self.strongest = self.strongest.max(contact.load().strength());
        let (dt, before) = contact.displacement_before();
        self.rate_dt = if std::mem::take(&mut self.cornered) { 0.0 } else { dt };
        if self.rate_dt > 0.0 {
            let (region, displacement) = contact.computed();
            if self.region.as_ref() != Some(region) {
                self.region = Some(region.clone());
            }
            self.rate.resize(before.len(), 0.0);
            for ((rate, &new), &old) in self.rate.iter_mut().zip(displacement).zip(before) {
                *rate = (new - old) / dt;
            }
        }
    }

    /// The error of the step being tried, 0 where there is no last step to compare it with.
    pub(super) fn estimate(&mut self, contact: &ViscoelasticContact, dt: f64) -> f64 {
        if self.rate_dt == 0.0 || dt == 0.0 {
            return 0.0;
        }
        let (region, before) = contact.computed();
        if let Some(old) = self.region.as_ref().filter(|old| *old != region) {
            // the region grew with this step; on its rim, which carries no force yet, any rate will do
            self.rate = old.carry(&self.rate, region, |_| 0.0);
            self.region = Some(region.clone());
        }
        let (pressure, displacement) = contact.trial();
        let bend = 2.0 / (dt + self.rate_dt) * 0.125 * dt * dt * self.amplification(contact, dt);
        // bodies apart: the surface recovers everywhere alike
        let apart = pressure.iter().all(|&p| p == 0.0);
        let (mut error, mut size) = (0.0, 0.0);
        let fields = pressure.iter().zip(displacement).zip(before).zip(&self.rate);
        for (((&p, &new), &old), &rate) in fields {
            let weight = if apart { 1.0 } else { p };
            error += weight * ((new - old) / dt - rate).abs();
            size += weight * new.abs();
        }
        let error = if size > 0.0 { bend * error / size } else { 0.0 };
        // numbers that left their range say nothing good
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// What an error of u in one step comes to in the end: the next steps answer it with the stiffness of a step, the
    /// surface with that of its age.
    fn amplification(&self, contact: &ViscoelasticContact, dt: f64) -> f64 {
        let compliance = |t: f64| contact.material().contact_compliance(t);
        let (old, young) = (compliance(contact.age() + dt), compliance(dt));
        SHARE * if old > young { (old / young).min(MOST_AMPLIFIED) } else { 1.0 }
    }

    /// Takes note of a step of length `dt` with the given error; says whether it may stand.
    pub(super) fn judge(&mut self, dt: f64, error: f64) -> bool {
        let ratio = (error / self.tolerance).max(1e-10);
        let accepted = ratio <= 1.0;
        let factor = if accepted {
            AIM * ratio.powf(-INTEGRAL) * (self.last / ratio).powf(PROPORTIONAL)
        } else {
            AIM * ratio.powf(-0.5)
        };
        self.next = Some(dt * factor.clamp(SHRINKAGE, if accepted { GROWTH } else { 0.9 }));
        if accepted {
            self.last = ratio.max(1e-3);
        } else {
            self.rejected += 1;
        }
        accepted
    }
}
