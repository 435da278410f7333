use crate::error::{Result, poisson_ratio, positive};
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

    /// An elastic body of Young's modulus `e` \[Pa\] and Poisson's ratio `nu`: G = E/(2 (1 + ν)).
    /// [`Material::constant_poisson`](crate::rheology::Material::constant_poisson) takes the same ratio.
    ///
    /// ```
    /// use viscocontact::rheology::{Elastic, Material};
    ///
    /// let steel = Material::constant_poisson(Elastic::young(210.0e9, 0.3)?, 0.3)?;
    /// assert!((steel.contact_compliance(0.0) * 210.0e9 / (1.0 - 0.3 * 0.3) - 1.0).abs() < 1e-14); // 1/E*
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the modulus is not finite and positive, or `nu` is outside (−1, ½].
    pub fn young(e: f64, nu: f64) -> Result<Elastic> {
        positive("Young's modulus", e)?;
        Elastic::new(e / (2.0 * (1.0 + poisson_ratio("Poisson's ratio", nu)?)))
    }
}

forward_rheology!(self: Elastic => self.0);
