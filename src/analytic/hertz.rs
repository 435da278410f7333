use std::f64::consts::PI;

use crate::error::{Result, finite, non_negative, positive};

/// A sphere on an elastic half-space (Hertz 1882; Johnson, *Contact Mechanics*, 1985, §4.2):
/// a³ = 3WR/4E*, p0 = 2aE*/πR, ω = a²/R.
///
/// ```
/// use viscocontact::analytic::Hertz;
///
/// let hertz = Hertz::new(10.0e-3, 4.0e6, 1.0)?;
/// assert!((hertz.contact_radius - 1.2331e-3).abs() < 1e-7);
/// assert_eq!(hertz.pressure(hertz.contact_radius), 0.0);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Hertz {
    /// Contact radius a \[m\].
    pub contact_radius: f64,
    /// Peak pressure p0, at the centre \[Pa\].
    pub max_pressure: f64,
    /// Approach ω \[m\].
    pub approach: f64,
}

impl Hertz {
    /// A sphere of `radius` \[m\] on a body of contact modulus `modulus` E* \[Pa\] under `force` \[N\].
    ///
    /// # Errors
    /// If the radius or the modulus is not finite and positive, or the force negative.
    pub fn new(radius: f64, modulus: f64, force: f64) -> Result<Hertz> {
        positive("sphere radius", radius)?;
        positive("contact modulus", modulus)?;
        non_negative("force", force)?;
        let contact_radius = (0.75 * force * radius / modulus).cbrt();
        let max_pressure = finite("peak pressure", 2.0 * contact_radius * modulus / (PI * radius))?;
        let approach = finite("approach", contact_radius * contact_radius / radius)?;
        Ok(Hertz { contact_radius, max_pressure, approach })
    }

    /// Pressure at the distance `r` from the centre \[m\], p0 √(1 − r²/a²) \[Pa\].
    pub fn pressure(&self, r: f64) -> f64 {
        if r < self.contact_radius { self.max_pressure * (1.0 - (r / self.contact_radius).powi(2)).sqrt() } else { 0.0 }
    }
}
