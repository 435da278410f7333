use crate::error::{Result, length};
use crate::geometry::Geometry;

/// A cylinder on the plane with its axis along x2, approximated by a parabola: h = x1² / 2R.
///
/// It has no ends: the contact reaches the edges of the grid along x2, so that it needs
/// [`Edge::Allow`](crate::contact::Edge::Allow) and models a cylinder as long as the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    radius: f64,
}

impl Cylinder {
    /// A cylinder of `radius` \[m\].
    ///
    /// # Errors
    /// If the radius is not positive, or more than 1e300 m.
    pub fn new(radius: f64) -> Result<Cylinder> {
        Ok(Cylinder { radius: length("cylinder radius", radius)? })
    }
}

impl Geometry for Cylinder {
    fn initial_gap(&self, x1: f64, _x2: f64) -> f64 {
        x1 * x1 / (2.0 * self.radius)
    }
}
