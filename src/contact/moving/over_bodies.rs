//! Steps in which the indenter moves over the bodies, and the grid with it.

use crate::contact::{Frame, StepReport, ViscoelasticContact};
use crate::error::{Error, Result};
use crate::load::Loads;

impl ViscoelasticContact {
    /// Takes a step in which the indenter and the grid move over the bodies by whole cells along x1 and x2: the
    /// material under the cell `[i, j] + cells` moves under `[i, j]`. All rigid bodies move alike. At a velocity v along x1, one cell per step takes
    /// dt = Δ1/v.
    ///
    /// Undisturbed material enters across one edge of the grid; on periodic bodies, material that leaves at one edge
    /// enters at the other. Otherwise the history of material that leaves is dropped: the grid should be long enough
    /// behind the contact for the bodies to recover, or for the remaining displacement to be far away. Needs
    /// [`Frame::Indenter`].
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
    pub fn step_over<'a>(&mut self, cells: [isize; 2], dt: f64, loads: impl Into<Loads<'a>>) -> Result<StepReport> {
        if self.settings().frame != Frame::Indenter {
            return Err(Error::WrongFrame { what: "a step over the bodies" });
        }
        let loads = loads.into();
        let mut step = self.request_next(dt, loads.as_slice())?;
        step.interval.stride = cells;
        self.take(step)
    }
}
