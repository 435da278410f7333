use crate::error::{Result, length};
use crate::geometry::Geometry;

/// An ellipsoid touching the plane at the origin, approximated by the paraboloid of its principal radii of curvature
/// along the axes: h = x1²/2R1 + x2²/2R2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    radii: [f64; 2],
}

impl Ellipsoid {
    /// Radii of curvature `r1` in the plane of x1 and `r2` in the plane of x2 \[m\].
    ///
    /// # Errors
    /// If a radius is not positive, or more than 1e300 m.
    pub fn new(r1: f64, r2: f64) -> Result<Ellipsoid> {
        let radii = [length("radius of curvature along x1", r1)?, length("radius of curvature along x2", r2)?];
        Ok(Ellipsoid { radii })
    }
}

impl Geometry for Ellipsoid {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        x1 * x1 / (2.0 * self.radii[0]) + x2 * x2 / (2.0 * self.radii[1])
    }
}
