//! The errors of a run so far.

use crate::run::error_budget::ErrorBudget;
use crate::run::{Contact, Run};

impl<C: Contact> Run<'_, C> {
    /// The errors of the run so far, by their source. That of the mesh of a contact in space is
    /// [measured](crate::fields::Fields::mesh_error) by this call, in the present state.
    pub fn error_budget(&self) -> ErrorBudget {
        let mesh = self.contact.in_space().and_then(|fields| fields.mesh_error().unwrap_or_default());
        ErrorBudget { field: self.worst_field(), mesh, ..self.control.worst() }
    }
}
