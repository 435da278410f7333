use std::sync::Arc;

use crate::error::{Error, Result, within};
use crate::rheology::{CreepSpectrum, Rheology};

/// A rheology and how it treats volume: together they give the contact creep compliance C(t), the
/// surface's answer to pressure, with C = 1/E* = (1 − ν)/2G for an elastic body.
///
/// | volume | C(t) |
/// |---|---|
/// | [`Material::incompressible`] | J(t)/4 |
/// | [`Material::constant_poisson`] | (1 − ν) J(t)/2 |
///
/// ```
/// use viscocontact::rheology::{Elastic, Material};
///
/// let steel = Material::constant_poisson(Elastic::new(80.0e9)?, 0.3)?;
/// let modulus = 1.0 / steel.contact_compliance(0.0); // E* = 2G/(1 − ν)
/// assert!((modulus - 160.0e9 / 0.7).abs() < 1.0);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Material {
    rheology: Arc<dyn Rheology>,
    /// C(t)/J(t).
    factor: f64,
}

impl Material {
    /// A body that keeps its volume (ν = ½): C = J/4.
    pub fn incompressible(rheology: impl Rheology + 'static) -> Material {
        Material { rheology: Arc::new(rheology), factor: 0.25 }
    }

    /// A body whose Poisson's ratio `nu` does not change with time: C = (1 − ν) J/2.
    ///
    /// # Errors
    /// If `nu` is outside (−1, ½].
    pub fn constant_poisson(rheology: impl Rheology + 'static, nu: f64) -> Result<Material> {
        let nu = within("Poisson's ratio", nu, nu > -1.0 && nu <= 0.5, "in (-1, 0.5]")?;
        Ok(Material { rheology: Arc::new(rheology), factor: 0.5 * (1.0 - nu) })
    }

    /// The contact creep compliance C(t) \[1/Pa\] at t ≥ 0 \[s\].
    pub fn contact_compliance(&self, t: f64) -> f64 {
        self.factor * self.rheology.creep_compliance(t)
    }

    /// The shear creep compliance J(t) of its rheology \[1/Pa\] at t ≥ 0 \[s\].
    pub fn creep_compliance(&self, t: f64) -> f64 {
        self.rheology.creep_compliance(t)
    }

    /// C(t)/J(t).
    pub(crate) fn contact_factor(&self) -> f64 {
        self.factor
    }

    /// The exact exponential series of C(t), if the rheology has one.
    ///
    /// # Errors
    /// If the scaled series leaves the range of `f64`.
    pub fn contact_spectrum(&self) -> Result<Option<CreepSpectrum>> {
        self.rheology.creep_spectrum().map(|spectrum| spectrum.scaled(self.factor)).transpose()
    }

    /// The error for a time rule that needs a series the rheology does not have.
    pub(crate) fn no_series(&self) -> Error {
        Error::NoExponentialSeries { rheology: format!("{:?}", self.rheology) }
    }
}
