use std::sync::Arc;

use crate::Grid;
use crate::error::{Result, UserError, finite};
use crate::geometry::{Geometry, Waves};

/// Another geometry shifted in the plane of contact.
///
/// ```
/// use viscocontact::geometry::{Geometry, Shifted, Sphere};
///
/// let sphere = Shifted::new(Sphere::new(1.0)?, [0.2, 0.0])?;
/// assert_eq!(sphere.initial_gap(0.2, 0.0), 0.0);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Shifted {
    shape: Arc<dyn Geometry>,
    by: [f64; 2],
}

impl Shifted {
    /// `shape` with its origin shifted to the point `by` \[m\].
    ///
    /// # Errors
    /// If a component of the shift is not finite.
    pub fn new(shape: impl Geometry + 'static, by: [f64; 2]) -> Result<Shifted> {
        Shifted::of(Arc::new(shape), by)
    }

    /// Like [`Shifted::new`], for a shared shape.
    pub(crate) fn of(shape: Arc<dyn Geometry>, by: [f64; 2]) -> Result<Shifted> {
        let by = [finite("shift along x1", by[0])?, finite("shift along x2", by[1])?];
        Ok(Shifted { shape, by })
    }
}

impl Geometry for Shifted {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        self.shape.initial_gap(x1 - self.by[0], x2 - self.by[1])
    }

    fn fill_gap_at(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
        self.shape.fill_gap_at(grid, [self.by[0] + by[0], self.by[1] + by[1]], gap);
    }

    fn failure(&self) -> Option<UserError> {
        self.shape.failure()
    }

    fn waves(&self) -> Vec<Waves> {
        self.shape.waves()
    }
}
