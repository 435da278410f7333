//! Copies of a contact with friction in memory, to come back to.

use std::sync::Arc;

use crate::contact::Snapshot;
use crate::error::Result;
use crate::friction::contact::FrictionContact;
use crate::friction::state::State;

/// The state of a contact with friction in memory, made by [`FrictionContact::snapshot`].
#[derive(Debug, Clone)]
pub struct FrictionSnapshot {
    normal: Snapshot,
    state: State,
}

impl FrictionContact {
    /// The state as it is, to come back to.
    pub fn snapshot(&self) -> FrictionSnapshot {
        FrictionSnapshot { normal: self.normal.snapshot(), state: self.state.clone() }
    }

    /// Goes back to a state: the steps that follow are the same as they were, bitwise.
    ///
    /// # Errors
    /// If the snapshot was made of another contact; a contact and its clones may exchange theirs.
    pub fn restore(&mut self, snapshot: &FrictionSnapshot) -> Result<()> {
        self.normal.restore(&snapshot.normal)?;
        self.saved_run = None;
        self.take_state(&snapshot.state);
        Ok(())
    }

    fn take_state(&mut self, state: &State) {
        let region = self.state.region;
        self.state.clone_from(state);
        if region != self.state.region {
            self.fit_to_region();
        }
    }
}

impl Clone for FrictionContact {
    fn clone(&self) -> FrictionContact {
        FrictionContact {
            normal: self.normal.clone(),
            start: self.start.clone(),
            limit: Arc::clone(&self.limit),
            response: self.response.clone(),
            state: self.state.clone(),
            kernel: self.kernel.clone(),
            step: self.step.clone(),
            loads_along: self.loads_along.clone(),
            saved_run: self.saved_run.clone(),
            ..*self
        }
    }

    /// Of clones of one contact this takes the state alone, and allocates nothing.
    fn clone_from(&mut self, other: &FrictionContact) {
        if !Arc::ptr_eq(&self.normal.scene, &other.normal.scene) {
            *self = other.clone();
            return;
        }
        self.normal.go_to(&other.normal.computation.state);
        self.take_state(&other.state);
        (self.tolerance, self.unresolved, self.least) = (other.tolerance, other.unresolved, other.least);
        self.loads_along.clone_from(&other.loads_along);
        self.saved_run.clone_from(&other.saved_run);
    }
}
