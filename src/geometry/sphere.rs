use crate::error::{Result, length};
use crate::geometry::Geometry;

/// A sphere touching the plane at the origin, approximated by a paraboloid: h = (x1² + x2²) / 2R.
///
/// For two spheres use the combined radius, 1/R = 1/R_upper + 1/R_lower.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    radius: f64,
}

impl Sphere {
    /// A sphere of `radius` \[m\].
    ///
    /// # Errors
    /// If the radius is not positive, or more than 1e300 m.
    pub fn new(radius: f64) -> Result<Sphere> {
        Ok(Sphere { radius: length("sphere radius", radius)? })
    }
}

impl Geometry for Sphere {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        (x1 * x1 + x2 * x2) / (2.0 * self.radius)
    }
}
