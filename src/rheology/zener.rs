use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// The standard linear solid, a spring in series with a Kelvin–Voigt element:
/// J = 1/G + (1 − e^(−t/λ))/G_K, retardation time λ = η_K/G_K.
#[derive(Debug, Clone, PartialEq)]
pub struct Zener(CreepSpectrum);

impl Zener {
    /// A body of glassy shear modulus `g` \[Pa\] whose Kelvin–Voigt element has modulus `g_k` \[Pa\] and
    /// viscosity `eta_k` \[Pa·s\].
    ///
    /// # Errors
    /// If one is not finite and positive.
    pub fn new(g: f64, g_k: f64, eta_k: f64) -> Result<Zener> {
        positive("shear modulus", g)?;
        positive("Kelvin–Voigt modulus", g_k)?;
        positive("Kelvin–Voigt viscosity", eta_k)?;
        Ok(Zener(CreepSpectrum::new(1.0 / g, 0.0, &[(1.0 / g_k, eta_k / g_k)])?))
    }
}

forward_rheology!(self: Zener => self.0);
