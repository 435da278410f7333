//! Contacts on elastic states as they were, to come back to.

use std::sync::Arc;

use crate::error::{Result, of_other_contact};
use crate::states::contact::StatesContact;

impl StatesContact {
    /// The contact as it is, to come back to: a clone.
    pub fn snapshot(&self) -> StatesContact {
        self.clone()
    }

    /// [`StatesContact::snapshot`] into one made before, without allocating where there is room.
    pub fn snapshot_into(&self, snapshot: &mut StatesContact) {
        match snapshot.is_of(self) {
            true => snapshot.copy_from(self),
            false => *snapshot = self.clone(),
        }
    }

    /// Goes back to a snapshot, without allocating where there is room: the steps that follow are the same as they
    /// were, bitwise, with exact states to the tolerance of the solver.
    ///
    /// # Errors
    /// If the snapshot was made of another contact; a contact and its clones may exchange theirs.
    pub fn restore(&mut self, snapshot: &StatesContact) -> Result<()> {
        if !snapshot.is_of(self) {
            return Err(of_other_contact());
        }
        self.copy_from(snapshot);
        Ok(())
    }

    /// Whether both are clones of one contact.
    fn is_of(&self, other: &StatesContact) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
    }

    pub(super) fn copy_from(&mut self, other: &StatesContact) {
        self.states.clone_from(&other.states);
        self.levels.copy_from(&other.levels);
        let StatesContact { time, reduced_time, undisturbed_until, prescribed, .. } = *other;
        (self.time, self.reduced_time, self.undisturbed_until) = (time, reduced_time, undisturbed_until);
        self.prescribed = prescribed;
    }
}
