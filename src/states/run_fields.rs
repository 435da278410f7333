//! Fields of runs to an accuracy.

use std::sync::{Mutex, PoisonError};

use crate::contact::{Scene, ViscoelasticContact};
use crate::equilibrium::Ground;
use crate::error::{Error, Result, StatesError, count_within};
use crate::fields::KeptFields;
use crate::load::{Load, LoadHistory};
use crate::run::Run;
use crate::run::driven::{FieldFinder, FieldReport, FieldRequest, Prepared};
use crate::run::field::MOST_FIELDS;
use crate::states::beside::Beside;
use crate::states::coarser::Coarser;
use crate::states::contact::StatesContact;
use crate::states::reach::Loading;
use crate::states::repeated::Repeated;
use crate::states::unless_refused;

/// An error of the force counts in a field as many times as the bodies creep under a given force, up to so much:
/// adaptive steps have this tolerance over the creep, as a part of the accuracy of the field.
const OF_CREEP: f64 = 1.5;
const MOST_CREEP: f64 = 15.0;
/// Number and ratio of the graded steps before a field where levels do not give it, and the share of the tolerance of
/// all steps.
const GRADED: (i32, f64, f64) = (12, 0.7, 1.0);
/// The same where an elastic contact shrinks as its load grows: parts of the surface open while others are pressed.
const GRADED_OF_SHRINKING: (i32, f64, f64) = (24, 0.84, 0.25);

/// How the fields of a run in space are found.
#[derive(Debug, Default)]
enum InSpace {
    /// The run has not begun.
    #[default]
    Unknown,
    /// From elastic contacts.
    Beside(Mutex<Box<Beside>>),
    /// By graded steps, whose error longer steps tell.
    Coarser(Coarser),
}

impl<'a> Run<'a> {
    /// Makes the pressure at the times to sample ([`Run::sample_at`]) exact to `accuracy`: the error in time is Σ
    /// |δp| over Σ p, or over a hundredth of the greatest force so far if that is more. 99 % of random fields of
    /// bodies that creep up to 100-fold are below the accuracy; up to 1000-fold the greatest error is 1.6 times as
    /// much. [`Stepping::adaptive`](crate::run::Stepping::adaptive) promises approach and force alone: cells that
    /// joined in the last long step have the pressure of one moment, which is off by 1 to 30 %.
    ///
    /// Where the contact is a superposition of its elastic states ([`states`](crate::states)) the steps stay as they
    /// are, bitwise. A few elastic contacts beside the run give the pressure of
    /// [`Sample::fields`](crate::run::Sample::fields) and [`Run::fields_within_step`] at any time: 6 for 1e-2 and 13
    /// for 1e-3 in the median, 13 and 44 for a tenth of the fields. Displacement and motions stay as in the run.
    ///
    /// Where load points or tilts change, where bodies are several, attract each other or are
    /// shared out by ranks, and where they were disturbed before the run begins, 12 steps graded by
    /// 0.7 end before each of the times, and [`Run::contact`] has the pressure there; 24 graded by
    /// 0.84, and a quarter of the tolerance of all steps, where an elastic contact shrinks as its
    /// load grows: there half of the fields of plates on foundations err by half of the accuracy,
    /// and one of 30 by more than twice, at most four times. Under a given force the tolerance of
    /// all steps is then the accuracy over two thirds of the creep, but a tenth at least. Of 612
    /// fields to 1e-3 in runs from disturbed bodies 13 err by more than the accuracy, at most by
    /// 3.4 times as much. The estimate is the difference to a run beside in steps twice as long:
    /// half as much work again, and the memory of a contact. There is none once a step of that run
    /// has failed.
    ///
    /// [`Sample::field`](crate::run::Sample::field) has the estimated error. Relative to the field the L2 error is about twice as large, and
    /// the error of the greatest pressure five times. At a jump of the load both the step that ends there and the
    /// jump have a sample: the field before it, and the field after it.
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
        let FieldRequest { history, accuracy, start, until, times, is_adaptive } = *request;
        let Scene { ground: Ground { settings, attraction, .. }, material, temperature, .. } = &*contact.scene;
        let course = Loading { material, temperature: temperature.as_ref(), history, until };
        let state = &contact.computation.state;
        let is_alone = contact.fields().bodies() == 1 && attraction.is_none() && !state.held.region.is_shared();
        let is_new = start == 0.0 || state.is_undisturbed();
        let kind = (settings.adaptive_interpolant(), start);
        let beside = (is_alone && is_new).then(|| Beside::new(contact, &course, accuracy, kind)).transpose();
        let shrinks = matches!(beside, Err(Error::States(StatesError::Shrinks { .. })));
        let (count, ratio, share) = if shrinks { GRADED_OF_SHRINKING } else { GRADED };
        if let Some(beside) = unless_refused(beside)?.flatten() {
            *self = InSpace::Beside(Mutex::new(Box::new(beside)));
            return Ok(Prepared { stops: Vec::new(), tolerance: f64::INFINITY });
        }
        count_within("fields for which steps end", times.len(), times.len() <= MOST_FIELDS, "10 000 at most")?;
        let mut stops = Vec::new();
        for &time in times {
            let (mut since, mut corner) = (start, history.next_breakpoint(start));
            while let Some(next) = corner.filter(|next| *next > since && *next < time) {
                (since, corner) = (next, history.next_breakpoint(next));
            }
            let graded = (1..=count).map(|j| time - (time - since) * ratio.powi(j));
            stops.extend(graded.chain([time]));
        }
        *self = InSpace::Coarser(Coarser::new(contact, times, is_adaptive));
        let tolerance = match history.checked_at(start, attraction.is_some())? {
            Load::Force { .. } => {
                let creep = course.softest_compliance()? / material.contact_compliance(0.0);
                OF_CREEP / creep.clamp(OF_CREEP, MOST_CREEP) * accuracy
            }
            _ => accuracy,
        };
        Ok(Prepared { stops, tolerance: share * tolerance })
    }

    fn follow(&mut self, contact: &ViscoelasticContact, history: &dyn LoadHistory, start: f64) {
        if let InSpace::Coarser(coarser) = self {
            coarser.follow(contact, history, start);
        }
    }

    fn exact_field(
        &self,
        contact: &ViscoelasticContact,
        history: &dyn LoadHistory,
        after: bool,
    ) -> Result<(Option<KeptFields>, FieldReport)> {
        let mut report = FieldReport::default();
        let beside = match self {
            InSpace::Unknown => return Ok((None, report)),
            InSpace::Coarser(coarser) => {
                report.error = coarser.error_of(contact);
                return Ok((None, report));
            }
            InSpace::Beside(beside) => beside,
        };
        let mut beside = beside.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(found) = unless_refused(beside.pressure(history, contact.time(), after).map(Some))? else {
            return Ok((None, report));
        };
        [report.elastic_contacts, report.convolutions] = found.spent;
        let exact = contact.fields().keep().with_pressure(&found.pressure);
        report.error = Some(found.error).filter(|error| exact.is_some() && error.is_finite());
        Ok((exact, report))
    }
}

/// A run on states in fine steps.
#[derive(Debug, Default)]
struct OnStates(Option<Repeated>);

impl FieldFinder<StatesContact> for OnStates {
    fn prepare(&mut self, contact: &StatesContact, request: &FieldRequest<'_>) -> Result<Prepared> {
        let FieldRequest { history, accuracy, until, .. } = *request;
        self.0 = Some(Repeated::new(contact.clone(), history, until, accuracy)?.0);
        Ok(Prepared { stops: Vec::new(), tolerance: f64::INFINITY })
    }

    fn exact_field(
        &self,
        contact: &StatesContact,
        history: &dyn LoadHistory,
        after: bool,
    ) -> Result<(Option<StatesContact>, FieldReport)> {
        let found = self.0.as_ref().map(|run| run.at(history, contact.time(), after)).transpose()?;
        Ok((found.map(|found| found.contact), FieldReport::default()))
    }
}
