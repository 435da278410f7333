//! A requested step.

use std::sync::Arc;

use crate::contact::indenter::Indenter;
use crate::contact::state::State;
use crate::hereditary::Interval;
use crate::load::{Load, Tilt};
use crate::solver::RigidMotion;

/// A step to be tried.
#[derive(Debug, Clone)]
pub(in crate::contact) struct Step<'a> {
    pub(in crate::contact) interval: Interval,
    /// The load of each body at its end.
    pub(in crate::contact) loads: &'a [Load],
    /// The indenter at its end.
    pub(in crate::contact) indenter: Arc<Indenter>,
    /// Of the solver.
    pub(in crate::contact) tolerance: f64,
}

impl Step<'_> {
    /// Whether the initial gap differs from the gap of the last step.
    pub(in crate::contact) fn has_new_indenter(&self, state: &State) -> bool {
        state.indenter_is_new || self.indenter.id() != state.indenter.id()
    }

    /// What the load of a body prescribes of its motion, the approach from the datum of the gap; zero where it leaves
    /// it free.
    pub(in crate::contact) fn prescribed(&self, body: usize) -> RigidMotion {
        let (load, datum) = (&self.loads[body], self.indenter.gap().datum);
        let approach = if let Load::Approach { approach, .. } = load { approach - datum } else { 0.0 };
        let tilt = load.tilt().map(|tilt| if let Tilt::Fixed(angle) = tilt { angle } else { 0.0 });
        RigidMotion { approach, tilt }
    }
}
