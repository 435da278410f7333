//! The search for a step whose halves are kept.

use super::{Divided, Halves, greater};
use crate::contact::step::Attempt;
use crate::contact::{Step, ViscoelasticContact};
use crate::error::Result;
use crate::hereditary::{ERROR_FACTORS, Outlook, TimeError};
use crate::run::adaptive_step::{StepSearch, Tried};

impl StepSearch<'_> {
    /// Takes a step that was tried again, in two halves.
    pub(in crate::run) fn in_halves(
        &mut self,
        contact: &mut ViscoelasticContact,
        whole: Attempt,
        step: &mut Step<'_>,
        outlook: &Outlook,
        mut error: TimeError,
        excess: f64,
    ) -> Result<Tried> {
        let StepSearch { control, course, wasted, .. } = self;
        let mut halves = control.halves.take().unwrap_or_else(|| Box::new(Halves::new(&contact.computation.state)));
        let divided = halves.divide(contact, whole, step, course.histories.first(), outlook, wasted);
        if divided.is_err() {
            contact.computation.add_work(wasted);
            halves.undo(contact);
        }
        control.halves = Some(halves);
        let Divided { attempt, difference, errors } = divided?;
        let jumped = contact.passes().is_some_and(|passes| passes.jumped);
        error.relative = greater(error.relative, difference) * if jumped { ERROR_FACTORS.jumped } else { 1.0 };
        Ok(Tried { attempt, error, excess, halves: Some(errors) })
    }
}
