use crate::error::{Result, positive};
use crate::geometry::Geometry;

/// A cone touching the plane with its apex at the origin: h = r tan β.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    tan_beta: f64,
}

impl Cone {
    /// A cone whose flank rises by `tan_beta` per unit of radius. β is the angle between flank and plane, small in the
    /// half-space theory.
    ///
    /// # Errors
    /// If the slope is not finite and positive.
    pub fn new(tan_beta: f64) -> Result<Cone> {
        Ok(Cone { tan_beta: positive("cone slope tan β", tan_beta)? })
    }
}

impl Geometry for Cone {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        x1.hypot(x2) * self.tan_beta
    }
}
