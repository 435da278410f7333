use std::f64::consts::PI;

use crate::error::{Result, finite, non_negative, positive, within};

/// A rigid flat circular punch on an elastic half-space, loaded at a distance e ≤ R/3 from its axis, so
/// that its whole face stays in contact (Boussinesq for e = 0, Lur'e 1964 for e > 0; Figure 2 of the
/// [paper](crate::paper)):
///
/// p = W/(2πR²) (1 + 3 e x1/R²)/√(1 − r²/R²), ω = W/(2RE*), α1 = 3We/(4R³E*).
///
/// ```
/// use viscocontact::analytic::RigidPunch;
///
/// let punch = RigidPunch::new(1.0e-3, 4.0e6, 1.0, 0.2e-3)?;
/// assert!(punch.tilt > 0.0);
/// assert!(punch.pressure(0.5e-3, 0.0) > punch.pressure(-0.5e-3, 0.0));
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RigidPunch {
    /// Approach ω of the centre of the face \[m\].
    pub approach: f64,
    /// Tilt α1: the face lowers the surface by ω + α1 x1 \[rad\].
    pub tilt: f64,
    radius: f64,
    eccentricity: f64,
    mean_pressure: f64,
}

impl RigidPunch {
    /// A punch of `radius` R \[m\] on a body of contact modulus `modulus` E* \[Pa\] under `force` W \[N\] at
    /// the point (`eccentricity`, 0) \[m\].
    ///
    /// # Errors
    /// If the radius or the modulus is not finite and positive, the force negative, or the eccentricity
    /// outside \[−R/3, R/3\], where the contact opens.
    pub fn new(radius: f64, modulus: f64, force: f64, eccentricity: f64) -> Result<RigidPunch> {
        positive("punch radius", radius)?;
        positive("contact modulus", modulus)?;
        non_negative("force", force)?;
        let inside = eccentricity.abs() <= radius / 3.0;
        within("eccentricity", eccentricity, inside, "in [-R/3, R/3], otherwise the contact opens")?;
        Ok(RigidPunch {
            radius,
            eccentricity,
            mean_pressure: finite("mean pressure", force / (PI * radius * radius))?,
            approach: finite("approach", force / (2.0 * radius * modulus))?,
            tilt: finite("tilt", 0.75 * (force / (radius * modulus)) * (eccentricity / radius) / radius)?,
        })
    }

    /// Pressure at the point (x1, x2) \[m\], infinite on the rim where it is not zero \[Pa\].
    pub fn pressure(&self, x1: f64, x2: f64) -> f64 {
        let (x, y) = (x1 / self.radius, x2 / self.radius);
        let rest = 1.0 - x * x - y * y;
        if rest < 0.0 {
            return 0.0;
        }
        let numerator = 0.5 * self.mean_pressure * (1.0 + 3.0 * (self.eccentricity / self.radius) * x);
        if numerator == 0.0 { 0.0 } else { numerator / rest.sqrt() }
    }
}
