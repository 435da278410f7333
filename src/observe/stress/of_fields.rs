//! The stress below the surface.

use crate::error::{Error, MaterialError, Result, coverage};
use crate::fields::Fields;
use crate::observe::SubsurfaceStress;

impl Fields<'_> {
    /// The stress below the surface of the body of [`Builder::material`](crate::contact::Builder::material) under the
    /// present pressure.
    ///
    /// An [`ElasticContact`](crate::elastic::ElasticContact) has no material: [`SubsurfaceStress::new`] takes its
    /// kernel, its pressure and Poisson's ratio.
    ///
    /// # Errors
    /// If the contact has no material ([`Error::Missing`]), or Poisson's ratio changes as the body creeps
    /// ([`MaterialError::ChangingPoisson`]): follow the run with a [`StressHistory`](crate::contact::StressHistory).
    /// As [`SubsurfaceStress::new`].
    pub fn stress(&self) -> Result<SubsurfaceStress> {
        self.stress_of(0)
    }

    /// The stress below the surface of the body of [`Builder::counter_body`](crate::contact::Builder::counter_body); x3
    /// is the depth below its surface.
    ///
    /// # Errors
    /// If there is no such body, and as [`Fields::stress`].
    pub fn stress_in_counter_body(&self) -> Result<SubsurfaceStress> {
        self.stress_of(1)
    }

    fn stress_of(&self, body: usize) -> Result<SubsurfaceStress> {
        self.covers(coverage::STRESS)?;
        let material = self.about.material.ok_or(Error::Missing { part: "material" })?;
        let law = material.compressibility(body).ok_or(Error::Missing { part: "counter_body" })?;
        if !law.terms.is_empty() {
            return Err(MaterialError::ChangingPoisson { body }.into());
        }
        SubsurfaceStress::new(self.kernel(), self.pressure(), 0.5 * (1.0 - law.last))
    }
}
