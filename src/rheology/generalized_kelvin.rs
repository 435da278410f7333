use crate::error::Result;
use crate::rheology::{CreepSpectrum, forward_rheology};

/// A spring, a dashpot and any number of Kelvin–Voigt elements in series:
/// J = J_g + φ t + Σ J_k (1 − e^(−t/λ_k)).
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedKelvin(CreepSpectrum);

impl GeneralizedKelvin {
    /// A body of `glassy_compliance` \[1/Pa\], `fluidity` \[1/(Pa·s)\] and `terms` of (compliance \[1/Pa\],
    /// retardation time \[s\]).
    ///
    /// # Errors
    /// As [`CreepSpectrum::new`].
    pub fn new(glassy_compliance: f64, fluidity: f64, terms: &[(f64, f64)]) -> Result<GeneralizedKelvin> {
        Ok(GeneralizedKelvin(CreepSpectrum::new(glassy_compliance, fluidity, terms)?))
    }
}

forward_rheology!(self: GeneralizedKelvin => self.0);
