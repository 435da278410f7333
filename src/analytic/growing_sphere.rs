use std::f64::consts::PI;
use std::sync::Arc;

use crate::error::{Error, Refusal, Result, StepError, positive, within};
use crate::load::{Load, LoadHistory, StepLoad};
use crate::quadrature::{GaussLegendre, bisect};
use crate::rheology::{CreepSpectrum, Material, RelaxationSpectrum};

/// A sphere on a viscoelastic half-space under a force for which the contact never shrinks.
///
/// While the contact grows, the elastic solution holds with its moduli replaced by hereditary operators
/// (Lee & Radok, J. Appl. Mech. 27, 1960; Ting, J. Appl. Mech. 33, 1966):
///
/// a³(t) = (3R/4) ∫ C(t − s) dW(s), ω = a²/R,
///
/// p(r, t) = (2/πR) [E(0) s(t) + ∫ E′(t − t′) s(t′) dt′], s(t′) = √max(0, a(t′)² − r²),
///
/// E being the relaxation modulus that belongs to the contact compliance C. For a step load
/// a³ = (3/4) R W C(t); with the compliance of an incompressible Maxwell body, or of a Zener body with
/// G = G_K, this is Table 1 of the source [paper](crate::paper), drawn in its Figures 4 and 5. It holds for every other
/// exponential series too.
///
/// ```
/// use viscocontact::analytic::GrowingSphere;
/// use viscocontact::rheology::{Material, Maxwell};
///
/// let body = Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?);
/// let sphere = GrowingSphere::step(10.0e-3, &body, 1.0)?;
/// let growth = (sphere.contact_radius(2.0) / sphere.contact_radius(0.0)).powi(3);
/// assert!((growth - 3.0).abs() < 1e-12); // J(2τ) = 3 J(0)
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct GrowingSphere {
    radius: f64,
    creep: CreepSpectrum,
    relaxation: RelaxationSpectrum,
    load: Arc<dyn LoadHistory>,
    /// The force of a step load, whose hereditary integral has a closed form.
    step: Option<f64>,
    rule: GaussLegendre,
}

/// Number of panels graded towards a singular end, each a tenth of the previous one.
const GRADES: i32 = 12;
/// Decay times after which an exponential kernel is negligible: e^(−45) < 3e-20.
const MAX_DECAY_TIMES: f64 = 45.0;

/// Maximum radius and force: with these and the range of spectra, products do not overflow.
const MOST: f64 = 1e100;

impl GrowingSphere {
    /// A sphere of `radius` \[m\] under `force` \[N\] applied at t = 0 and held.
    ///
    /// # Errors
    /// If the radius is not in \[1e-100, 1e100\] m, the force not in (0, 1e100] N, the material has no exponential
    /// series, or no elastic response.
    pub fn step(radius: f64, material: &Material, force: f64) -> Result<GrowingSphere> {
        positive("force", force)?;
        within("force", force, force <= MOST, "at most 1e100 N")?;
        let load = StepLoad::new(Load::force(force))?;
        Ok(GrowingSphere { step: Some(force), ..GrowingSphere::new(radius, material, load)? })
    }

    /// A sphere of `radius` \[m\] under the force of `load` from t = 0 on, and none before. The
    /// solution is valid up to the time at which the contact radius first decreases.
    ///
    /// # Errors
    /// If the radius is not in \[1e-100, 1e100\] m, the material has no exponential series or no elastic
    /// response, or the load is no force.
    pub fn new(radius: f64, material: &Material, load: impl LoadHistory + 'static) -> Result<GrowingSphere> {
        within("sphere radius", radius, (1.0 / MOST..=MOST).contains(&radius), "in [1e-100, 1e100] m")?;
        let what = "the solution for a growing contact";
        let creep = material.spectrum_for(what)?;
        if creep.glassy() == 0.0 {
            return Err(Error::Step(StepError::NoElasticResponse { time: 0.0, what }));
        }
        let [given, _] = load.at(0.0).kind();
        if given != "a force" {
            let what = format!("the growing sphere needs a force, not {given}");
            return Err(Refusal::value("load_wrong_kind", what, "").into());
        }
        let relaxation = creep.relaxation();
        Ok(GrowingSphere { radius, creep, relaxation, load: Arc::new(load), step: None, rule: GaussLegendre::new(20) })
    }

    /// Contact radius a \[m\] at time `t` \[s\], 0 before t = 0; NaN where the force of the history is not finite, +∞
    /// where the creep overflows.
    pub fn contact_radius(&self, t: f64) -> f64 {
        if t < 0.0 {
            return 0.0;
        }
        let creep_of_force = match self.step {
            Some(force) => force * self.creep.compliance(t),
            // ∫ C(t − s) dW(s) = C(0) W(t) + ∫ C′(t − s) W(s) ds
            None => {
                let flow = self.creep.fluidity() * self.integrate(0.0, t, f64::INFINITY, &|s| self.force(s));
                let past = |tau: f64| self.integrate(0.0, t, tau, &|s| self.force(s) * ((s - t) / tau).exp());
                let branches = self.creep.terms().iter();
                let retarded: f64 = branches.map(|&(c, lambda)| c / lambda * past(lambda)).sum();
                self.creep.glassy() * self.force(t) + flow + retarded
            }
        };
        (0.75 * self.radius * creep_of_force).cbrt()
    }

    /// Approach ω \[m\] at time `t` \[s\].
    pub fn approach(&self, t: f64) -> f64 {
        self.contact_radius(t).powi(2) / self.radius
    }

    /// Pressure \[Pa\] at the distance `r` ≥ 0 from the centre \[m\] and time `t` \[s\]; NaN where the contact
    /// radius is not finite.
    pub fn pressure(&self, r: f64, t: f64) -> f64 {
        let now = self.contact_radius(t);
        if !now.is_finite() {
            return f64::NAN;
        }
        if r >= now {
            return 0.0;
        }
        let depth = |s: f64| {
            let a = self.contact_radius(s);
            if a < r { 0.0 } else { ((a - r) * (a + r)).sqrt() }
        };
        let entry = self.entry_time(r, t);
        let glassy: f64 = self.relaxation.modulus(0.0);
        let past = |tau: f64| self.integrate(entry, t, tau, &|s| depth(s) * ((s - t) / tau).exp());
        // a modulus over a time may overflow; the integral over the time is a depth
        let relaxed: f64 = self.relaxation.terms().iter().map(|&(e, tau)| e * (past(tau) / tau)).sum();
        2.0 / (PI * self.radius) * (glassy * depth(t) - relaxed)
    }

    fn force(&self, t: f64) -> f64 {
        match self.load.at(t) {
            Load::Force { normal, .. } => normal,
            Load::Approach { .. } | Load::Spring { .. } => f64::NAN,
        }
    }

    /// The time at which the contact first reached `r`.
    fn entry_time(&self, r: f64, t: f64) -> f64 {
        if self.contact_radius(0.0) >= r {
            return 0.0;
        }
        bisect(0.0, t, 100, |time| self.contact_radius(time) < r)[1]
    }

    /// ∫ f over [from, to] for f = (function with root-like behaviour at `from` and corners of the load)
    /// × e^(−(to − s)/decay): Gauss–Legendre on panels graded towards `from`, cut at the corners and
    /// doubling in length away from `to`.
    fn integrate(&self, from: f64, to: f64, decay: f64, f: &dyn Fn(f64) -> f64) -> f64 {
        let start = from.max(to - MAX_DECAY_TIMES * decay);
        if start >= to {
            return 0.0;
        }
        // (edge, whether the integrand may behave like a square root there)
        let mut edges = vec![(start, start == from), (to, false)];
        let mut age = decay;
        while age < to - start {
            edges.push((to - age, false));
            age *= 2.0;
        }
        edges.extend(self.load.breakpoints(start).take_while(|&time| time < to).map(|time| (time, true)));
        edges.sort_by(|a, b| a.0.total_cmp(&b.0));
        let panels = edges.windows(2).map(|pair| {
            let ((low, rooted), (high, _)) = (pair[0], pair[1]);
            let (mut above, mut sum) = (high, 0.0);
            for grade in 1..=if rooted { GRADES } else { 0 } {
                let below = low + (high - low) * 0.1_f64.powi(grade);
                sum += self.rule.integrate(below, above, f);
                above = below;
            }
            sum + self.rule.integrate(low, above, f)
        });
        panels.sum()
    }
}
