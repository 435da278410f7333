//! What a load does, as far as it is known before a step.

use super::{Load, UPRIGHT};

impl Load {
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
