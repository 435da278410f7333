//! Contacts on elastic states as they were or are, to come back to.

use std::sync::Arc;

use crate::error::{Result, of_other_contact};
use crate::states::contact::StatesContact;

impl StatesContact {
    /// Becomes what a clone of this contact is, without allocating where there is room: to go back to it, or to keep in
    /// a clone made before what the contact is now. The steps that follow are the same as they were, bitwise, with
    /// exact states to the tolerance of the solver.
    ///
    /// # Errors
    /// If they are no clones of one contact.
    pub fn restore(&mut self, clone: &StatesContact) -> Result<()> {
        if !Arc::ptr_eq(&self.scene, &clone.scene) {
            return Err(of_other_contact());
        }
        self.copy_from(clone);
        self.saved_run = None;
        Ok(())
    }

    pub(super) fn copy_from(&mut self, other: &StatesContact) {
        self.states.clone_from(&other.states);
        self.levels.copy_from(&other.levels);
        let StatesContact { time, reduced_time, undisturbed_until, prescribed, .. } = *other;
        (self.time, self.reduced_time, self.undisturbed_until) = (time, reduced_time, undisturbed_until);
        self.prescribed = prescribed;
    }
}
