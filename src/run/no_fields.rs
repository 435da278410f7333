//! In place of fields to an accuracy, where the room of elastic states is not compiled.

use std::convert::Infallible;
use std::marker::PhantomData;

use crate::error::Result;
use crate::run::Contact;
use crate::run::control::{Exact, FieldReport};
use crate::run::follow::Run;

/// The fields that a run is asked for: there are none.
#[derive(Debug)]
pub(super) struct RunFields<C>(Infallible, PhantomData<C>);

/// The fields of a contact to an accuracy: those of the contact itself.
type OwnFields<C> = (Option<Exact<C>>, Option<FieldReport>);

impl<C: Contact> Run<'_, C> {
    pub(super) fn prepare_fields(&mut self) -> Result<()> {
        Ok(())
    }

    pub(super) fn show_step(&mut self, _: f64) {}

    pub(super) fn exact_field(&self, _: &C, _: bool) -> Result<OwnFields<C>> {
        Ok((None, None))
    }

    pub(super) fn exact_within_step(&self, _: &C, _: f64) -> Result<OwnFields<C>> {
        Ok((None, None))
    }

    pub(super) fn worst_field(&self) -> Option<f64> {
        None
    }
}
