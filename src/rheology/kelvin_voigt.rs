use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// A spring and a dashpot in parallel: J = (1 − e^(−t/λ))/G, λ = η/G.
///
/// J(0) = 0: it has no elastic response and cannot follow a jump to a non-zero load; ramp the load.
#[derive(Debug, Clone, PartialEq)]
pub struct KelvinVoigt(CreepSpectrum);

impl KelvinVoigt {
    /// A body of shear modulus `g` \[Pa\] and shear viscosity `eta` \[Pa·s\].
    ///
    /// # Errors
    /// If either is not finite and positive.
    pub fn new(g: f64, eta: f64) -> Result<KelvinVoigt> {
        positive("shear modulus", g)?;
        positive("shear viscosity", eta)?;
        Ok(KelvinVoigt(CreepSpectrum::new(0.0, 0.0, &[(1.0 / g, eta / g)])?))
    }
}

forward_rheology!(self: KelvinVoigt => self.0);
