//! Fields of runs to an accuracy.

use std::sync::{Mutex, PoisonError};

use crate::contact::{Scene, ViscoelasticContact};
use crate::error::{Error, Result, count_within};
use crate::load::LoadHistory;
use crate::run::Run;
use crate::run::driven::{FieldFinder, FieldReport, FieldRequest, Moment, Prepared};
use crate::run::field::MOST_FIELDS;
use crate::states::beside::Beside;
use crate::states::contact::StatesContact;
use crate::states::reach::Course;
use crate::states::repeated::Repeated;

/// The run errs by this part of the accuracy of the fields where its error is amplified as many times.
const OF_AMPLIFIED: f64 = 1.5;
/// Number and ratio of the graded steps before a field where nothing better is known.
const GRADED: i32 = 12;
const RATIO: f64 = 0.7;

/// How the fields of a run in space are found: from elastic contacts, or by steps, whose error is known, where these shrink; without,
/// by graded steps.
#[derive(Debug, Default)]
struct InSpace(Option<Mutex<Box<Beside>>>);

impl<'a> Run<'a> {
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
    pub fn fields_to(self, accuracy: f64) -> Result<Run<'a>> {
        self.ask_for(Box::new(InSpace::default()), accuracy)
    }
}

impl<'a> Run<'a, StatesContact> {
    /// As [`Run::fields_to`] in space: [`Sample::contact`](crate::run::Sample::contact) is then a contact of fine steps of its own, whose
    /// [`StatesContact::fields`] have the accuracy.
    ///
    /// # Errors
    /// If the accuracy is outside \[1e-5, 0.1\].
    pub fn fields_to(self, accuracy: f64) -> Result<Run<'a, StatesContact>> {
        self.ask_for(Box::new(OnStates::default()), accuracy)
    }
}

impl FieldFinder<ViscoelasticContact> for InSpace {
    fn prepare(&mut self, contact: &ViscoelasticContact, request: &FieldRequest<'_>) -> Result<Prepared> {
        let FieldRequest { history, accuracy, start, until, times } = *request;
        let Scene { material, temperature, settings, attraction, .. } = &*contact.scene;
        let course = Course { material, temperature: temperature.as_ref(), history, until };
        let state = &contact.computation.state;
        let is_alone = contact.bodies() == 1 && attraction.is_none() && !state.region.is_shared();
        let is_new = start == 0.0 || state.is_undisturbed();
        let kind = (settings.adaptive_interpolant(), start);
        let beside = (is_alone && is_new).then(|| Beside::new(contact, &course, accuracy, kind)).transpose();
        if let Some(beside) = unless_refused(beside)?.flatten() {
            let (mut stops, mut finest) = (Vec::new(), 1.0_f64);
            let times = if beside.serves() { &[] } else { few(times)? };
            for &time in times {
                let (before, amplification) = beside.stops(history, time)?;
                finest = finest.min(OF_AMPLIFIED / amplification);
                stops.extend(before.into_iter().chain([time]));
            }
            let tolerance = if beside.serves() { f64::INFINITY } else { finest * accuracy };
            self.0 = Some(Mutex::new(Box::new(beside)));
            return Ok(Prepared { stops, tolerance, keeps_starts: false });
        }
        let mut stops = Vec::new();
        for &time in few(times)? {
            let (mut since, mut corner) = (start, history.next_breakpoint(start));
            while let Some(next) = corner.filter(|next| *next > since && *next < time) {
                (since, corner) = (next, history.next_breakpoint(next));
            }
            let graded = (1..=GRADED).map(|j| time - (time - since) * RATIO.powi(j));
            stops.extend(graded.chain([time]));
        }
        Ok(Prepared { stops, tolerance: accuracy, keeps_starts: true })
    }

    fn with_field(
        &self,
        contact: &ViscoelasticContact,
        moment: &Moment<'_, ViscoelasticContact>,
    ) -> Result<(Option<ViscoelasticContact>, FieldReport)> {
        let Moment { history, after, ends, starts } = *moment;
        let mut report = FieldReport::default();
        let Some(beside) = &self.0 else {
            report.error = match starts.front() {
                Some(start) if after || start.time() < contact.time() => {
                    Some(contact.error_by_halves(start, history, ends)?)
                }
                _ => None,
            };
            return Ok((None, report));
        };
        let mut beside = beside.lock().unwrap_or_else(PoisonError::into_inner);
        if beside.serves() {
            match beside.pressure(history, contact.time(), after) {
                Ok(found) => {
                    [report.elastic_contacts, report.convolutions] = found.spent;
                    if let Some(contact) = contact.with_pressure(&found.pressure) {
                        report.error = Some(found.error);
                        return Ok((Some(contact), report));
                    }
                }
                // an elastic contact that shrinks here says nothing of the steps
                Err(Error::States(_) | Error::Step(_)) => return Ok((None, report)),
                Err(error) => return Err(error),
            }
        }
        let error = beside.error_of_steps(history, ends, (contact.time(), after));
        report.error = unless_refused(error.map(Some))?;
        Ok((None, report))
    }
}

/// Accepts so many times as steps can end for.
fn few(times: &[f64]) -> Result<&[f64]> {
    count_within("fields for which steps end", times.len(), times.len() <= MOST_FIELDS, "10 000 at most")?;
    Ok(times)
}

/// Nothing where elastic states do not cover a scene.
fn unless_refused<T>(found: Result<Option<T>>) -> Result<Option<T>> {
    match found {
        Err(Error::States(_) | Error::Step(_)) => Ok(None),
        other => other,
    }
}

impl ViscoelasticContact {
    /// Σ |δp| over Σ p between this contact, and one that took the steps since `start` in halves.
    fn error_by_halves(&self, start: &Self, history: &dyn LoadHistory, ends: &[f64]) -> Result<f64> {
        let (mut contact, attracts) = (start.clone(), self.scene.attraction.is_some());
        for &end in ends.iter().filter(|end| **end > start.time()) {
            let middle = 0.5 * (contact.time() + end);
            for time in [middle, end] {
                let load = history.checked_before(time, attracts)?;
                contact.step(time - contact.time(), load)?;
            }
        }
        let differences = self.pressure().iter().zip(contact.pressure()).map(|(one, other)| (one - other).abs());
        let sum: f64 = self.pressure().iter().sum();
        Ok(if sum > 0.0 { differences.sum::<f64>() / sum } else { 0.0 })
    }
}

/// A run on states in fine steps.
#[derive(Debug, Default)]
struct OnStates(Option<Repeated>);

impl FieldFinder<StatesContact> for OnStates {
    fn prepare(&mut self, contact: &StatesContact, request: &FieldRequest<'_>) -> Result<Prepared> {
        let FieldRequest { history, accuracy, until, .. } = *request;
        self.0 = Some(Repeated::new(contact.clone(), history, until, accuracy)?.0);
        Ok(Prepared { stops: Vec::new(), tolerance: f64::INFINITY, keeps_starts: false })
    }

    fn with_field(
        &self,
        contact: &StatesContact,
        moment: &Moment<'_, StatesContact>,
    ) -> Result<(Option<StatesContact>, FieldReport)> {
        let found = self.0.as_ref().map(|run| run.at(moment.history, contact.time(), moment.after)).transpose()?;
        Ok((found.map(|found| found.contact), FieldReport::default()))
    }
}
