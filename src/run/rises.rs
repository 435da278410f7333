//! Rises of a history, in which bodies meet the surface again.

use crate::contact::Scene;
use crate::error::Result;
use crate::load::{Load, LoadHistory};

/// A rise of a prescribed approach, or of a driven spring, in which a body meets the surface.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Rise {
    pub(super) end: f64,
    /// Depth below first touch at its end.
    pub(super) depth: f64,
    /// Depth per second of reduced time; infinite for a jump.
    rate: f64,
    /// Whether the approach has receded before: the surface is still recovering.
    pub(super) again: bool,
    /// The response of v to an error of u when they meet, if the approach is given.
    pub(super) stiffness: f64,
    /// Compliance of the spring \[m/N\]; 0 for a given approach.
    pub(super) spring: f64,
}

/// Fixed-point iterations for the error of u that changes v by the most allowed: compliances grow less than linearly.
const ITERATIONS: u32 = 16;

impl Rise {
    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        self.depth >= 0.0 && self.rate > 0.0 && self.stiffness >= 0.0 && self.spring >= 0.0
    }

    /// A surface that is off by δ is met too early or too late by δ/rate, in which time bodies respond by
    /// 1/C(δ/rate). Finds this response for the δ that changes v by `most`.
    pub(super) fn find_stiffness(&mut self, scene: &Scene, most: f64) {
        let compliance = |off: f64| scene.material.contact_compliance(off / self.rate);
        let off = (0..ITERATIONS).fold(self.depth, |off, _| most * compliance(off));
        self.stiffness = 1.0 / compliance(off);
    }
}

/// The rises of a history at these ascending times; first touch is at the approach `touch`.
pub(super) fn rises(scene: &Scene, history: &dyn LoadHistory, touch: f64, times: &[f64]) -> Result<Vec<Rise>> {
    let (mut rises, mut again, mut last) = (Vec::new(), false, None);
    for &time in times {
        for load in [<dyn LoadHistory>::checked_before, <dyn LoadHistory>::checked_at] {
            let (approach, spring) = match load(history, time, scene.ground.attraction.is_some())? {
                Load::Approach { approach: depth, .. } => (depth, 0.0),
                Load::Spring { stiffness, drive: depth, .. } => (depth, 1.0 / stiffness),
                Load::Force { .. } => {
                    // a force may have receded, too
                    (again, last) = (true, None);
                    continue;
                }
            };
            if let Some((start, before)) = last.replace((time, approach)) {
                again |= approach < before;
                if approach > before.max(touch) {
                    let rate = (approach - before) / scene.reduced_length(start, time, time - start)?;
                    rises.push(Rise { end: time, depth: approach - touch, rate, again, stiffness: 0.0, spring });
                }
            }
        }
    }
    Ok(rises)
}
