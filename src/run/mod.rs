//! Runs along a load history.
//!
//! `follow` takes the next step: of given length, or as long as its error allows. An adaptive step is proposed, tried, judged
//! by its error, and accepted or tried again shorter (`adaptive_step`); `step_control` holds the error, the past steps and the
//! length of the next one, `run_scale` the greatest loads and displacements of the run, and `progress` the state of a run.

mod adaptive_step;
mod follow;
mod progress;
mod run_scale;
mod samples;
#[cfg(feature = "checkpoint")]
mod saving;
mod steady;
mod step_control;

pub use crate::ascending::Times;
pub use follow::Run;
pub use progress::{ErrorBudget, RunProgress, Stepping};
pub use samples::Sample;
pub use steady::{SteadyMotion, SteadyRun};

use std::ops::{Deref, DerefMut};

use crate::contact::ViscoelasticContact;
use crate::load::LoadHistory;

/// A value that a run borrows as `B` or owns as `O`.
#[derive(Debug)]
pub(super) enum OwnedOrBorrowed<B, O> {
    Borrowed(B),
    Owned(O),
}

/// The contact of a run.
pub(super) type RunContact<'a> = OwnedOrBorrowed<&'a mut ViscoelasticContact, Box<ViscoelasticContact>>;
/// The load history of a run. The owned one borrows nothing: after its last use a run no longer borrows its contact, even before
/// the run is dropped.
pub(super) type RunHistory<'a> = OwnedOrBorrowed<&'a dyn LoadHistory, Box<dyn LoadHistory>>;

impl Deref for RunContact<'_> {
    type Target = ViscoelasticContact;

    fn deref(&self) -> &ViscoelasticContact {
        match self {
            OwnedOrBorrowed::Borrowed(contact) => contact,
            OwnedOrBorrowed::Owned(contact) => contact,
        }
    }
}

impl DerefMut for RunContact<'_> {
    fn deref_mut(&mut self) -> &mut ViscoelasticContact {
        match self {
            OwnedOrBorrowed::Borrowed(contact) => contact,
            OwnedOrBorrowed::Owned(contact) => contact,
        }
    }
}

impl<'a> Deref for RunHistory<'a> {
    type Target = dyn LoadHistory + 'a;

    fn deref(&self) -> &(dyn LoadHistory + 'a) {
        match self {
            OwnedOrBorrowed::Borrowed(history) => *history,
            OwnedOrBorrowed::Owned(history) => &**history,
        }
    }
}
