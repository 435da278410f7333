use crate::error::{Result, least_length};
use crate::rheology::{CreepSpectrum, RelaxationSpectrum, forward_rheology};

/// A spring and any number of Maxwell elements in parallel (a Prony series):
/// G(t) = G_∞ + Σ G_k e^(−t/τ_k). A solid if G_∞ > 0, otherwise a fluid.
///
/// ```
/// use viscocontact::rheology::{GeneralizedMaxwell, Rheology};
///
/// let body = GeneralizedMaxwell::new(1.0e6, &[(3.0e6, 0.1), (1.0e6, 10.0)])?;
/// assert!((body.creep_compliance(0.0) * 5.0e6 - 1.0).abs() < 1e-14); // glassy: 1/ΣG
/// assert!((body.creep_compliance(1.0e6) * 1.0e6 - 1.0).abs() < 1e-14); // relaxed: 1/G_∞
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedMaxwell(CreepSpectrum);

impl GeneralizedMaxwell {
    /// A body of `equilibrium` modulus \[Pa\] (0 for a fluid) and `terms` of (modulus \[Pa\], relaxation
    /// time \[s\]).
    ///
    /// # Errors
    /// As [`RelaxationSpectrum::new`]; also without terms.
    pub fn new(equilibrium: f64, terms: &[(f64, f64)]) -> Result<GeneralizedMaxwell> {
        least_length("Maxwell elements", terms.len(), 1)?;
        Ok(GeneralizedMaxwell(RelaxationSpectrum::new(equilibrium, 0.0, terms)?.creep()))
    }
}

forward_rheology!(self: GeneralizedMaxwell => self.0);
