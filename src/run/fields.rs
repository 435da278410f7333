//! Runs with fields to an accuracy.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use crate::contact::StepReport;
use crate::error::{Result, within};
use crate::run::RunContact;
use crate::run::driven::{FieldReport, FieldRequest, Moment, Prepared};
use crate::run::field::{MOST_FIELDS, RunFields};
use crate::run::follow::{Run, history_of};

/// Contacts at the starts of so many last steps are kept where they give the estimate.
const STARTS: usize = 3;

impl<'a, C: RunContact> Run<'a, C> {
    /// Makes the pressure at the times to sample ([`Run::sample_at`]) exact to `accuracy`: the error in time is Σ |δp| over Σ p, or over a
    /// hundredth of the greatest force of the run if that is more. 99 % of random fields of bodies that creep up to 100-fold are below the
    /// accuracy; more creep errs up to ten times as much. [`Stepping::adaptive`](crate::run::Stepping::adaptive) promises approach and force
    /// alone: cells that joined in the last long step have the pressure of one moment, which is off by 1 to 30 %.
    ///
    /// Where the contact is a superposition of its elastic states ([`states`](crate::states)) the steps stay as they are, bitwise. A few
    /// elastic contacts beside the run give the pressure of [`Sample::contact`](crate::run::Sample::contact) and [`Run::within_step`] at any
    /// time: 6 for 1e-2 and 10 for 1e-3 in the median, 12 and 41 for a tenth of the fields. Displacement and motions stay as in the run.
    ///
    /// Elsewhere steps end before each of the times, and [`Run::contact`] has the pressure there. Where an elastic contact shrinks as its load
    /// grows, the levels choose these steps, 8 more for 1e-2 and 16 for 1e-3 in the median. Where load points or tilts change, or bodies are
    /// several, attract each other or are shared out by ranks, 12 steps are graded by 0.7, and the estimate is the difference to the last three
    /// steps taken in halves.
    ///
    /// [`Sample::field`](crate::run::Sample::field) has the estimated error. Relative to the field the L2 error is about twice as large, and
    /// the error of the greatest pressure five times.
    /// At a jump of the load both the step that ends there and the jump have a sample: the field before it, and the field after it.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0)?))
    ///     .build()?;
    /// let load = StepLoad::new(Load::force(0.3))?;
    /// let run = contact.follow(&load, Stepping::adaptive(1.0e-2), 10.0);
    /// let mut run = run.sample_at([0.5, 5.0])?.fields_to(1.0e-2)?;
    /// while run.next_step()?.is_some() {
    ///     for sample in run.samples() {
    ///         let sample = sample?;
    ///         if let Some(field) = sample.field() {
    ///             println!("{:.4e} Pa to {:?}", sample.contact().max_pressure(), field.error);
    ///         }
    ///     }
    /// }
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the accuracy is outside \[1e-5, 0.1\].
    pub fn fields_to(mut self, accuracy: f64) -> Result<Run<'a, C>> {
        let accuracy = within("accuracy of the fields", accuracy, (1e-5..=0.1).contains(&accuracy), "in [1e-5, 0.1]")?;
        let (ends, starts, worst) = (Vec::new(), VecDeque::new(), Mutex::new(None));
        self.fields = Some(RunFields { accuracy, found: None, ends, keeps_starts: false, worst, starts });
        Ok(self)
    }

    /// Finds out how the fields of the run are found, before its first step.
    pub(super) fn prepare_fields(&mut self) -> Result<()> {
        let Some(fields) = self.fields.as_mut() else { return Ok(()) };
        if fields.found.is_some() {
            fields.starts.extend(fields.keeps_starts.then(|| C::clone(&self.contact)));
            return Ok(());
        }
        let (mut times, mut time) = (Vec::new(), self.progress.start);
        while let Some(next) = self.sampled.after(time).filter(|next| *next <= self.until && times.len() <= MOST_FIELDS)
        {
            times.push(next);
            time = next;
        }
        let history = history_of(&self.history);
        let (start, until) = (self.progress.start, self.until);
        let request = FieldRequest { history, accuracy: fields.accuracy, start, until, times: &times };
        let Prepared { fields: found, stops, keeps_starts } = self.contact.fields(&mut self.control, &request)?;
        (fields.found, fields.keeps_starts) = (Some(found), keeps_starts);
        fields.starts.extend(keeps_starts.then(|| C::clone(&self.contact)));
        fields.ends.push(self.contact.time());
        self.stops.add(stops.into(), self.progress.start)
    }

    /// Remembers the last step for the estimate of the fields.
    pub(super) fn keep_step(&mut self) {
        if let (Some(fields), Some((_, report))) = (self.fields.as_mut(), self.last) {
            fields.ends.push(report.time);
            while fields.starts.len() > STARTS {
                fields.starts.pop_front();
            }
        }
    }

    /// A contact of the last step with its field to the accuracy, where it does not have it itself.
    pub(super) fn with_field(&self, contact: &C, after: bool) -> Result<Option<(Option<C>, FieldReport)>> {
        let Some((fields, found)) = self.fields.as_ref().and_then(|fields| Some((fields, fields.found.as_ref()?)))
        else {
            return Ok(None);
        };
        let history = history_of(&self.history);
        let moment = Moment { history, after, ends: &fields.ends, starts: &fields.starts };
        let (exact, report) = contact.with_field(found, &moment)?;
        if let Some(error) = report.error {
            let mut worst = fields.worst.lock().unwrap_or_else(PoisonError::into_inner);
            *worst = Some(worst.unwrap_or(0.0).max(error));
        }
        Ok(Some((exact, report)))
    }

    /// The greatest error of the fields so far.
    pub(super) fn worst_field(&self) -> Option<f64> {
        *self.fields.as_ref()?.worst.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn field_within_step(&self, time: f64) -> Result<(C, StepReport, Option<FieldReport>)> {
        let (contact, report) = self.sample_within_step(time)?;
        let after = self.last.is_none_or(|(_, last)| time < last.time || last.dt == 0.0);
        Ok(match self.with_field(&contact, after)? {
            Some((exact, field)) => (exact.unwrap_or(contact), report, Some(field)),
            None => (contact, report, None),
        })
    }
}
