use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// An elastic body: J = 1/G.
#[derive(Debug, Clone, PartialEq)]
pub struct Elastic(CreepSpectrum);

impl Elastic {
    /// An elastic body of shear modulus `g` \[Pa\].
    ///
    /// # Errors
    /// If the modulus is not finite and positive.
    pub fn new(g: f64) -> Result<Elastic> {
        positive("shear modulus", g)?;
        Ok(Elastic(CreepSpectrum::new(1.0 / g, 0.0, &[])?))
    }
}

forward_rheology!(self: Elastic => self.0);
