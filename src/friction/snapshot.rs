//! Copies of a contact with friction in memory, to come back to.

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
        let region = self.state.region;
        self.state.clone_from(&snapshot.state);
        self.saved_run = None;
        if region != self.state.region {
            self.fit_to_region();
        }
        Ok(())
    }
}
