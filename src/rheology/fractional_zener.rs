use crate::error::{Result, positive};
use crate::rheology::Rheology;
use crate::rheology::mittag_leffler::mittag_leffler_rise;
use crate::rheology::power_law::fractional_order;
use crate::rheology::zener::relaxed_element;

/// The standard linear solid with a springpot in place of the dashpot:
/// J(t) = 1/G + (1/G_K) [1 − E_α(−(t/λ)^α)], E_α the Mittag-Leffler function.
///
/// Four parameters describe the whole transition of a rubber or a polymer from glassy to relaxed (the Cole–Cole form):
/// G*(ω) has a broad, symmetric loss peak whose slopes are ±α.
///
/// ```
/// use viscocontact::rheology::{FractionalZener, Rheology};
///
/// let rubber = FractionalZener::new(1.0e9, 1.0e6, 1.0e-3, 0.5)?;
/// assert_eq!(rubber.creep_compliance(0.0), 1.0e-9);
/// let relaxed = 1.0e-9 + 1.0e-6;
/// assert!((rubber.creep_compliance(1.0e9) / relaxed - 1.0).abs() < 1e-6);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractionalZener {
    glassy: f64,
    retarded: f64,
    time: f64,
    exponent: f64,
}

impl FractionalZener {
    /// A spring of shear modulus `g` \[Pa\] in series with a spring `g_k` \[Pa\] and a springpot in parallel, whose
    /// retardation time is `time` λ \[s\] and order `exponent` α. The springpot has V = G_K λ^α.
    ///
    /// # Errors
    /// If a modulus or the time is not finite and positive, or the exponent is outside (0, 1).
    pub fn new(g: f64, g_k: f64, time: f64, exponent: f64) -> Result<FractionalZener> {
        positive("shear modulus", g)?;
        positive("Kelvin–Voigt modulus", g_k)?;
        positive("compliance 1/G", 1.0 / g)?;
        positive("compliance 1/G_K", 1.0 / g_k)?;
        positive("retardation time", time)?;
        fractional_order(exponent)?;
        Ok(FractionalZener { glassy: 1.0 / g, retarded: 1.0 / g_k, time, exponent })
    }

    /// A body whose shear modulus relaxes from `glassy` to `rubbery` \[Pa\] with the relaxation `time` τ \[s\] and
    /// order `exponent` α: G(t) = rubbery + (glassy − rubbery) E_α(−(t/τ)^α). It creeps slower, λ = τ
    /// (glassy/rubbery)^(1/α).
    ///
    /// # Errors
    /// If the moduli or the time are not finite and positive, the glassy modulus is not the greater one, the exponent
    /// is outside (0, 1), or the retardation time exceeds the range of `f64`.
    pub fn relaxing(glassy: f64, rubbery: f64, time: f64, exponent: f64) -> Result<FractionalZener> {
        let [ratio, g_k] = relaxed_element(glassy, rubbery)?;
        positive("relaxation time", time)?;
        fractional_order(exponent)?;
        FractionalZener::new(glassy, g_k, time * ratio.powf(1.0 / exponent), exponent)
    }
}

impl Rheology for FractionalZener {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.glassy + self.retarded * mittag_leffler_rise(self.exponent, (t / self.time).powf(self.exponent))
    }
}
