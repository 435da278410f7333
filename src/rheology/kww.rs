use crate::error::{Result, non_negative, positive, within};
use crate::rheology::Rheology;

/// Creep by a stretched exponential (Kohlrausch, Williams and Watts): J(t) = J_g + ΔJ [1 − e^(−(t/λ)^β)].
///
/// Glassy polymers below their transition, amorphous solids, rubber near equilibrium. The creep is a stretched
/// exponential; for a *relaxation modulus* of this form fit its values:
/// [`Measurements::relaxation`](crate::rheology::Measurements::relaxation).
///
/// ```
/// use viscocontact::rheology::{Kww, Rheology};
///
/// let pvc = Kww::new(0.5e-9, 2.0e-9, 1.0e4, 0.33)?;
/// let after = pvc.creep_compliance(1.0e4); // at t = λ, all but 1/e of ΔJ
/// assert!((after / (0.5e-9 + 2.0e-9 * (1.0 - (-1.0_f64).exp())) - 1.0).abs() < 1e-14);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kww {
    glassy: f64,
    retarded: f64,
    time: f64,
    exponent: f64,
}

impl Kww {
    /// A body of `glassy` compliance J_g and `retarded` compliance ΔJ \[1/Pa\], with the retardation `time` λ
    /// \[s\] and the `exponent` β.
    ///
    /// # Errors
    /// If J_g is negative, ΔJ or λ is not finite and positive, or β is outside (0, 1\].
    pub fn new(glassy: f64, retarded: f64, time: f64, exponent: f64) -> Result<Kww> {
        non_negative("glassy compliance", glassy)?;
        positive("retarded compliance", retarded)?;
        positive("retardation time", time)?;
        within("exponent", exponent, exponent > 0.0 && exponent <= 1.0, "in (0, 1]")?;
        Ok(Kww { glassy, retarded, time, exponent })
    }
}

impl Rheology for Kww {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.glassy - self.retarded * (-(t / self.time).powf(self.exponent)).exp_m1()
    }
}
