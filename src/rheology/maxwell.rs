use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// A spring and a dashpot in series: J = 1/G + t/η, relaxation time τ = η/G. A fluid.
///
/// ```
/// use viscocontact::rheology::{Maxwell, Rheology};
///
/// let body = Maxwell::new(1.0e6, 2.0e6)?;
/// assert_eq!(body.creep_compliance(2.0), 2.0e-6);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Maxwell(CreepSpectrum);

impl Maxwell {
    /// A body of shear modulus `g` \[Pa\] and shear viscosity `eta` \[Pa·s\].
    ///
    /// # Errors
    /// If either is not finite and positive.
    pub fn new(g: f64, eta: f64) -> Result<Maxwell> {
        positive("shear modulus", g)?;
        positive("shear viscosity", eta)?;
        Ok(Maxwell(CreepSpectrum::new(1.0 / g, 1.0 / eta, &[])?))
    }
}

forward_rheology!(self: Maxwell => self.0);
