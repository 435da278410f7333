//! How a prescribed approach comes back after it has receded.

use crate::error::Result;
use crate::load::{Load, LoadHistory};

/// The ends of the rises of a prescribed approach after it has receded, and their depths below first touch: a body then meets a
/// surface that recovers from it.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Returns(Vec<(f64, f64)>);

impl Returns {
    /// Of a history, as far as its loads at these ascending times show; first touch is at the approach `touch`.
    pub(super) fn new(history: &dyn LoadHistory, touch: f64, times: &[f64]) -> Result<Returns> {
        let (mut returns, mut receded, mut last) = (Returns::default(), false, None);
        for &time in times {
            for load in [LoadHistory::before, LoadHistory::at] {
                let Load::Approach { approach, .. } = load(history, time).validated_at(time)? else { continue };
                if let Some(before) = last.replace(approach) {
                    receded |= approach < before;
                    if receded && approach > before.max(touch) {
                        returns.0.push((time, approach - touch));
                    }
                }
            }
        }
        Ok(returns)
    }

    /// Whether a run can be continued with it: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        self.0.iter().all(|&(_, depth)| depth >= 0.0)
    }

    /// The greatest depth of all rises that end at `now` or later; 0 if there are none.
    pub(super) fn depth_after(&self, now: f64) -> f64 {
        self.0.iter().filter(|(end, _)| *end >= now).fold(0.0, |deepest, &(_, depth)| deepest.max(depth))
    }
}
