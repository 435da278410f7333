//! Loads and work along the surface.

use super::Load;

/// Where the work along the surface went, since the contact was made \[J\]: work = slip + stored + creep.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct LateralWork {
    /// ∫ Q dd + ∫ M dφ, done on the bodies by the forces along the surface and the torque; its errors in time are of
    /// second order.
    pub work: f64,
    /// Dissipated by slip in the contact.
    pub slip: f64,
    /// Stored in the bodies, to come back.
    pub stored: f64,
    /// Dissipated by creep in the bodies, by displacements that are linear in each step.
    pub creep: f64,
}

impl LateralWork {
    /// By what the bodies hold of the work now.
    pub(crate) fn new(work: f64, slip: f64, stored: f64) -> LateralWork {
        LateralWork { work, slip, stored, creep: work - slip - stored }
    }
}

impl Load {
    /// The load along the surface, without a force that is less than this.
    pub(crate) fn without_force_below(mut self, least: f64) -> Load {
        if let Load::Force { normal: force, .. } = &mut self
            && force.abs() < least
        {
            *force = 0.0;
        }
        self
    }
}
