use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// A spring and a dashpot in series: J = 1/G + t/η, relaxation time τ = η/G. A fluid.
///
/// ```
/// use viscocontact::rheology::{Maxwell, Rheology};
///
/// let body = Maxwell::new(1.0e6, 2.0e6)?; // 1 MPa, 2 MPa·s
/// assert_eq!(body.creep_compliance(2.0), 2.0e-6);
/// assert_eq!(body, Maxwell::with_time(1.0e6, 2.0)?); // 1 MPa, 2 s
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

    /// A body of shear modulus `g` \[Pa\] and `relaxation_time` τ \[s\]: G(t) = G e^(−t/τ), η = G τ.
    ///
    /// # Errors
    /// If either is not finite and positive.
    pub fn with_time(g: f64, relaxation_time: f64) -> Result<Maxwell> {
        positive("shear modulus", g)?;
        positive("relaxation time", relaxation_time)?;
        Maxwell::new(g, g * relaxation_time)
    }
}

forward_rheology!(self: Maxwell => self.0);
