use crate::error::{Result, positive};
use crate::rheology::{CreepSpectrum, exponential_rheology};

/// An elastic body: J = 1/G.
#[derive(Debug, Clone, PartialEq)]
pub struct Elastic {
    spectrum: CreepSpectrum,
}

impl Elastic {
    /// An elastic body of shear modulus `g` \[Pa\].
    ///
    /// # Errors
    /// If the modulus is not finite and positive.
    pub fn new(g: f64) -> Result<Elastic> {
        positive("shear modulus", g)?;
        Ok(Elastic { spectrum: CreepSpectrum::new(1.0 / g, 0.0, &[])? })
    }
}

exponential_rheology!(Elastic);
