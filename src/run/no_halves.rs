//! In place of the steps of surfaces that attract each other, where their room is not compiled.

use crate::contact::step::Attempt;
use crate::contact::{State, Step, ViscoelasticContact};
use crate::error::{Error, Result, missing};
use crate::hereditary::{Outlook, TimeError};
use crate::run::adaptive_step::{StepSearch, Tried};

/// The step that was divided last: none is.
#[derive(Debug, Clone)]
pub enum Halves {}

impl Halves {
    pub(super) fn undo(&self, _: &mut ViscoelasticContact) {
        match *self {}
    }

    pub(super) fn start_of(&self, _: f64) -> Option<&State> {
        match *self {}
    }
}

impl StepSearch<'_> {
    pub(super) fn in_halves(
        &mut self,
        _: &mut ViscoelasticContact,
        _: Attempt,
        _: &mut Step<'_>,
        _: &Outlook,
        _: TimeError,
        _: f64,
    ) -> Result<Tried> {
        Err(missing("attraction"))
    }
}

pub(super) fn is_pulled_off(_: &Error) -> bool {
    false
}
