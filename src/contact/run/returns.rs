//! How a prescribed approach comes back after it has receded.

use crate::contact::scene::Scene;
use crate::error::Result;
use crate::load::{Load, LoadHistory};

/// The rises of a prescribed approach after it has receded: a body then meets a surface that recovers from it.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Returns(Vec<Return>);

#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Return {
    /// Time at its end.
    end: f64,
    /// Depth below first touch at its end.
    depth: f64,
    /// Rate in reduced time; infinite in a jump.
    rate: f64,
}

impl Returns {
    /// Of a history, as far as its loads at these ascending times tell; first touch is at the approach `touch`.
    pub(super) fn new(scene: &Scene, history: &dyn LoadHistory, touch: f64, times: &[f64]) -> Result<Returns> {
        let (mut returns, mut receded, mut last) = (Returns::default(), false, None);
        for &end in times {
            for load in [LoadHistory::before, LoadHistory::at] {
                let Load::Approach { approach, .. } = load(history, end).validated_at(end)? else { continue };
                if let Some((start, before)) = last.replace((end, approach)) {
                    receded |= approach < before;
                    if receded && approach > before.max(touch) {
                        let rate = (approach - before) / scene.reduced_length([start, end], end - start)?;
                        returns.0.push(Return { end, depth: approach - touch, rate });
                    }
                }
            }
        }
        Ok(returns)
    }

    /// Whether a run can be continued with it: a file may hold anything.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        self.0.iter().all(|each| each.depth >= 0.0 && each.rate >= 0.0)
    }

    /// The greatest depth of those that end after `now`, and the (reduced) time in which the fastest of them would get there from
    /// first touch; none if there are none.
    pub(super) fn after(&self, now: f64) -> Option<[f64; 2]> {
        let to_come = self.0.iter().filter(|each| each.end >= now);
        let [depth, rate] =
            to_come.fold([0.0_f64; 2], |[depth, rate], each| [depth.max(each.depth), rate.max(each.rate)]);
        (depth > 0.0).then(|| [depth, depth / rate])
    }
}
