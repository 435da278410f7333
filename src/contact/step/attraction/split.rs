//! Whether surfaces snapped within a step: a jump is what stays however the step is split.
//!
//! Where nothing jumps, what a step [releases](PassReport::released) is of second order in its length: eight parts release an eighth of it
//! together. So a step that is suspected of a jump is taken again in eight parts, from its start.

use super::{PassReport, add};
use crate::contact::{State, Step, ViscoelasticContact};
use crate::solver::Counts;

const PARTS: u32 = 8;
/// The parts of a jump release more than this share of what the step released.
const LEFT: f64 = 0.25;

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
        let mut counts = Counts::default();
        let jumped = self.releases_in_parts(step, LEFT * whole.released, &mut counts) || self.is_elsewhere(&end);
        self.go_to(&end);
        add(&mut self.computation.state.current.solution.counts, counts);
        if let Some(own) = self.computation.trial.passes.as_mut() {
            (own.report, own.end, own.looks) = (PassReport { jumped, ..whole }, Some(end), true);
        }
    }

    /// Whether the parts have come to another state than the step: beside a jump that was to come the step took it early.
    fn is_elsewhere(&self, end: &State) -> bool {
        let State { current, previous, .. } = end;
        let [end, start, now] = [current, previous, &self.computation.state.current].map(|at| &at.solution.potential);
        let [off, change] = end.iter().zip(start).zip(now).fold([0.0; 2], |[off, change], ((end, start), now)| {
            [off + (now - end).abs(), change + (start - end).abs()]
        });
        off > 0.5 * change
    }

    /// Whether the parts of the step release more than this; also if one of them has no solution.
    fn releases_in_parts(&mut self, step: &Step<'_>, most: f64, counts: &mut Counts) -> bool {
        let (from, to, mut released) = (self.time(), step.interval.time, 0.0);
        let start = self.load_like(0, &step.loads[0]);
        for part in 1..=PARTS {
            let share = f64::from(part) / f64::from(PARTS);
            let time = if part == PARTS { to } else { from + share * (to - from) };
            let loads = [start.towards(&step.loads[0], share)];
            let Ok(mut own) = self.request(time, time - self.time(), &loads, step.tolerance) else { return true };
            own.interval.interpolant = step.interval.interpolant;
            own.cancelled = step.cancelled;
            let taken = self.attempt(&own).and_then(|attempt| self.adopt(attempt, own, [0.0; 2]));
            add(counts, self.computation.state.current.solution.counts);
            released += self.passes().map_or(0.0, |report| report.released);
            if taken.is_err() || released > most {
                return true;
            }
        }
        false
    }
}
