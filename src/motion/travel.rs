use std::sync::Arc;

use crate::Grid;
use crate::error::{Error, Result, finite};
use crate::geometry::{Geometry, Shifted, Waves, added, evaluate};
use crate::motion::Path;

/// A shape that moves along a path, optionally over a fixed track.
///
/// ```
/// use viscocontact::motion::{Straight, Travel};
/// use viscocontact::prelude::*;
///
/// let (grid, load) = (Grid::new([96, 48], [8.0e-3, 4.0e-3])?, Load::force(0.5));
/// let travel = Travel::new(Sphere::new(10.0e-3)?, Straight::new([-2.0e-3, 0.0], [0.1, 0.0])?);
/// let mut contact = ViscoelasticContact::builder(grid)
///     .geometry(&travel.shape_at(0.0)?)
///     .material(Material::incompressible(Zener::new(1.0e6, 0.3e6, 0.01e6)?))
///     .build()?;
/// contact.step(0.0, load)?;
/// for _ in 0..20 {
///     let report = contact.step_along(&travel, 2.0e-3, load)?;
///     println!("{:.2e} m: {:.2e} N, {:.2e} W", report.position[0], report.lateral_force[0], report.power);
/// }
/// assert!(contact.fields().moment()[0] / contact.force() > 2.0e-3); // the pressure is shifted forward
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Travel {
    shape: Arc<dyn Geometry>,
    path: Arc<dyn Path>,
    track: Option<Arc<dyn Geometry>>,
}

impl Travel {
    /// `shape` along `path`.
    pub fn new(shape: impl Geometry + 'static, path: impl Path + 'static) -> Travel {
        Travel { shape: Arc::new(shape), path: Arc::new(path), track: None }
    }

    /// Adds the gap of a fixed track to the gap of the moving shape: the roughness of the creeping body, or of a
    /// rolling indenter.
    #[must_use]
    pub fn over(mut self, track: impl Geometry + 'static) -> Travel {
        self.track = Some(Arc::new(track));
        self
    }

    /// Position of the shape at time `t` \[s\], in m.
    ///
    /// # Errors
    /// If the path returns a value that is not finite.
    pub fn position(&self, t: f64) -> Result<[f64; 2]> {
        let [x1, x2] = self.path.at(t);
        let position = || Ok([finite("position along x1", x1)?, finite("position along x2", x2)?]);
        position().map_err(|error| self.path.failure().map_or(error, Error::User))
    }

    /// The moving shape at its position at time `t` \[s\], without the track.
    ///
    /// # Errors
    /// As [`Travel::position`].
    pub fn shape_at(&self, t: f64) -> Result<Shifted> {
        Shifted::of(Arc::clone(&self.shape), self.position(t)?)
    }

    /// The waves of the track.
    pub(crate) fn waves_of_track(&self) -> Vec<Waves> {
        self.track.as_ref().map_or(Vec::new(), |track| track.waves())
    }

    /// The gap \[m\] on every cell, of the shape where it is and the track.
    pub(crate) fn gap(&self, shape: &Shifted, grid: &Grid) -> Result<Vec<f64>> {
        let mut gap = evaluate(shape, grid)?;
        if let Some(track) = &self.track {
            gap.iter_mut().zip(evaluate(track, grid)?).for_each(|(gap, own)| *gap = added(*gap, own));
        }
        Ok(gap)
    }
}
