//! Fields of runs to an accuracy.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

use crate::contact::{Scene, ViscoelasticContact};
use crate::equilibrium::Ground;
use crate::error::{Result, count_within};
use crate::load::{Load, LoadHistory};
use crate::run::Contact;
use crate::run::Run;
use crate::run::control::{Exact, FieldReport};
use crate::run::fields::{FieldFinder, FieldRequest, MOST_FIELDS, Prepared};
use crate::states::beside::FieldsByLevels;
use crate::states::contact::StatesContact;
use crate::states::none_if_not_covered;
use crate::states::reach::{Loading, sampled};
use crate::states::refined::Refined;
use crate::states::repeated::GradedRun;

/// Number and ratio of the graded steps before a field where levels do not give it.
const GRADED: (i32, f64) = (12, 0.7);

/// How the fields of a run in space are found.
#[derive(Debug, Default)]
enum InSpace {
    /// The run has not begun.
    #[default]
    Unknown,
    /// From elastic contacts.
    FieldsByLevels(Mutex<Box<FieldsByLevels>>),
    /// By graded steps, which are halved where they err by too much.
    Refined(Box<Refined>),
}

impl<'a> Run<'a> {
    /// Makes the pressure at the times to sample ([`Run::sample_at`]) exact to `accuracy`: the error in time is Σ
    /// |δp| over Σ p, or over a hundredth of the greatest force so far if that is more.
    /// [`Stepping::adaptive`](crate::run::Stepping::adaptive) controls approach and force alone: cells that joined in
    /// the last long step have the pressure of one moment, which is off by 1 to 30 %.
    ///
    /// The error is measured: levels, stops and steps are doubled until the field changes by less than was asked, and
    /// [`Sample::field`](crate::run::Sample::field) tells the last change. docs/maintainers/measurements.md has the
    /// errors of random scenes. Relative to the field the L2 error is about twice as large, and the error of the
    /// greatest pressure five times.
    ///
    /// Where the contact is a superposition of its elastic states ([`states`](crate::states)) the steps stay as they
    /// are, bitwise. A few elastic contacts beside the run give the pressure of
    /// [`Sample::fields`](crate::run::Sample::fields) and [`Run::fields_within_step`] at any time: 10 for 1e-2 and 20
    /// for 1e-3 in the median, 80 at most under a given force. Displacement and motions stay as in the run.
    ///
    /// Where load points or tilts change, where bodies attract each other or are shared out by ranks, where they were
    /// disturbed before the run begins, and where an elastic contact shrinks as its load grows, 12 steps graded by
    /// 0.7 end before each of the times. A run beside in steps twice as long tells the error, for half as much work
    /// again and the memory of two contacts. Where it is more than was asked, the steps so far are taken once more, in
    /// halves, until the field changes by less: at most four times, each for twice the work of the one before and the
    /// memory of a contact. There is no estimate once a step of the run beside has failed.
    ///
    /// At a jump of the load both the step that ends there and the jump have a sample: the field before it, and the
    /// field after it.
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
    ///             println!("{:.4e} Pa to {:?}", sample.fields().max_pressure(), field.error);
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
    /// As [`Run::fields_to`] in space: [`Sample::contact`](crate::run::Sample::contact) is then a contact of fine
    /// steps of its own, whose
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
        let FieldRequest { history, accuracy, start, until, times, is_adaptive, cancelled } = *request;
        let Scene { ground: Ground { settings, attraction, .. }, material, temperature, .. } = &*contact.scene;
        let course = Loading { material, temperature: temperature.as_ref(), history, until };
        let state = &contact.computation.state;
        let is_alone = contact.fields().bodies() == 1 && attraction.is_none() && !state.held.region.is_shared();
        let is_new = start == 0.0 || state.is_undisturbed();
        let kind = (settings.adaptive_interpolant(), start);
        let new = || FieldsByLevels::new(contact, &course, accuracy, kind, cancelled);
        let beside = (is_alone && is_new).then(new).transpose();
        if let Some(beside) = none_if_not_covered(beside)?.flatten() {
            *self = InSpace::FieldsByLevels(Mutex::new(Box::new(beside)));
            return Ok(Prepared { stops: Vec::new(), tolerance: f64::INFINITY });
        }
        count_within("fields for which steps end", times.len(), times.len() <= MOST_FIELDS, "10 000 at most")?;
        let mut stops = Vec::new();
        for &time in times {
            let (mut since, mut corner) = (start, history.next_breakpoint(start));
            while let Some(next) = corner.filter(|next| *next > since && *next < time) {
                (since, corner) = (next, history.next_breakpoint(next));
            }
            let (count, ratio) = GRADED;
            let graded = (1..=count).map(|j| time - (time - since) * ratio.powi(j));
            stops.extend(graded.chain([time]));
        }
        *self = InSpace::Refined(Box::new(Refined::new(contact, times, is_adaptive, accuracy)));
        Ok(Prepared { stops, tolerance: accuracy })
    }

    fn follow(&mut self, contact: &ViscoelasticContact, history: &dyn LoadHistory, start: f64) {
        if let InSpace::Refined(refined) = self {
            refined.follow(contact, history, start);
        }
    }

    fn exact_field(
        &self,
        contact: &ViscoelasticContact,
        history: &dyn LoadHistory,
        after: bool,
        cancelled: Option<&Arc<AtomicBool>>,
    ) -> Result<(Option<Exact<ViscoelasticContact>>, FieldReport)> {
        let mut report = FieldReport::default();
        let beside = match self {
            InSpace::Unknown => return Ok((None, report)),
            InSpace::Refined(refined) => {
                let (fields, error) = refined.fields(contact, history, cancelled.map(|flag| &**flag))?;
                report.error = error;
                return Ok((fields.map(|fields| Exact::Fields(Box::new(fields))), report));
            }
            InSpace::FieldsByLevels(beside) => beside,
        };
        let mut beside = beside.lock().unwrap_or_else(PoisonError::into_inner);
        beside.curve.contacts.cancelled = cancelled.cloned();
        let Some(found) = none_if_not_covered(beside.pressure(history, contact.time(), after).map(Some))? else {
            return Ok((None, report));
        };
        [report.elastic_contacts, report.convolutions] = found.spent;
        let exact = contact.fields().keep().with_pressure(&found.pressure);
        report.error = Some(found.error).filter(|error| exact.is_some() && error.is_finite());
        Ok((exact.map(|fields| Exact::Fields(Box::new(fields))), report))
    }
}

/// A run on states in fine steps.
#[derive(Debug, Default)]
struct OnStates(Option<Mutex<GradedRun>>);

impl FieldFinder<StatesContact> for OnStates {
    fn prepare(&mut self, contact: &StatesContact, request: &FieldRequest<'_>) -> Result<Prepared> {
        let FieldRequest { history, accuracy, until, .. } = *request;
        let by_force = sampled(history, [contact.time(), until])?.iter().all(Load::is_force);
        let (repeated, _) = GradedRun::new(contact.clone(), history, until, (by_force, accuracy))?;
        self.0 = Some(Mutex::new(repeated));
        Ok(Prepared { stops: Vec::new(), tolerance: f64::INFINITY })
    }

    fn exact_field(
        &self,
        contact: &StatesContact,
        history: &dyn LoadHistory,
        after: bool,
        _: Option<&Arc<AtomicBool>>,
    ) -> Result<(Option<Exact<StatesContact>>, FieldReport)> {
        let Some(run) = &self.0 else { return Ok((None, FieldReport::default())) };
        let mut run = run.lock().unwrap_or_else(PoisonError::into_inner);
        let accuracy = run.accuracy;
        let (found, error) = run.in_short_steps(history, (contact.time(), after), accuracy)?;
        Ok((
            Some(Exact::Contact(Box::new(found.contact))),
            FieldReport { error: Some(error).filter(|error| error.is_finite()), ..FieldReport::default() },
        ))
    }
}
