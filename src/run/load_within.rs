//! The load within a step.

use crate::contact::{Scene, State};
use crate::error::{Error, Result};
use crate::load::LoadHistory;
use crate::run::step_control::{NODES, StepControl};

/// Positions within a step at which the load is evaluated. They are uneven, so that no oscillation is zero at all of
/// them.
const SHARES: [f64; 5] = [0.153, 0.381, 0.5, 0.677, 0.891];

impl StepControl {
    /// Greatest deviation of the load in a step to `time` from the polynomial through its last nodes and the load
    /// at `time`, relative to the load or to a fraction of the greatest load of the run: at uneven positions, and at its
    /// tops. Rejects invalid loads of the history.
    pub(super) fn straying(&self, scene: &Scene, state: &State, history: &dyn LoadHistory, time: f64) -> Result<f64> {
        let (clock, now, attracts) = (&state.clock, state.clock.time, self.scale.attracts);
        let end = history.checked_before(time, attracts)?;
        let mut nodes = [(scene.reduced_time(clock, time)?, end); NODES + 1];
        let known = self.nodes.len().min(NODES);
        nodes[1..=known].copy_from_slice(&self.nodes[..known]);
        let nodes = &nodes[..=known];
        let start = nodes[known.min(1)].1;
        let scale = self.scale.of_load(&start, &end);
        let tops = self.scale.tops_within(now, time);
        let mut most = 0.0_f64;
        for (k, between) in SHARES.map(|share| now + share * (time - now)).into_iter().chain(tops).enumerate() {
            // a step that is too long already need not be looked at where the load has its tops
            if k >= SHARES.len() && most > self.tolerance {
                break;
            }
            let load = history.checked_at(between, attracts)?;
            let like = load.is_like(&start) && load.is_like(&end);
            let off = || Ok::<_, Error>(load.deviation(scene.reduced_time(clock, between)?, nodes, scale));
            most = most.max(if like { off()? } else { f64::INFINITY });
        }
        Ok(most)
    }
}

/// Whether the load is the same from `now` to `time`, and for as long after it.
pub(super) fn is_held(history: &dyn LoadHistory, now: f64, time: f64) -> bool {
    let load = history.at(now);
    load == history.at(time) && load == history.at(time + (time - now))
}
