//! The stress below the surface.

use crate::error::{Refusal, Result, coverage, missing};
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
    /// If the contact has no material, or Poisson's ratio changes as the body creeps.
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
        let material = self.about.material.ok_or_else(|| missing("material"))?;
        let Some(nu) = material.poisson_ratios().nth(body).ok_or_else(|| missing("counter_body"))? else {
            let what = format!(
                "Poisson's ratio of body {body} changes as it creeps (elastic bulk): the stress below its surface \
                 depends on pressures of the past, which the contact does not keep"
            );
            let remedy = "; give the body a constant Poisson's ratio";
            return Err(Refusal::unsupported("material_changing_poisson", what, remedy).into());
        };
        SubsurfaceStress::new(self.kernel(), self.pressure(), nu)
    }
}
