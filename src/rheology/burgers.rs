use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// A Maxwell and a Kelvin–Voigt element in series:
/// J = 1/G + t/η + (1 − e^(−t/λ))/G_K, λ = η_K/G_K. A fluid with delayed elasticity.
///
/// ```
/// use viscocontact::rheology::{Burgers, Rheology};
///
/// let asphalt = Burgers::with_times((1.0e9, 100.0), (1.0e8, 5.0))?; // (modulus, time) of each element
/// let creep = 1.0e-9 + 10.0 / (1.0e9 * 100.0) + 1.0e-8 * (1.0 - (-2.0_f64).exp());
/// assert!((asphalt.creep_compliance(10.0) / creep - 1.0).abs() < 1e-14);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Burgers(CreepSpectrum);

impl Burgers {
    /// A body with the Maxwell element (`g` \[Pa\], `eta` \[Pa·s\]) and the Kelvin–Voigt element
    /// (`g_k` \[Pa\], `eta_k` \[Pa·s\]).
    ///
    /// # Errors
    /// If one is not finite and positive.
    pub fn new(g: f64, eta: f64, g_k: f64, eta_k: f64) -> Result<Burgers> {
        positive("shear modulus", g)?;
        positive("shear viscosity", eta)?;
        positive("Kelvin–Voigt modulus", g_k)?;
        positive("Kelvin–Voigt viscosity", eta_k)?;
        Ok(Burgers(CreepSpectrum::new(1.0 / g, 1.0 / eta, &[(1.0 / g_k, eta_k / g_k)])?))
    }

    /// A body with the Maxwell element (modulus G \[Pa\], relaxation time τ = η/G \[s\]) and the Kelvin–Voigt element
    /// (modulus G_K \[Pa\], retardation time λ \[s\]).
    ///
    /// # Errors
    /// If one is not finite and positive.
    pub fn with_times((g, relaxation_time): (f64, f64), (g_k, retardation_time): (f64, f64)) -> Result<Burgers> {
        positive("shear modulus", g)?;
        positive("relaxation time", relaxation_time)?;
        positive("Kelvin–Voigt modulus", g_k)?;
        positive("retardation time", retardation_time)?;
        let fluidity = 1.0 / (g * relaxation_time);
        Ok(Burgers(CreepSpectrum::new(1.0 / g, fluidity, &[(1.0 / g_k, retardation_time)])?))
    }
}

forward_rheology!(self: Burgers => self.0);
