//! Samples of a run: the contact at any time within its last step.

use std::borrow::Cow;

use crate::contact::{StepReport, ViscoelasticContact};
use crate::error::Result;
use crate::fields::{Fields, KeptFields};
use crate::run::Contact;
use crate::run::control::{Exact, FieldReport};
use crate::run::follow::Run;
use crate::run::progress::rounding;

/// A state of a run between the ends of a step, or at its end, from [`Run::samples`].
#[derive(Debug)]
pub struct Sample<'a, C: Contact = ViscoelasticContact> {
    contact: Cow<'a, C>,
    report: StepReport,
    is_asked_for: bool,
    exact: Option<Exact<C>>,
    field: Option<FieldReport>,
}

impl Sample<'_> {
    /// The fields at this time: to the accuracy that was asked for ([`Run::fields_to`]), else those of the contact.
    pub fn fields(&self) -> Fields<'_> {
        self.in_space().unwrap_or_else(|| self.contact.fields())
    }
}

impl<C: Contact> Sample<'_, C> {
    /// The contact at this time. In space its pressure is that of the steps: [`Sample::fields`] may have a more
    /// accurate one. On elastic states it is one of steps as fine as the fields need that were asked for.
    pub fn contact(&self) -> &C {
        if let Some(Exact::Contact(contact)) = &self.exact { contact } else { &self.contact }
    }

    /// The fields at this time of a contact in space, as [`Sample::fields`]; `None` of others.
    pub fn in_space(&self) -> Option<Fields<'_>> {
        if let Some(Exact::Fields(fields)) = &self.exact { Some(fields.fields()) } else { self.contact().in_space() }
    }

    /// The report of the step from the start of the run's step to this time, with the work that the sample took; its
    /// [`StepReport::time_error`] is the error of the whole step. At the end of the step, where a sample takes no work,
    /// it is the report of the step.
    pub fn report(&self) -> &StepReport {
        &self.report
    }

    /// How exact its pressure is, if fields were asked for ([`Run::fields_to`]).
    pub fn field(&self) -> Option<FieldReport> {
        self.field
    }

    /// Whether a time to sample was given here; false for an end of a step between such times.
    pub fn is_asked_for(&self) -> bool {
        self.is_asked_for
    }
}

impl<C: Contact> Run<'_, C> {
    /// The states of the last step, in the order of time: at each time to sample within it ([`Run::sample_at`]), and
    /// at its end; of the first step of a run that does not begin with a jump of its load at its start, too. Times
    /// that agree but for rounding are one. Each is as accurate as the end of the step ([`Run::within_step`]). So a run
    /// of few long steps is drawn as a curve, and the steps stay as they are.
    ///
    /// A sample inside the step costs a copy of the contact and a contact problem; the end costs nothing. Where ranks
    /// share out the contact, all of them take the samples.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Zener::relaxing(1.0e6, 0.3e6, 0.5)?))
    ///     .build()?;
    /// let load = StepLoad::new(Load::force(0.5))?;
    /// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-2), 100.0).sample_at(Times::decades(1.0e-2, 10))?;
    /// let (mut steps, mut curve) = (0, Vec::new());
    /// while run.next_step()?.is_some() {
    ///     steps += 1;
    ///     for sample in run.samples() {
    ///         let sample = sample?;
    ///         curve.push((sample.contact().time(), sample.contact().approach()));
    ///     }
    /// }
    /// assert!(steps < 20 && curve.len() > 40);
    /// assert!(curve.is_sorted_by_key(|point| point.0));
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// Each sample as [`Run::within_step`].
    pub fn samples(&self) -> impl Iterator<Item = Result<Sample<'_, C>>> {
        let end = self.last.map_or(0.0, |(_, report)| report.time);
        let same = rounding(end);
        let (mut time, mut left) = (self.covered, self.last);
        std::iter::from_fn(move || {
            let (_, whole) = left?;
            let next = self.sampled.after(time).filter(|next| *next < end - same);
            let Some(next) = next else {
                left = None;
                // a step may be as short as times differ by rounding; a jump has a state of its own
                let before = (end - same).next_down();
                let before = if whole.dt == 0.0 { before } else { before.max(self.covered) };
                let is_asked_for = self.sampled.after(before).is_some_and(|next| next <= end + same);
                let (contact, jumps) = (self.contact(), whole.dt == 0.0);
                let found = if is_asked_for { self.exact_field(contact, jumps) } else { Ok((None, None)) };
                return Some(found.map(|(exact, field)| Sample {
                    contact: Cow::Borrowed(contact),
                    report: whole,
                    is_asked_for,
                    exact,
                    field,
                }));
            };
            // times of two rules that agree but for rounding are one
            time = next + rounding(next);
            Some(self.sample_within_step(next).and_then(|(contact, report)| {
                let report = StepReport { time_error: whole.time_error, ..report };
                let (exact, field) = self.exact_within_step(&contact, next)?;
                Ok(Sample { contact: Cow::Owned(contact), report, is_asked_for: true, exact, field })
            }))
        })
    }

    /// The contact at a time within the last step of the run, its ends included, under the load of the history at
    /// that time: as accurate as the steps of the run. See [`ViscoelasticContact::within_step`].
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0)?))
    ///     .build()?;
    /// let ramp = Ramp::new(Load::approach(0.0), Load::approach(20.0e-6), 1.0)?;
    /// let mut run = contact.follow(&ramp, Stepping::adaptive(1.0e-3), 100.0);
    /// let mut forces = Vec::new(); // at 25 times a decade, however long the steps are
    /// let mut times = (-50..=50).map(|k| 10f64.powf(0.04 * f64::from(k))).peekable();
    /// while let Some(report) = run.next_step()? {
    ///     while let Some(time) = times.next_if(|&time| time <= report.time) {
    ///         forces.push((time, run.within_step(time)?.force()));
    ///     }
    /// }
    /// assert_eq!(forces.len(), 101);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ViscoelasticContact::within_step`], or if the load of the history at that time is invalid.
    pub fn within_step(&self, time: f64) -> Result<C> {
        let contact = self.sample_within_step(time)?.0;
        let (exact, _) = self.exact_within_step(&contact, time)?;
        Ok(if let Some(Exact::Contact(exact)) = exact { *exact } else { contact })
    }

    pub(super) fn sample_within_step(&self, time: f64) -> Result<(C, StepReport)> {
        self.control.within(&self.contact, &self.histories, time)
    }
}

impl Run<'_> {
    /// The fields at a time within the last step of the run, its ends included: to the accuracy that was asked for
    /// ([`Run::fields_to`]), else those of [`Run::within_step`].
    ///
    /// # Errors
    /// As [`Run::within_step`].
    pub fn fields_within_step(&self, time: f64) -> Result<KeptFields> {
        let contact = self.sample_within_step(time)?.0;
        let (exact, _) = self.exact_within_step(&contact, time)?;
        Ok(if let Some(Exact::Fields(fields)) = exact { *fields } else { contact.fields().keep() })
    }
}
