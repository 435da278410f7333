//! What acts along the surface.

use crate::error::{Result, within};

/// Forces and motions below this are numbers in all sums.
pub(super) const LARGEST: f64 = 1e100;

/// One component of what acts along the surface: the shift along x1 or x2, or the twist about the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Component {
    /// A force \[N\], or a torque \[N m\].
    Force(f64),
    /// A displacement of the body \[m\], or an angle \[rad\], since the contact was made.
    Motion(f64),
}

/// What acts on the body along the surface at the end of a step: a force or a displacement along each axis, a torque
/// or an angle about the normal through the origin, in any mixture. Positive along the axes, angles from x1 to x2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShearLoad {
    /// Along x1, along x2, and the twist.
    pub components: [Component; 3],
}

impl ShearLoad {
    /// A force \[N\], on a body that does not turn.
    pub fn force(force: [f64; 2]) -> ShearLoad {
        ShearLoad { components: [Component::Force(force[0]), Component::Force(force[1]), Component::Motion(0.0)] }
    }

    /// The forces that are prescribed, and how far the other components move a body that is here.
    pub(super) fn prescribed(&self, here: [f64; 3]) -> ([Option<f64>; 3], [f64; 3]) {
        let (mut forces, mut moved) = ([None; 3], [0.0; 3]);
        for (k, component) in self.components.iter().enumerate() {
            match *component {
                Component::Force(force) => forces[k] = Some(force),
                Component::Motion(to) => moved[k] = to - here[k],
            }
        }
        (forces, moved)
    }

    /// A displacement \[m\], of a body that does not turn.
    pub fn motion(shift: [f64; 2]) -> ShearLoad {
        ShearLoad { components: [shift[0], shift[1], 0.0].map(Component::Motion) }
    }

    /// The same, with a torque \[N m\] on a body that is free to turn.
    pub fn with_torque(mut self, torque: f64) -> ShearLoad {
        self.components[2] = Component::Force(torque);
        self
    }

    /// The same, with this angle \[rad\].
    pub fn with_angle(mut self, angle: f64) -> ShearLoad {
        self.components[2] = Component::Motion(angle);
        self
    }

    pub(super) fn validate(&self) -> Result<()> {
        for (component, [force, motion]) in self.components.iter().zip([
            ["force along x1", "displacement along x1"],
            ["force along x2", "displacement along x2"],
            ["torque", "angle"],
        ]) {
            let (field, value) = match *component {
                Component::Force(value) => (force, value),
                Component::Motion(value) => (motion, value),
            };
            within(field, value, value.abs() <= LARGEST, "finite, at most 1e100 in absolute value")?;
        }
        Ok(())
    }
}

/// A motion as a length, or a force: angles times the arm, torques over it; nothing of bodies without contact.
pub(super) fn size(of: [f64; 3], arm: f64) -> f64 {
    of[0].hypot(of[1]).hypot(if arm.is_finite() { arm * of[2] } else { 0.0 })
}
