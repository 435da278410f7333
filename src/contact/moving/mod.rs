//! Indenters that move along the surface or are replaced, and the lateral force that moves them.

pub(in crate::contact) mod along_path;
mod wake;

use std::sync::Arc;

use crate::contact::{StepReport, ViscoelasticContact};
use crate::equilibrium::{Indenter, Warnings};
use crate::error::{Result, coverage, exact_length};
use crate::geometry::{Gap, Geometry, Missed, Waves, evaluate};
use crate::load::Load;
use wake::Wake;

impl ViscoelasticContact {
    /// Replaces the indenter, moved or changed, between two steps, by a geometry for each rigid body; the bodies keep
    /// their deformation, and touch the new one from the next step on.
    ///
    /// # Errors
    /// If a gap is NaN or −∞, or none is finite, or there is not one geometry per body, or the new gap breaks a
    /// symmetry and there is no memory for the mirror images. The contact then keeps the old indenter.
    pub fn set_geometries(&mut self, geometries: &[&dyn Geometry]) -> Result<()> {
        self.covers(coverage::OTHER_GEOMETRY)?;
        exact_length("geometries of the rigid bodies", geometries.len(), self.scene.ground.bodies)?;
        let gaps = geometries
            .iter()
            .map(|geometry| evaluate(*geometry, &self.scene.ground.grid))
            .collect::<Result<Vec<_>>>()?;
        let waves: Vec<_> = geometries.iter().flat_map(|geometry| geometry.waves()).collect();
        let indenter = self.indenter(gaps, &waves)?;
        let region = &self.computation.state.held.region;
        let still_folded = indenter.keeps_folded(region.folded(), &self.scene.ground.grid);
        if still_folded != region.folded() {
            // the next step unfolds the fields
            self.computation.check_memory_for(&self.scene, &region.unfolded(still_folded))?;
        }
        self.saved_run = None; // a run that a file held does not know of it
        let state = &mut self.computation.state;
        let before = std::mem::replace(&mut state.held.indenter, Arc::new(indenter));
        state.start.replaced.get_or_insert(before);
        state.indenter_is_new = true;
        state.held.extrapolation.interrupt();
        state.history.reset_differences();
        Ok(())
    }

    /// An indenter of these gaps, of shapes with such waves.
    pub(in crate::contact) fn indenter(&self, gaps: Vec<Vec<f64>>, waves: &[Waves]) -> Result<Indenter> {
        let (ground, bodies) = (&self.scene.ground, gaps.len());
        let missed = Missed::of(waves, &ground.grid, ground.kernel.periodic_axes());
        Ok(Indenter::new(Gap::new(gaps, &ground.grid)?, bodies).missing(missed))
    }

    /// Takes a step in which the indenter and the grid move over the bodies by whole cells along x1 and x2: the
    /// material under the cell `[i, j] + cells` moves under `[i, j]`. All rigid bodies move alike. At a velocity v
    /// along x1, one cell per step takes dt = Δ1/v.
    ///
    /// Undisturbed material enters across one edge of the grid; on periodic bodies, material that leaves at one edge
    /// enters at the other. Otherwise the history of material that leaves is dropped: the grid should be long enough
    /// behind the contact for the bodies to recover, some v τ, or for the remaining displacement to be far away.
    /// [`Warnings::WAKE`] tells where what has left could change approach or lateral force by more than 1 %. Needs
    /// [`Frame::Indenter`](crate::contact::Frame::Indenter).
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// // a sphere slides at 50 mm/s; the contact leans forward, so that the motion takes a force
    /// let (grid, shape) = (Grid::new([96, 48], [8.0e-3, 4.0e-3])?, Shifted::new(Sphere::new(10.0e-3)?, [2.0e-3, 0.0])?);
    /// let mut contact = ViscoelasticContact::builder(grid.clone())
    ///     .geometry(&shape)
    ///     .material(Material::incompressible(Zener::new(1.0e6, 0.3e6, 0.01e6)?))
    ///     .settings(Settings::default().with_frame(Frame::Indenter))
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// for _ in 0..60 {
    ///     contact.step_over([1, 0], grid.spacing()[0] / 0.05, Load::force(0.5))?;
    /// }
    /// let [resistance, across] = contact.fields().slope_force(&shape);
    /// assert!(resistance > 0.005 && across.abs() < 1.0e-9);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`], or if the grid is fixed to the bodies.
    pub fn step_over(&mut self, cells: [isize; 2], dt: f64, loads: impl AsRef<[Load]>) -> Result<StepReport> {
        self.covers(coverage::STEP_OVER_BODIES)?;
        let mut step = self.plan_next_step(self.time() + dt, dt, loads.as_ref())?;
        step.interval.stride = cells;
        let mut report = self.take(step)?;
        self.saved_run = None;
        if let Some(reach) = self.fields().extent_of_contact() {
            let (scene, computation) = (&*self.scene, &self.computation);
            report.figures.wake = Wake { scene, computation, reach, stride: cells }.missing();
            report.warnings.set(Warnings::WAKE, report.figures.wake.is_some());
        }
        Ok(report)
    }
}
