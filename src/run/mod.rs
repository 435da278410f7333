//! Runs along a load history, of every contact.
//!
//! [`Run`] leads a contact in space ([`ViscoelasticContact`](crate::ViscoelasticContact)) or on elastic states
//! ([`StatesContact`](crate::states::StatesContact)).

// `follow` takes the next step of any contact (`driven`): of given length, or as long as its error allows. In space
// (`in_space`) `step_control` alone owns the length of a step: `adaptive_step` has it proposed, tries it, has it
// judged by its error, and accepts it or tries again. The error depends on the loads within the step (`track`, one
// for each body) and on what lies ahead and behind (`outlook`): the greatest loads and displacements of the run
// (`run_scale`), and what the steps so far leave (`past_steps`).

mod adaptive_step;
#[cfg(feature = "checkpoint")]
mod autosave;
pub(crate) mod driven;
mod error_budget;
mod event;
mod events;
mod extremes;
pub(crate) mod field;
mod fields;
mod follow;
mod halves;
pub(crate) mod histories;
mod in_space;
mod outlook;
mod past_steps;
pub(crate) mod progress;
mod rises;
mod run_scale;
mod samples;
#[cfg(feature = "checkpoint")]
mod saving;
mod step_control;
mod tops;
mod track;

pub use crate::ascending::Times;
pub use driven::FieldReport;
pub use error_budget::ErrorBudget;
pub use event::{Crossing, Event};
pub use follow::Run;
pub(crate) use progress::SAME_TIME;
pub use progress::{RunProgress, Stepping};
pub use samples::Sample;

use std::ops::{Deref, DerefMut};

/// A contact that a [`Run`] leads: [`ViscoelasticContact`](crate::ViscoelasticContact) or
/// [`StatesContact`](crate::states::StatesContact). What a run asks of it is private.
pub trait RunContact: driven::Driven {}

impl<C: driven::Driven> RunContact for C {}

/// A value that a run borrows as `B` or owns as `O`.
#[derive(Debug)]
pub(crate) enum OwnedOrBorrowed<B, O> {
    Borrowed(B),
    Owned(O),
}

impl<T: Clone> OwnedOrBorrowed<&mut T, Box<T>> {
    fn into_owned(self) -> T {
        match self {
            OwnedOrBorrowed::Borrowed(value) => value.clone(),
            OwnedOrBorrowed::Owned(value) => *value,
        }
    }
}

impl<B: Deref, O: Deref<Target = B::Target>> Deref for OwnedOrBorrowed<B, O> {
    type Target = B::Target;

    fn deref(&self) -> &B::Target {
        match self {
            OwnedOrBorrowed::Borrowed(value) => value,
            OwnedOrBorrowed::Owned(value) => value,
        }
    }
}

impl<B: DerefMut, O: DerefMut<Target = B::Target>> DerefMut for OwnedOrBorrowed<B, O> {
    fn deref_mut(&mut self) -> &mut B::Target {
        match self {
            OwnedOrBorrowed::Borrowed(value) => value,
            OwnedOrBorrowed::Owned(value) => value,
        }
    }
}
