//! The two bodies of a contact, one by one.

use crate::error::Result;
use crate::rheology::Material;

impl Material {
    /// Whether it is two bodies of one material.
    pub(crate) fn is_pair(&self) -> Result<bool> {
        let [one, other] = self.apart();
        let is_alike = one.poisson_ratios().eq(other.poisson_ratios());
        Ok(is_alike && one.contact_spectrum()? == other.contact_spectrum()?)
    }

    /// The same without the other body, and the other one alone.
    pub(crate) fn apart(&self) -> [Material; 2] {
        let (own, others) = self.bodies.split_at(1.min(self.bodies.len()));
        [own, others].map(|bodies| Material { bodies: bodies.to_vec() })
    }
}
