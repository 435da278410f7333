//! Indenters that move along the surface or are replaced, and the lateral force that moves them.

pub(in crate::contact) mod along_path;
pub(crate) mod shortfall;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contact::{Indenter, Step, StepReport, ViscoelasticContact};
use crate::error::{Result, coverage, exact_length};
use crate::geometry::{Gap, Geometry, Missed, evaluate};
use crate::load::Load;

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
        self.covers(coverage::OTHER_GEOMETRY)?;
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
        let waves: Vec<_> = geometries.iter().flat_map(|geometry| geometry.waves()).collect();
        self.missed = Missed::of(&waves, &self.scene.grid, self.scene.kernel.periodic_axes());
        let state = &mut self.computation.state;
        let before = std::mem::replace(&mut state.indenter, Arc::new(indenter));
        state.start.replaced.get_or_insert(before);
        state.indenter_is_new = true;
        state.extrapolation.interrupt();
        state.history.reset_differences();
        Ok(())
    }

    /// Takes a step in which the indenter and the grid move over the bodies by whole cells along x1 and x2: the
    /// material under the cell `[i, j] + cells` moves under `[i, j]`. All rigid bodies move alike. At a velocity v along x1, one cell per step takes
    /// dt = Δ1/v.
    ///
    /// Undisturbed material enters across one edge of the grid; on periodic bodies, material that leaves at one edge
    /// enters at the other. Otherwise the history of material that leaves is dropped: the grid should be long enough
    /// behind the contact for the bodies to recover, or for the remaining displacement to be far away. Needs
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
    /// let [resistance, across] = contact.lateral_force(&shape);
    /// assert!(resistance > 0.005 && across.abs() < 1.0e-9);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`], or if the grid is fixed to the bodies.
    pub fn step_over(&mut self, cells: [isize; 2], dt: f64, loads: impl AsRef<[Load]>) -> Result<StepReport> {
        self.step_over_unless(None, cells, dt, loads.as_ref())
    }

    /// [`ViscoelasticContact::step_over`], unless another thread sets a flag.
    pub(crate) fn step_over_unless(
        &mut self,
        cancelled: Option<&AtomicBool>,
        cells: [isize; 2],
        dt: f64,
        loads: &[Load],
    ) -> Result<StepReport> {
        self.covers(coverage::STEP_OVER_BODIES)?;
        let mut step = Step { cancelled, ..self.request_next(dt, loads)? };
        step.interval.stride = cells;
        self.take(step)
    }

    /// The force \[N\] along x1 and x2 that moves `shape` along the surface without friction: ∬ p ∇h, less the tilt
    /// times the normal force. `shape` is the shape of the (first) indenter at its present position, or its moving
    /// part. Of several rigid bodies only the pressure under the first one counts.
    ///
    /// It vanishes on elastic bodies, and in any symmetric contact. Multiplied by the velocity of the indenter, it is
    /// the power that the bodies dissipate or store: on a slope, p does the work p (∂u/∂t − dω/dt). Divided by the
    /// normal force, it is the coefficient of hysteretic friction.
    ///
    /// The pressure is constant on a cell. The slope of a cell is therefore the rise of
    /// [`Geometry::initial_gap`] from side to side. On interpolated maps it is
    /// as accurate as the interpolation: for a rough slider on an elastic body the error is 3e-4 of the normal force
    /// with waves of 2 cells, 2e-5 with waves of 8 cells. Where the rise is not finite, beside the rim of a face, the
    /// slope counts as zero: only [`TravelReport::power`](crate::contact::TravelReport) includes the force of a rim.
    /// NaN where the gap of the shape is NaN.
    ///
    /// A call of all [ranks](crate::parallel) that share out the contact.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let sphere = Sphere::new(10.0e-3)?;
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 2.0e-3)?)
    ///     .geometry(&sphere)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.1))?;
    /// assert!(contact.lateral_force(&sphere).iter().all(|force| force.abs() < 1.0e-12));
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn lateral_force(&self, shape: &dyn Geometry) -> [f64; 2] {
        let (n2, [half1, half2]) = (self.grid().cells()[1], self.grid().spacing().map(|side| 0.5 * side));
        let rise = |ahead: f64, behind: f64| {
            let rise = ahead - behind;
            if rise.is_finite() || ahead.is_nan() || behind.is_nan() { rise } else { 0.0 }
        };
        let gap = self.computation.state.indenter.gap();
        let of_row = |i: usize, row: &[f64]| {
            let (mut own, x1) = ([0.0; 2], self.grid().coordinate(0, i));
            for (j, &p) in row.iter().enumerate().filter(|(j, p)| **p > 0.0 && gap.owner(i * n2 + j) == 0) {
                let x2 = self.grid().coordinate(1, j);
                own[0] += p * (rise(shape.initial_gap(x1 + half1, x2), shape.initial_gap(x1 - half1, x2)));
                own[1] += p * (rise(shape.initial_gap(x1, x2 + half2), shape.initial_gap(x1, x2 - half2)));
            }
            own
        };
        let (sums, tilt) = (self.sum_of_rows(of_row), self.tilt());
        let force = self.body(0).map_or(0.0, |body| body.force);
        [0, 1].map(|axis| sums[axis] * self.grid().spacing()[1 - axis] - tilt[axis] * force)
    }
}
