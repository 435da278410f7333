//! Indenters that are replaced between two steps.

use std::sync::Arc;

use crate::contact::{Indenter, ViscoelasticContact};
use crate::error::{Result, exact_length};
use crate::geometry::{Gap, Geometry, evaluate};

impl ViscoelasticContact {
    /// Replaces the indenter, moved or changed, between two steps; the bodies keep their deformation,
    /// and touch the new one from the next step on.
    ///
    /// # Errors
    /// If a gap is NaN or −∞, or none is finite, or there are several rigid bodies, or the new gap breaks a symmetry and there is
    /// no memory for the mirror images. The contact then keeps the old indenter.
    pub fn set_geometry(&mut self, geometry: &dyn Geometry) -> Result<()> {
        self.set_geometries(&[geometry])
    }

    /// [`ViscoelasticContact::set_geometry`] with a geometry for each rigid body.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::set_geometry`], or if there is not one geometry per body.
    pub fn set_geometries(&mut self, geometries: &[&dyn Geometry]) -> Result<()> {
        self.not_shared("another geometry")?;
        exact_length("geometries of the rigid bodies", geometries.len(), self.scene.bodies)?;
        let gaps =
            geometries.iter().map(|geometry| evaluate(*geometry, &self.scene.grid)).collect::<Result<Vec<_>>>()?;
        let indenter = Indenter::new(Gap::new(gaps, &self.scene.grid)?, self.scene.bodies);
        let region = &self.computation.state.region;
        let still_folded = indenter.keeps_folded(region.folded(), &self.scene.grid);
        if still_folded != region.folded() {
            // the next step unfolds the fields
            self.computation.check_memory_for(&self.scene, &region.unfolded(still_folded))?;
        }
        let state = &mut self.computation.state;
        let before = std::mem::replace(&mut state.indenter, Arc::new(indenter));
        state.start.replaced.get_or_insert(before);
        state.indenter_is_new = true;
        state.extrapolation.interrupt();
        state.history.reset_differences();
        Ok(())
    }
}
