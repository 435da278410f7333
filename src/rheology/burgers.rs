use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// A Maxwell and a Kelvin–Voigt element in series:
/// J = 1/G + t/η + (1 − e^(−t/λ))/G_K, λ = η_K/G_K. A fluid with delayed elasticity.
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
}

forward_rheology!(self: Burgers => self.0);
