use std::f64::consts::PI;

use ellip::{elliprd, elliprf};

use crate::error::{Result, finite, non_negative, positive, within};
use crate::quadrature::bisect;

/// A paraboloid with two radii of curvature on an elastic half-space (Hertz 1882; Johnson, *Contact
/// Mechanics*, 1985, §4.2): the contact is an ellipse.
///
/// With semi-axes a ≥ b, m = 1 − b²/a² and D = (K − E)/m, the curvatures along and across are
/// (2p0/E*) (b/a²) D(m) and (2p0/E*) (K(m) − D(m))/b, W = (2π/3) p0 a b, ω = (p0/E*) b K(m).
///
/// ```
/// use viscocontact::analytic::{Hertz, HertzEllipse};
///
/// let ellipse = HertzEllipse::new([10.0e-3, 10.0e-3], 4.0e6, 1.0)?; // a sphere
/// let circle = Hertz::new(10.0e-3, 4.0e6, 1.0)?;
/// assert!((ellipse.semi_axes[0] / circle.contact_radius - 1.0).abs() < 1e-12);
/// assert!((ellipse.approach / circle.approach - 1.0).abs() < 1e-12);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct HertzEllipse {
    /// Semi-axes of the contact along x1 and x2 \[m\].
    pub semi_axes: [f64; 2],
    /// Peak pressure p0, at the centre \[Pa\].
    pub max_pressure: f64,
    /// Approach ω \[m\].
    pub approach: f64,
}

impl HertzEllipse {
    /// A paraboloid with `radii` of curvature along x1 and x2 \[m\] on a body of contact modulus
    /// `modulus` E* \[Pa\] under `force` \[N\].
    ///
    /// # Errors
    /// If a radius or the modulus is not finite and positive, the force negative, or the ratio of the
    /// radii outside \[1e-12, 1e12\].
    pub fn new(radii: [f64; 2], modulus: f64, force: f64) -> Result<HertzEllipse> {
        positive("radius of curvature along x1", radii[0])?;
        positive("radius of curvature along x2", radii[1])?;
        positive("contact modulus", modulus)?;
        non_negative("force", force)?;
        let (long, short) = (radii[0].max(radii[1]), radii[0].min(radii[1]));
        let ratio = long / short;
        within("ratio of the radii of curvature", radii[0] / radii[1], ratio <= 1e12, "in [1e-12, 1e12]")?;

        // the ratio of the curvatures, (a/b)² (K/D − 1), falls with k = b/a: bisect in ln k
        let [low, high] = bisect(-2.0 * ratio.ln() - 1.0, 0.0, 200, |middle| {
            let (k, d) = elliptic_integrals(middle.exp());
            (-2.0 * middle).exp() * (k / d - 1.0) > ratio
        });
        let flattening = (0.5 * (low + high)).exp();
        let (k, d) = elliptic_integrals(flattening);

        // 1/R_short = (2p0/E*)(K − D)/b with p0 = 3W/2πab and a = b/flattening
        let b = (3.0 * force * short * flattening * (k - d) / (PI * modulus)).cbrt();
        let a = b / flattening;
        let max_pressure = if force > 0.0 { 1.5 * force / (PI * a * b) } else { 0.0 };
        finite("semi-axis", a)?;
        finite("peak pressure", max_pressure)?;
        let approach = finite("approach", max_pressure / modulus * b * k)?;
        let semi_axes = if radii[0] >= radii[1] { [a, b] } else { [b, a] };
        Ok(HertzEllipse { semi_axes, max_pressure, approach })
    }

    /// Pressure at the point (x1, x2) \[m\], p0 √(1 − x1²/a1² − x2²/a2²) \[Pa\].
    pub fn pressure(&self, x1: f64, x2: f64) -> f64 {
        let rest = 1.0 - (x1 / self.semi_axes[0]).powi(2) - (x2 / self.semi_axes[1]).powi(2);
        if rest > 0.0 { self.max_pressure * rest.sqrt() } else { 0.0 }
    }
}

/// K(m) and D(m) = (K − E)/m for m = 1 − k², 0 < k ≤ 1, in Carlson's forms, which take k² and stay
/// accurate for slender ellipses: K = R_F(0, k², 1), D = R_D(0, k², 1)/3.
fn elliptic_integrals(k: f64) -> (f64, f64) {
    let square = k * k;
    // both are defined for every k² > 0
    (elliprf(0.0, square, 1.0).unwrap_or(f64::INFINITY), elliprd(0.0, square, 1.0).unwrap_or(f64::INFINITY) / 3.0)
}
