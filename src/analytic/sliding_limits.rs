use std::f64::consts::LN_2;

use super::HertzEllipse;
use crate::error::{Result, finite, positive, within};
use crate::numeric::EULER;
use crate::rheology::Material;

/// Friction of an indenter without an edge in steady motion, with no friction of its surface, over any creeping body,
/// where the motion is slow or fast against every term of the creep. Derived in docs/maintainers/claims.md; with one
/// retardation time the limits of the cylinder agree with S. C. Hunter's closed form
/// ([`RollingCylinder`](super::RollingCylinder)).
///
/// With w = K p, C(t) = C₀ + Σ C_k (1 − e^(−t/τ_k)) of the contact and C∞ = C₀ + Σ C_k:
///
/// * Slow, v τ ≪ a: u = C∞ w + v Σ C_k τ_k w′, and w″ = −1/(C∞ R₁) in contact, so that μ = v Σ C_k τ_k/(C∞ R₁). The
///   relative remainder is of the order v τ/a.
/// * Fast, v τ ≫ a, an ellipsoid: u′ = C₀ w′ − C′(0) w/v with the pressure of Hertz for C₀, of which the mean of C₀ w
///   is ω − (a₁²/R₁ + a₂²/R₂)/10: μ = C′(0)/(C₀ v) times this, C′(0) = Σ C_k/τ_k. Of a sphere 4a²/5R is left. The
///   remainder is of the order a/(v τ) ln(v τ/a).
/// * Fast, a cylinder: w falls with a logarithm, and the reach v τ remains in it: μ = (a²/2R) Σ C_k/(C₀ v τ_k) (ln(2
///   v τ_k/a) − γ + 1/4), γ of Euler. The remainder is of the order (a/v τ)² ln(v τ/a).
///
/// ```
/// use viscocontact::analytic::SlidingLimits;
/// use viscocontact::prelude::*;
///
/// let rubber = Material::incompressible(GeneralizedMaxwell::new(1.0e6, &[(1.0e7, 1.0e-4), (1.0e6, 1.0e-2)])?);
/// let ball = SlidingLimits::ellipsoid([10.0e-3, 10.0e-3], &rubber, 1.0)?;
/// assert!((ball.slow(2.0e-6) / ball.slow(1.0e-6) - 2.0).abs() < 1e-12);
/// assert!((ball.fast(1.0e6) / ball.fast(2.0e6) - 2.0).abs() < 1e-12);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SlidingLimits {
    /// μ/v of slow motion \[s/m\].
    slow: f64,
    /// v μ of fast motion \[m/s\], and what it grows by for each e-fold of the velocity.
    fast: f64,
    fast_per_log: f64,
}

impl SlidingLimits {
    /// An ellipsoid, or a sphere, of these `radii` of curvature along the motion and across it \[m\], under a `force`
    /// \[N\].
    ///
    /// # Errors
    /// If a radius or the force is not finite and positive, the ratio of the radii beyond 1e12, or the material has
    /// no series, or flows: its slow motion has no relaxed contact.
    pub fn ellipsoid(radii: [f64; 2], material: &Material, force: f64) -> Result<SlidingLimits> {
        positive("force", force)?;
        let creep = Creep::of(material)?;
        let hertz = HertzEllipse::new(radii, 1.0 / creep.glassy, force)?;
        let squares = hertz.semi_axes[0].powi(2) / radii[0] + hertz.semi_axes[1].powi(2) / radii[1];
        creep.limits(radii[0], (hertz.approach - 0.1 * squares, 0.0))
    }

    /// A cylinder of `radius` \[m\] across the motion in line contact, under `force` on a unit of its length \[N/m\].
    ///
    /// # Errors
    /// As [`SlidingLimits::ellipsoid`].
    pub fn cylinder(radius: f64, material: &Material, force: f64) -> Result<SlidingLimits> {
        positive("cylinder radius", radius)?;
        positive("force", force)?;
        let creep = Creep::of(material)?;
        let square = 4.0 * radius * creep.glassy * force / std::f64::consts::PI;
        let log = LN_2 - 0.5 * square.ln() - EULER + 0.25 + creep.mean_log;
        creep.limits(radius, (0.5 * square / radius * log, 0.5 * square / radius))
    }

    /// Coefficient of friction μ at a small `speed` \[m/s\].
    pub fn slow(&self, speed: f64) -> f64 {
        self.slow * speed
    }

    /// Coefficient of friction μ at a great `speed` \[m/s\].
    pub fn fast(&self, speed: f64) -> f64 {
        (self.fast + self.fast_per_log * speed.ln()) / speed
    }
}

/// Numbers of C(t) of a contact.
struct Creep {
    glassy: f64,
    relaxed: f64,
    /// Σ C_k τ_k.
    moment: f64,
    /// Σ C_k/τ_k, and the mean of ln τ_k weighted by its terms.
    rate: f64,
    mean_log: f64,
}

impl Creep {
    fn of(material: &Material) -> Result<Creep> {
        let creep = material.spectrum_for("a limit of steady motion")?;
        within("fluidity of the contact", creep.fluidity(), creep.fluidity() == 0.0, "0")?;
        positive("compliance at once", creep.glassy())?;
        let sum = |of: fn(f64, f64) -> f64| creep.terms().iter().map(|&(c, time)| of(c, time)).sum::<f64>();
        let rate = sum(|c, time| c / time);
        let mean_log = if rate > 0.0 { sum(|c, time| c / time * time.ln()) / rate } else { 0.0 };
        let (glassy, relaxed) = (creep.glassy(), creep.glassy() + sum(|c, _| c));
        Ok(Creep { glassy, relaxed, moment: sum(|c, time| c * time), rate, mean_log })
    }

    /// The limits for a radius along the motion, and the mean of C₀ w \[m\] with what it grows by for each e-fold of
    /// the velocity.
    fn limits(&self, radius: f64, (mean, per_log): (f64, f64)) -> Result<SlidingLimits> {
        let per_mean = self.rate / self.glassy;
        Ok(SlidingLimits {
            slow: finite("friction of slow motion", self.moment / (self.relaxed * radius))?,
            fast: finite("friction of fast motion", per_mean * mean)?,
            fast_per_log: finite("friction of fast motion", per_mean * per_log)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::RollingCylinder;
    use crate::rheology::GeneralizedKelvin;

    /// Hunter's closed form of one retardation time: the first order at the slow end, the second with a logarithm at
    /// the fast one.
    #[test]
    fn limits_of_a_cylinder_are_hunters() {
        let (radius, c0, c1, force) = (1.0, 0.25e-6, 2.25e-6, 5.0e3);
        let body = Material::incompressible(GeneralizedKelvin::new(4.0 * c0, 0.0, &[(4.0 * c1, 1.0)]).unwrap());
        let limits = SlidingLimits::cylinder(radius, &body, force).unwrap();
        let exact = |reach: f64| RollingCylinder::new(radius, [c0, c1], force, reach).unwrap().friction;
        let error = |reach: f64, fast: bool| {
            let limit = if fast { limits.fast(reach) } else { limits.slow(reach) };
            (limit / exact(reach) - 1.0).abs()
        };
        let half = (4.0 * radius * c0 * force / std::f64::consts::PI).sqrt();
        for (near, far, fast, orders) in [(1e-3, 1e-2, false, 0.98..1.02), (1e3, 1e2, true, 1.9..2.1)] {
            let [near, far] = [near, far].map(|reach| error(reach * half, fast));
            let order = (far / near).log10();
            assert!(orders.contains(&order) && far < 0.04, "{near:e} {far:e}: {order}");
        }
    }

    /// A sphere is an ellipsoid of equal radii, and a long ellipsoid across the motion creeps slowly like a cylinder.
    #[test]
    fn limits_of_a_sphere_have_its_radius() {
        let body = Material::incompressible(GeneralizedKelvin::new(1e-6, 0.0, &[(1e-6, 0.1), (2e-6, 3.0)]).unwrap());
        let radius = 10e-3;
        let sphere = SlidingLimits::ellipsoid([radius; 2], &body, 1.0).unwrap();
        let a = (0.75f64 * radius * 0.25e-6).cbrt();
        assert!((sphere.fast(1e4) / (0.8 * a * a / radius * (10.0 + 2.0 / 3.0) / 1e4) - 1.0).abs() < 1e-10);
        let moment = 0.1 + 6.0;
        assert!((sphere.slow(1e-7) / (1e-7 * moment / (4.0 * radius)) - 1.0).abs() < 1e-12);
        let flows = Material::incompressible(GeneralizedKelvin::new(1e-6, 1e-6, &[]).unwrap());
        assert!(SlidingLimits::ellipsoid([radius; 2], &flows, 1.0).is_err());
    }
}
