use crate::error::{Result, positive, within};
use crate::rheology::Rheology;

/// A springpot, the element of fractional calculus between spring and dashpot: J(t) = J₁ (t/t₁)^α.
///
/// It has no elastic response and no characteristic time. In terms of the quasi-property V of σ = V d^α γ/dt^α,
/// J₁ = t₁^α/(V Γ(1 + α)). A power law with an elastic response is
/// [`FractionalMaxwell`](crate::rheology::FractionalMaxwell).
///
/// ```
/// use viscocontact::rheology::{PowerLaw, Rheology};
///
/// let cell = PowerLaw::new(1.0e-3, 1.0, 0.2)?; // 1/kPa at 1 s
/// assert!((cell.creep_compliance(32.0) - 2.0e-3).abs() < 1e-15);
/// let series = cell.series(1.0e-3..=1.0e7, 1.0e-4)?; // ten decades
/// assert!(series.report().terms() <= 30);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    compliance: f64,
    time: f64,
    exponent: f64,
}

impl PowerLaw {
    /// A body of shear creep `compliance` J₁ \[1/Pa\] at the `time` t₁ \[s\], creeping with `exponent` α.
    ///
    /// # Errors
    /// If the compliance or the time is not finite and positive, or the exponent is outside (0, 1).
    pub fn new(compliance: f64, time: f64, exponent: f64) -> Result<PowerLaw> {
        positive("creep compliance", compliance)?;
        positive("reference time", time)?;
        fractional_order(exponent)?;
        Ok(PowerLaw { compliance, time, exponent })
    }
}

/// Accepts orders of fractional elements; 0 and 1 are spring and dashpot, which have separate models.
pub(super) fn fractional_order(exponent: f64) -> Result<f64> {
    within("exponent", exponent, exponent > 0.0 && exponent < 1.0, "in (0, 1)")
}

impl Rheology for PowerLaw {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.compliance * (t / self.time).powf(self.exponent)
    }
}
