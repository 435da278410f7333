use crate::error::{Result, positive, within};
use crate::rheology::Rheology;

/// Log-power creep: J(t) = J_g + c ln(1 + (t/λ)ⁿ), a power law of exponent n up to the time λ, then logarithmic.
///
/// The basic creep of concrete in the solidification theory of Bažant & Prasannan (J. Eng. Mech. 115, 1989), which
/// model B3 uses with n = 0.1 and λ = 1 day; here without ageing. With n = 1 it is
/// [`LogCreep`](crate::rheology::LogCreep).
///
/// ```
/// use viscocontact::rheology::{Rheology, SlowCreep};
///
/// let day = 86_400.0;
/// let concrete = SlowCreep::new(25.0e-12, 60.0e-12, day, 0.1)?;
/// let decade = concrete.creep_compliance(1.0e14 * day) - concrete.creep_compliance(1.0e13 * day);
/// assert!((decade / (60.0e-12 * 0.1 * 10f64.ln()) - 1.0).abs() < 0.1); // n c a decade in the end
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlowCreep {
    glassy: f64,
    strength: f64,
    time: f64,
    exponent: f64,
}

impl SlowCreep {
    /// A body of `glassy` compliance J_g and creep of `strength` c \[1/Pa\], logarithmic after the `time` λ \[s\]
    /// and a power law of `exponent` n before.
    ///
    /// # Errors
    /// If J_g, c or λ is not finite and positive, or n is outside (0, 1\].
    pub fn new(glassy: f64, strength: f64, time: f64, exponent: f64) -> Result<SlowCreep> {
        positive("glassy compliance", glassy)?;
        positive("strength of the creep", strength)?;
        positive("onset of logarithmic creep", time)?;
        within("exponent", exponent, exponent > 0.0 && exponent <= 1.0, "in (0, 1]")?;
        Ok(SlowCreep { glassy, strength, time, exponent })
    }
}

impl Rheology for SlowCreep {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.glassy + self.strength * (t / self.time).powf(self.exponent).ln_1p()
    }
}
