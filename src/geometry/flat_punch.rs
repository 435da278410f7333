use crate::error::{Result, positive};
use crate::geometry::Geometry;

/// A rigid punch with a flat face centred on the origin: the gap is 0 on the face and +∞ off it.
///
/// A cell belongs to the face if its centre does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatPunch {
    face: Face,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Face {
    Circle { radius: f64 },
    Rectangle { half_sides: [f64; 2] },
}

impl FlatPunch {
    /// A circular face of `radius` \[m\].
    ///
    /// # Errors
    /// If the radius is not finite and positive.
    pub fn circular(radius: f64) -> Result<FlatPunch> {
        Ok(FlatPunch { face: Face::Circle { radius: positive("punch radius", radius)? } })
    }

    /// A rectangular face with full `sides` along x1 and x2 \[m\].
    ///
    /// # Errors
    /// If a side is not finite and positive.
    pub fn rectangular(sides: [f64; 2]) -> Result<FlatPunch> {
        let half_sides =
            [0.5 * positive("punch side along x1", sides[0])?, 0.5 * positive("punch side along x2", sides[1])?];
        Ok(FlatPunch { face: Face::Rectangle { half_sides } })
    }
}

impl Geometry for FlatPunch {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        let inside = match self.face {
            Face::Circle { radius } => x1.hypot(x2) <= radius,
            Face::Rectangle { half_sides } => x1.abs() <= half_sides[0] && x2.abs() <= half_sides[1],
        };
        if inside { 0.0 } else { f64::INFINITY }
    }
}
