use std::f64::consts::PI;

use super::Bodies;
use crate::error::{Result, positive};
use crate::quadrature::bisect;

/// A wavy surface of gap D (1 − cos 2πx/λ) that sticks to an elastic half-space in plane strain, by an attraction of
/// vanishing range (Johnson, Int. J. Solids Struct. 32, 1995): the mean pressure is p* (sin² ψ − α √tan ψ) at
/// contacts of half-width a = λψ/π, with p* = πE*D/λ and α² = 2wλ/(π²D²E*).
///
/// ```
/// use viscocontact::analytic::AdhesiveWave;
///
/// let wave = AdhesiveWave::new(1.0e-6, 1.0e-4, 1.0e5, 1.0e-5)?;
/// assert!(wave.pull_off_pressure() < 0.0);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesiveWave {
    bodies: Bodies,
    wavelength: f64,
}

impl AdhesiveWave {
    /// A wave of `amplitude` D \[m\] and `wavelength` λ \[m\] on a body of contact `modulus` E* \[Pa\] with the
    /// `work` of separation w \[J/m²\].
    ///
    /// # Errors
    /// If one of them is not finite and positive.
    pub fn new(amplitude: f64, wavelength: f64, modulus: f64, work: f64) -> Result<AdhesiveWave> {
        positive("wavelength", wavelength)?;
        Ok(AdhesiveWave { bodies: Bodies::new("amplitude", amplitude, modulus, work)?, wavelength })
    }

    /// α, the strength of the attraction: from 0.57 on the surfaces jump into full contact without load.
    pub fn strength(&self) -> f64 {
        let Bodies { length, modulus, work } = self.bodies;
        (2.0 * work * self.wavelength / modulus).sqrt() / (PI * length)
    }

    /// The mean pressure \[Pa\] at the half-width a of the contacts, 0 ≤ a ≤ λ/2 \[m\].
    pub fn mean_pressure(&self, half_width: f64) -> f64 {
        let (full, angle) =
            (PI * self.bodies.modulus * self.bodies.length / self.wavelength, PI * half_width / self.wavelength);
        full * (angle.sin().powi(2) - self.strength() * angle.tan().sqrt())
    }

    /// The half-width of the contacts at [`AdhesiveWave::pull_off_pressure`] \[m\]; NaN for α > 1.065, where isolated
    /// contacts have no minimum mean pressure.
    pub fn width_at_pull_off(&self) -> f64 {
        // the slope vanishes where sin 2ψ √tan ψ cos² ψ = α/2: at the minimum, and beyond the greatest left side at a
        // maximum
        let steepness = |angle: f64| (2.0 * angle).sin() * angle.tan().sqrt() * angle.cos().powi(2);
        let steepest = 0.375f64.sqrt().asin();
        let wanted = 0.5 * self.strength();
        if wanted > steepness(steepest) {
            return f64::NAN;
        }
        self.wavelength / PI * bisect(0.0, steepest, 60, |angle| steepness(angle) < wanted)[1]
    }

    /// The minimum mean pressure \[Pa\] of isolated contacts.
    pub fn pull_off_pressure(&self) -> f64 {
        self.mean_pressure(self.width_at_pull_off())
    }
}
