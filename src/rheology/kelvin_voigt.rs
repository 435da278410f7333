use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// A spring and a dashpot in parallel: J = (1 − e^(−t/λ))/G, λ = η/G.
///
/// J(0) = 0: it has no elastic response and cannot follow a jump to a non-zero load; ramp the load.
///
/// ```
/// use viscocontact::rheology::{KelvinVoigt, Rheology};
///
/// let body = KelvinVoigt::with_time(1.0e6, 0.5)?; // 1 MPa, 0.5 s
/// let share = body.creep_compliance(0.5) * 1.0e6; // at t = λ, all but 1/e
/// assert!((share - (1.0 - (-1.0_f64).exp())).abs() < 1e-15);
/// # Ok::<(), viscocontact::Error>(())
/// ```
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
        KelvinVoigt::with_time(g, eta / g)
    }

    /// A body of shear modulus `g` \[Pa\] and `retardation_time` λ \[s\]: η = G λ.
    ///
    /// # Errors
    /// If either is not finite and positive.
    pub fn with_time(g: f64, retardation_time: f64) -> Result<KelvinVoigt> {
        positive("shear modulus", g)?;
        positive("retardation time", retardation_time)?;
        Ok(KelvinVoigt(CreepSpectrum::new(0.0, 0.0, &[(1.0 / g, retardation_time)])?))
    }
}

forward_rheology!(self: KelvinVoigt => self.0);
