//! What a load does, as far as it is known before a step.

use super::{Load, UPRIGHT};

impl Load {
    /// The load with its force, if it is one, divided by a factor.
    pub(crate) fn with_force_over(self, factor: f64) -> Load {
        match self {
            Load::Force { normal, tilt } => Load::Force { normal: normal / factor, tilt },
            Load::Approach { .. } | Load::Spring { .. } => self,
        }
    }

    /// Whether it surely presses undisturbed bodies that touch, upright, at the approach `touch`.
    pub(crate) fn presses(&self, touch: f64) -> bool {
        match *self {
            Load::Force { normal, .. } => normal > 0.0,
            Load::Approach { approach: place, tilt } | Load::Spring { drive: place, tilt, .. } => {
                tilt == UPRIGHT && place > touch
            }
        }
    }
}
