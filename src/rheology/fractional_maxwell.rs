use crate::error::{Result, positive};
use crate::rheology::Rheology;
use crate::rheology::power_law::fractional_order;

/// A spring and a springpot in series: J(t) = 1/G + t^α/(V Γ(1 + α)).
///
/// An elastic response, followed by unbounded power-law creep: asphalt, cells, and Findley's law of polymers J = J₀ + m
/// tⁿ, with α = n and V = 1/(m Γ(1 + n)). For α → 1 it becomes a Maxwell body of viscosity V.
///
/// ```
/// use viscocontact::rheology::{FractionalMaxwell, Rheology};
///
/// let polymer = FractionalMaxwell::findley(0.4e-9, 0.02e-9, 0.25)?;
/// assert!((polymer.creep_compliance(16.0) / 0.44e-9 - 1.0).abs() < 1e-14);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FractionalMaxwell {
    glassy: f64,
    /// Creep beyond the glassy compliance after 1 s.
    rate: f64,
    exponent: f64,
}

impl FractionalMaxwell {
    /// A spring of shear `modulus` G \[Pa\] in series with a springpot of `quasi_property` V \[Pa·s^α\] and
    /// `exponent` α, σ = V d^α γ/dt^α.
    ///
    /// # Errors
    /// If the modulus or the quasi-property is not finite and positive, or the exponent is outside (0, 1).
    pub fn new(modulus: f64, quasi_property: f64, exponent: f64) -> Result<FractionalMaxwell> {
        positive("shear modulus", modulus)?;
        positive("quasi-property", quasi_property)?;
        fractional_order(exponent)?;
        let glassy = positive("compliance 1/G", 1.0 / modulus)?;
        let rate = positive("creep after 1 s", 1.0 / (quasi_property * libm::tgamma(1.0 + exponent)))?;
        Ok(FractionalMaxwell { glassy, rate, exponent })
    }

    /// A spring of shear `modulus` G \[Pa\] in series with a springpot that creeps as much as the spring, but for a
    /// factor 1/Γ(1 + α), in the `time` τ \[s\]: J = (1 + (t/τ)^α/Γ(1 + α))/G, V = G τ^α.
    ///
    /// # Errors
    /// If the modulus or the time is not finite and positive, or the exponent is outside (0, 1).
    pub fn with_time(modulus: f64, time: f64, exponent: f64) -> Result<FractionalMaxwell> {
        positive("shear modulus", modulus)?;
        positive("time", time)?;
        fractional_order(exponent)?;
        FractionalMaxwell::new(modulus, modulus * time.powf(exponent), exponent)
    }

    /// Findley's form J = J₀ + m tⁿ: `glassy` compliance J₀ \[1/Pa\], `coefficient` m \[1/(Pa·sⁿ)\], `exponent` n.
    ///
    /// # Errors
    /// If J₀ or m is not finite and positive, or the exponent is outside (0, 1).
    pub fn findley(glassy: f64, coefficient: f64, exponent: f64) -> Result<FractionalMaxwell> {
        positive("glassy compliance", glassy)?;
        positive("creep coefficient", coefficient)?;
        fractional_order(exponent)?;
        Ok(FractionalMaxwell { glassy, rate: coefficient, exponent })
    }
}

impl Rheology for FractionalMaxwell {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.glassy + self.rate * t.powf(self.exponent)
    }
}
