//! What acts along the surface over time.

use std::sync::Arc;

use crate::error::{Error, Refusal, Result};
use crate::friction::load::{Component, ShearLoad};
use crate::load::{Load, LoadHistory, Tilt};

const UPRIGHT: [Tilt; 2] = [Tilt::Fixed(0.0); 2];

/// What acts along the surface over time: a history for the shift along x1, for that along x2, and for the twist.
/// A [`Load::force`] is a force \[N\] or a torque \[N m\] of either sign, a [`Load::approach`] a displacement \[m\] or
/// an angle \[rad\].
#[derive(Debug)]
pub struct ShearHistory {
    /// Two, or with a twist three.
    pub(super) components: Vec<Arc<dyn LoadHistory>>,
}

clone_by_fields! { ShearHistory { components } }

impl ShearHistory {
    /// Along x1 and x2, of a body that does not turn.
    pub fn new(first: impl LoadHistory + 'static, second: impl LoadHistory + 'static) -> ShearHistory {
        ShearHistory { components: vec![Arc::new(first), Arc::new(second)] }
    }

    /// The same, with a torque or an angle about the normal through the origin.
    pub fn with_twist(mut self, twist: impl LoadHistory + 'static) -> ShearHistory {
        self.components.truncate(2);
        self.components.push(Arc::new(twist));
        self
    }

    /// What acts, without forces and a torque that are less than the `least`.
    pub(super) fn load(&self, least: [f64; 3], of: impl Fn(&dyn LoadHistory) -> Result<Load>) -> Result<ShearLoad> {
        let mut load = ShearLoad::force([0.0; 2]);
        for ((component, history), least) in load.components.iter_mut().zip(&self.components).zip(least) {
            *component = match of(&**history).map_err(Error::along)?.without_force_below(least) {
                Load::Force { normal: force, tilt: UPRIGHT } => Component::Force(force),
                Load::Approach { approach: motion, tilt: UPRIGHT } => Component::Motion(motion),
                other => {
                    let what = format!(
                        "a load along the surface is a force (Load::force) or a displacement (Load::approach) without \
                         tilt, not {other}"
                    );
                    return Err(Refusal::value("friction_other_load", what, "").into());
                }
            };
        }
        Ok(load)
    }
}
