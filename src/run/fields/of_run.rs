//! Runs with fields to an accuracy.

use std::sync::{Mutex, PoisonError};

use super::{FieldFinder, FieldRequest, MOST_FIELDS, Prepared, RunFields};
use crate::error::{Result, count_within, within};
use crate::run::Contact;
use crate::run::control::{Exact, FieldReport};
use crate::run::follow::Run;
use crate::run::progress::Stepping;

impl<'a, C: Contact> Run<'a, C> {
    /// Asks for fields to an accuracy.
    pub(crate) fn ask_for(mut self, finder: Box<dyn FieldFinder<C>>, accuracy: f64) -> Result<Run<'a, C>> {
        let bodies = self.histories.count();
        count_within("rigid bodies of a run with fields", bodies, bodies == 1, "1")?;
        let accuracy = within("accuracy of the fields", accuracy, (1e-5..=0.1).contains(&accuracy), "in [1e-5, 0.1]")?;
        self.fields = Some(RunFields { accuracy, finder, is_prepared: false, worst: Mutex::new(None) });
        Ok(self)
    }

    /// Finds out how the fields of the run are found, before its first step.
    pub(in crate::run) fn prepare_fields(&mut self) -> Result<()> {
        let Some(fields) = self.fields.as_mut().filter(|fields| !fields.is_prepared) else { return Ok(()) };
        let (mut times, mut time) = (Vec::new(), self.progress.start.next_down());
        while let Some(next) = self.sampled.after(time).filter(|next| *next <= self.until && times.len() <= MOST_FIELDS)
        {
            times.push(next);
            time = next;
        }
        let history = self.histories.first();
        let (start, until) = (self.progress.start, self.until);
        let is_adaptive = matches!(self.stepping, Stepping::Adaptive { .. });
        let (accuracy, cancelled) = (fields.accuracy, self.cancelled.as_ref());
        let request = FieldRequest { history, accuracy, start, until, times: &times, is_adaptive, cancelled };
        let Prepared { stops, tolerance } = fields.finder.prepare(&self.contact, &request)?;
        self.control.tighten(tolerance);
        fields.is_prepared = true;
        self.stops.add(stops.into(), self.progress.start)
    }

    /// Shows the step just taken, from `start` on, to what finds the fields.
    pub(in crate::run) fn show_step(&mut self, start: f64) {
        let Some(fields) = self.fields.as_mut() else { return };
        fields.finder.follow(&self.contact, self.histories.first(), start);
    }

    /// What has the field of a contact of the last step to the accuracy, where it has not itself.
    pub(in crate::run) fn exact_field(
        &self,
        contact: &C,
        after: bool,
    ) -> Result<(Option<Exact<C>>, Option<FieldReport>)> {
        let Some(fields) = self.fields.as_ref().filter(|fields| fields.is_prepared) else { return Ok((None, None)) };
        let (exact, report) =
            fields.finder.exact_field(contact, self.histories.first(), after, self.cancelled.as_ref())?;
        if let Some(error) = report.error {
            let mut worst = fields.worst.lock().unwrap_or_else(PoisonError::into_inner);
            *worst = Some(worst.unwrap_or(0.0).max(error));
        }
        Ok((exact, Some(report)))
    }

    /// The maximum error of the fields so far.
    pub(in crate::run) fn worst_field(&self) -> Option<f64> {
        *self.fields.as_ref()?.worst.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// [`Run::exact_field`] at a time within the last step.
    pub(in crate::run) fn exact_within_step(
        &self,
        contact: &C,
        time: f64,
    ) -> Result<(Option<Exact<C>>, Option<FieldReport>)> {
        self.exact_field(contact, self.last.is_none_or(|(_, last)| time < last.time || last.dt == 0.0))
    }
}
