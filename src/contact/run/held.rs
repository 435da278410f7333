//! The contact and the history of a run.

use std::ops::{Deref, DerefMut};

use crate::contact::stepper::ViscoelasticContact;
use crate::load::LoadHistory;

/// A contact that a run borrows or owns.
#[derive(Debug)]
pub(in crate::contact) enum Held<'a> {
    Borrowed(&'a mut ViscoelasticContact),
    Owned(Box<ViscoelasticContact>),
}

impl Deref for Held<'_> {
    type Target = ViscoelasticContact;

    fn deref(&self) -> &ViscoelasticContact {
        match self {
            Held::Borrowed(contact) => contact,
            Held::Owned(contact) => contact,
        }
    }
}

impl DerefMut for Held<'_> {
    fn deref_mut(&mut self) -> &mut ViscoelasticContact {
        match self {
            Held::Borrowed(contact) => contact,
            Held::Owned(contact) => contact,
        }
    }
}

/// A history that a run borrows or owns. The owned one borrows nothing, so that a run that is not used any more releases its
/// contact before it is dropped.
#[derive(Debug)]
pub(in crate::contact) enum HeldHistory<'a> {
    Borrowed(&'a dyn LoadHistory),
    Owned(Box<dyn LoadHistory>),
}

impl<'a> Deref for HeldHistory<'a> {
    type Target = dyn LoadHistory + 'a;

    fn deref(&self) -> &(dyn LoadHistory + 'a) {
        match self {
            HeldHistory::Borrowed(history) => *history,
            HeldHistory::Owned(history) => &**history,
        }
    }
}
