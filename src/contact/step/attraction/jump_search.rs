//! Whether surfaces snapped within a step: a jump is what stays however the step is split.
//!
//! Where nothing jumps, what a step [releases](PassReport::released) is of second order in its length: each half
//! releases a quarter of it. So of a step that is suspected of a jump the middle is computed, and both halves are
//! looked at: the end of the second is known. A half that is suspected is halved again, as far as to a quarter of the
//! step.

use super::passes::JUMPS;
use super::{PassReport, add};
use crate::contact::{Step, ViscoelasticContact};
use crate::equilibrium::{Equilibrium, Held};
use crate::error::{Error, Result};
use crate::load::Load;
use crate::solver::{Counts, Solution};

impl ViscoelasticContact {
    /// How the passes of the step tried last went; `None` without attraction, and before the first step.
    pub fn passes(&self) -> Option<PassReport> {
        self.computation.attracted.as_ref().map(|passes| passes.report)
    }

    /// Looks whether surfaces snapped within the step that was accepted last. The state is as it was.
    ///
    /// # Errors
    /// If the step is cancelled, or the law of attraction fails. A part that is not found is a jump.
    pub(in crate::contact) fn look_for_jump(&mut self, step: &Step<'_>) -> Result<()> {
        let Some(own) = self.computation.attracted.as_mut() else { return Ok(()) };
        let (whole, end, state) = (own.report, own.end.take(), &mut self.computation.state);
        if !state.history.start_is_kept() {
            own.report.jumped = true;
            return Ok(());
        }
        // parts need not be looked at
        own.looks = false;
        let mut end = end.unwrap_or_else(|| Box::new(state.clone()));
        (*end).clone_from(state);
        state.roll_back();
        let start = self.load_like(0, &step.loads[0]);
        let mut search = JumpSearch { contact: self, step, start, released: whole.released, counts: Counts::default() };
        let jumps = search.jumps(0.0, 1.0, &end.held.current.solution);
        let (counts, jumped) = (search.counts, *jumps.as_ref().unwrap_or(&true));
        self.go_to(&end);
        add(&mut self.computation.state.held.current.solution.counts, counts);
        if let Some(own) = self.computation.attracted.as_mut() {
            (own.report, own.end, own.looks) = (PassReport { jumped, ..whole }, Some(end), true);
        }
        match jumps {
            Err(error @ (Error::Cancelled { .. } | Error::User(_))) => Err(error),
            _ => Ok(()),
        }
    }

    /// Whether the parts have come to another state than the step: beside a jump that was to come the step took it
    /// early.
    pub(in crate::contact) fn is_elsewhere(&self, [start, end]: [&Equilibrium; 2]) -> bool {
        let [end, start, now] = [end, start, &self.computation.state.held.current].map(|at| &at.solution.potential);
        // on other cells they are not compared
        if end.len() != start.len() || end.len() != now.len() {
            return true;
        }
        let [off, change] = end.iter().zip(start).zip(now).fold([0.0; 2], |[off, change], ((end, start), now)| {
            [off + (now - end).abs(), change + (start - end).abs()]
        });
        off > 0.5 * change
    }
}

/// The search for a jump in a step that was taken.
struct JumpSearch<'a> {
    contact: &'a mut ViscoelasticContact,
    step: &'a Step<'a>,
    start: Load,
    released: f64,
    counts: Counts,
}

impl JumpSearch<'_> {
    /// Whether surfaces jump between two shares of the step, from the state of the contact to `end`. Where they do
    /// not, the contact comes to the end.
    fn jumps(&mut self, from: f64, to: f64, end: &Solution) -> Result<bool> {
        let middle = 0.5 * (from + to);
        Ok(self.jumps_in_part(from, middle, None)? || self.jumps_in_part(middle, to, Some(end))?)
    }

    /// Whether surfaces jump in a part of the step, which is only compared with its start where its `end` is known.
    fn jumps_in_part(&mut self, from: f64, to: f64, end: Option<&Solution>) -> Result<bool> {
        let JumpSearch { contact, step, .. } = self;
        let (part, begun) = (to - from, contact.time());
        let left = step.interval.time - begun;
        let time = if to == 1.0 { step.interval.time } else { begun + left * part / (1.0 - from) };
        let loads = [self.start.towards(&step.loads[0], to)];
        let tolerance = step.tolerance.max(JUMPS.tolerance);
        let mut taken = contact.request(time, time - begun, &loads, tolerance)?;
        (taken.interval.interpolant, taken.end, taken.cancelled) = (step.interval.interpolant, end, step.cancelled);
        let attempt = contact.attempt(&taken)?;
        contact.adopt(attempt, taken, [0.0; 2])?;
        let Held { current, .. } = &contact.computation.state.held;
        add(&mut self.counts, current.solution.counts);
        // besides the jump, what is smooth
        let least = (JUMPS.in_a_part + (1.0 - JUMPS.in_a_part) * part * part) * self.released;
        if !contact.passes().is_some_and(|report| report.may_jump(least)) {
            return Ok(false);
        }
        if part <= JUMPS.shortest {
            return Ok(true);
        }
        let end = current.solution.clone();
        contact.computation.state.roll_back();
        self.jumps(from, to, &end)
    }
}
