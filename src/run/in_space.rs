//! Runs of a contact in space.

#[cfg(feature = "checkpoint")]
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use crate::contact::{Scene, Step, StepReport, ViscoelasticContact};
use crate::error::{Error, Result, count_within};
use crate::hereditary::{StepContext, TimeError};
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use crate::run::Run;
use crate::run::adaptive_step::adaptive_step;
use crate::run::driven::{Course, Driven, FieldReport, FieldRequest, Moment, Prepared};
use crate::run::error_budget::ErrorBudget;
use crate::run::field::MOST_FIELDS;
use crate::run::halves::Halves;
use crate::run::progress::{Progress, Stepping};
use crate::run::step_control::StepControl;
use crate::states::{self, Beside};

/// The run errs by this part of the accuracy of the fields where its error is amplified as many times.
const OF_AMPLIFIED: f64 = 1.5;
/// Number and ratio of the graded steps before a field where nothing better is known.
const GRADED: i32 = 12;
const RATIO: f64 = 0.7;

/// How the fields of a run in space are found.
#[derive(Debug)]
pub enum FieldsInSpace {
    /// From elastic contacts; or by steps, whose error is known, where these shrink.
    Beside(Mutex<Box<Beside>>),
    /// By graded steps.
    Graded,
}

impl Driven for ViscoelasticContact {
    type Control = StepControl;

    fn begin(&mut self, stepping: Stepping, until: f64) -> (Progress, StepControl) {
        let saved = self.saved_run.take().and_then(|saved| saved.downcast::<(Progress, StepControl)>().ok());
        match saved.filter(|saved| saved.0.continues(self.time(), stepping, until)) {
            Some(saved) => (*saved).clone(),
            None => (Progress::begin(self.time(), stepping), StepControl::new(stepping)),
        }
    }

    fn load(&self, _: &StepControl) -> Option<Load> {
        Some(self.load())
    }

    fn temperature(&self) -> Option<&TemperatureHistory> {
        self.scene.temperature.as_ref()
    }

    fn untouched(&self) -> Option<f64> {
        let state = &self.computation.state;
        state.is_undisturbed().then(|| state.indenter.gap().datum)
    }

    fn advance(&mut self, control: &mut StepControl, course: &Course<'_>) -> Result<StepReport> {
        let rows = self.computation.state.region.rows();
        rows.together(|| {
            let (report, error) = match course.given {
                Some((time, load)) => self.given_step(control, course, time, load)?,
                None => adaptive_step(self, control, course)?,
            };
            control.include(&error, report.residual, self.mesh_error().unwrap_or_default());
            Ok(report)
        })
    }

    fn within(&self, control: &StepControl, history: &dyn LoadHistory, time: f64) -> Result<(Self, StepReport)> {
        let loads = |_: &_| Ok(vec![history.checked_at(time, self.scene.attraction.is_some())?]);
        let of_last = |halves: &&Halves| halves.middle == self.computation.state.start.clock.time;
        let before = control.halves.as_deref().filter(of_last).map(|halves| &halves.start);
        let (contact, reach) = self.advanced_within_step(time, control.solver_tolerance(&self.scene), before, loads)?;
        let report = contact.report(None, reach);
        Ok((contact, report))
    }

    type Fields = FieldsInSpace;

    fn fields(&self, control: &mut StepControl, request: &FieldRequest<'_>) -> Result<Prepared<FieldsInSpace>> {
        let FieldRequest { history, accuracy, start, until, times } = *request;
        let Scene { material, temperature, settings, attraction, .. } = &*self.scene;
        let course = states::Course { material, temperature: temperature.as_ref(), history, until };
        let is_alone = self.bodies() == 1 && attraction.is_none() && !self.computation.state.region.is_shared();
        let is_new = start == 0.0 || self.computation.state.is_undisturbed();
        let kind = (settings.adaptive_interpolant(), start);
        let beside = (is_alone && is_new).then(|| Beside::new(self, &course, accuracy, kind)).transpose();
        if let Some(beside) = unless_refused(beside)?.flatten() {
            let (mut stops, mut finest) = (Vec::new(), 1.0_f64);
            let times = if beside.serves() { &[] } else { few(times)? };
            for &time in times {
                let (before, amplification) = beside.stops(history, time)?;
                finest = finest.min(OF_AMPLIFIED / amplification);
                stops.extend(before.into_iter().chain([time]));
            }
            if !beside.serves() {
                control.tolerance = control.tolerance.min(finest * accuracy);
            }
            let fields = FieldsInSpace::Beside(Mutex::new(Box::new(beside)));
            return Ok(Prepared { fields, stops, keeps_starts: false });
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
        control.tolerance = control.tolerance.min(accuracy);
        Ok(Prepared { fields: FieldsInSpace::Graded, stops, keeps_starts: true })
    }

    fn with_field(&self, fields: &FieldsInSpace, moment: &Moment<'_, Self>) -> Result<(Option<Self>, FieldReport)> {
        let Moment { history, after, ends, starts } = *moment;
        let mut report = FieldReport::default();
        let FieldsInSpace::Beside(beside) = fields else {
            report.error = match starts.front() {
                Some(start) if after || start.time() < self.time() => Some(self.error_by_halves(start, history, ends)?),
                _ => None,
            };
            return Ok((None, report));
        };
        let mut beside = beside.lock().unwrap_or_else(PoisonError::into_inner);
        if beside.serves() {
            match beside.pressure(history, self.time(), after) {
                Ok(found) => {
                    [report.elastic_contacts, report.convolutions] = found.spent;
                    if let Some(contact) = self.with_pressure(&found.pressure) {
                        report.error = Some(found.error);
                        return Ok((Some(contact), report));
                    }
                }
                Err(Error::States(_) | Error::Step(_)) => {}
                Err(error) => return Err(error),
            }
        }
        let error = beside.error_of_steps(history, ends, (self.time(), after));
        report.error = unless_refused(error.map(Some))?;
        Ok((None, report))
    }

    fn rejected(control: &StepControl) -> u64 {
        control.rejected
    }

    #[cfg(feature = "checkpoint")]
    fn save_run(&self, path: &Path, (progress, control): (&Progress, &StepControl)) -> Result<()> {
        self.save_with(path, Some(&(progress.clone(), control.clone())))
    }

    #[cfg(feature = "checkpoint")]
    fn is_due(&self, due: bool) -> Result<bool> {
        let rows = self.computation.state.region.rows();
        rows.together(|| Ok(rows.any(due)))
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

    fn given_step(
        &mut self,
        control: &mut StepControl,
        course: &Course<'_>,
        time: f64,
        load: Load,
    ) -> Result<(StepReport, TimeError)> {
        let dt = time - self.time();
        if dt == 0.0 {
            control.jump();
        }
        let (tolerance, loads) = (control.solver_tolerance(&self.scene), [load]);
        let step = Step { cancelled: course.cancelled, ..self.request(time, dt, &loads, tolerance)? };
        let state = &self.computation.state;
        control.look_ahead(&self.scene, state, course.history, course.until)?;
        let age = step.interval.reduced - state.clock.undisturbed_until;
        let expected = control.scale.expected(&self.scene, &load, age);
        let (report, error) = self.take_expecting(step, &StepContext { expected, ..StepContext::default() })?;
        if time == course.corner {
            self.computation.state.history.reset_differences();
        }
        Ok((report, error))
    }
}

impl Run<'_> {
    /// The errors of the run so far, by their source.
    pub fn error_budget(&self) -> ErrorBudget {
        let StepControl { worst, mesh, .. } = self.control;
        ErrorBudget {
            time: worst.map(|worst| worst.time),
            pressure: worst.map(|worst| worst.pressure),
            field: self.worst_field(),
            mesh: self.contact.mesh_error().unwrap_or_default(),
            max_mesh: mesh,
            solver: worst.map_or(0.0, |worst| worst.residual),
        }
    }
}
