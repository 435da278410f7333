//! Whether surfaces snapped within a step: a jump is what stays however the step is split.
//!
//! Where nothing jumps, what a step [releases](PassReport::released) is of second order in its length: each half releases a quarter of it. So a step
//! that is suspected of a jump is taken again in two halves, from its start, and a half that is suspected again in its halves, as far as to a quarter of the step.

use super::{PassReport, add};
use crate::contact::{State, Step, ViscoelasticContact};
use crate::error::Result;
use crate::load::Load;
use crate::solver::Counts;

/// The shortest parts of a step.
const SHORTEST: f64 = 0.25;
/// A part of a step with a jump releases more than this share of what the step released.
const LEFT: f64 = 0.16;

impl ViscoelasticContact {
    pub(in crate::contact) fn may_have_snapped(&self) -> bool {
        self.computation.trial.passes.as_ref().is_some_and(|own| own.report.suspected)
    }

    /// Looks whether surfaces snapped within the step that was accepted last. The state is as it was.
    pub(in crate::contact) fn look_for_jump(&mut self, step: &Step<'_>) {
        let Some(own) = self.computation.trial.passes.as_mut() else { return };
        let (whole, end, state) = (own.report, own.end.take(), &mut self.computation.state);
        if !state.history.start_is_kept() {
            own.report.jumped = true;
            return;
        }
        // parts need not be looked at
        own.looks = false;
        let mut end = end.unwrap_or_else(|| Box::new(state.clone()));
        (*end).clone_from(state);
        state.roll_back();
        let (start, mut counts) = (self.load_like(0, &step.loads[0]), Counts::default());
        let jumps = self.jumps_between(0.0, 1.0, start, step, whole.released, &mut counts);
        let jumped = jumps.unwrap_or(true) || self.is_elsewhere(&end);
        self.go_to(&end);
        add(&mut self.computation.state.current.solution.counts, counts);
        if let Some(own) = self.computation.trial.passes.as_mut() {
            (own.report, own.end, own.looks) = (PassReport { jumped, ..whole }, Some(end), true);
        }
    }

    /// Whether the parts have come to another state than the step: beside a jump that was to come the step took it early.
    pub(in crate::contact) fn is_elsewhere(&self, end: &State) -> bool {
        let State { current, previous, .. } = end;
        let [end, start, now] = [current, previous, &self.computation.state.current].map(|at| &at.solution.potential);
        let [off, change] = end.iter().zip(start).zip(now).fold([0.0; 2], |[off, change], ((end, start), now)| {
            [off + (now - end).abs(), change + (start - end).abs()]
        });
        off > 0.5 * change
    }

    /// Whether surfaces jump between two shares of a step that began under the load `start` and `released` so much.
    fn jumps_between(
        &mut self,
        from: f64,
        to: f64,
        start: Load,
        step: &Step<'_>,
        released: f64,
        counts: &mut Counts,
    ) -> Result<bool> {
        let (middle, part) = (0.5 * (from + to), 0.5 * (to - from));
        // besides the jump, what is smooth
        let least = (LEFT + (1.0 - LEFT) * part * part) * released;
        for [from, to] in [[from, middle], [middle, to]] {
            let begun = self.time();
            let left = step.interval.time - begun;
            let time = if to == 1.0 { step.interval.time } else { begun + left * (to - from) / (1.0 - from) };
            let loads = [start.towards(&step.loads[0], to)];
            self.take_part(time, &loads, step.tolerance, step.interval.interpolant, step.cancelled)?;
            add(counts, self.computation.state.current.solution.counts);
            if self.passes().is_some_and(|report| report.may_jump(least)) {
                if part <= SHORTEST {
                    return Ok(true);
                }
                self.computation.state.roll_back();
                if self.jumps_between(from, to, start, step, released, counts)? {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }
}
