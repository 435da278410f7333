//! Runs of a contact in space.

#[cfg(feature = "checkpoint")]
use std::path::Path;

use crate::contact::{Step, StepReport, ViscoelasticContact};
use crate::error::Result;
use crate::fields::Fields;
use crate::hereditary::{Outlook, TimeError};
use crate::load::Load;
use crate::rheology::TemperatureHistory;
use crate::run::Contact;
use crate::run::adaptive_step::adaptive_step;
use crate::run::control::{Control, Course};
use crate::run::error_budget::ErrorBudget;
use crate::run::histories::Histories;
use crate::run::progress::{Progress, Stepping};
use crate::run::step_control::StepControl;
use crate::run::track::Track;

impl Contact for ViscoelasticContact {
    fn step_to(&mut self, time: f64, load: Load) -> Result<StepReport> {
        let dt = time - self.time();
        self.next(None, time, dt, &[load])
    }

    fn step(&mut self, dt: f64, load: Load) -> Result<StepReport> {
        ViscoelasticContact::step(self, dt, load)
    }

    fn time(&self) -> f64 {
        ViscoelasticContact::time(self)
    }

    fn force(&self) -> f64 {
        self.fields().force()
    }

    fn approach(&self) -> f64 {
        self.fields().approach()
    }

    fn tilt(&self) -> [f64; 2] {
        self.fields().tilt()
    }

    fn contact_area(&self) -> f64 {
        self.fields().contact_area()
    }

    fn is_separated(&self) -> bool {
        self.fields().is_separated()
    }

    fn in_space(&self) -> Option<Fields<'_>> {
        Some(self.fields())
    }

    fn attracts(&self) -> bool {
        self.scene.ground.attraction.is_some()
    }

    fn temperature(&self) -> Option<&TemperatureHistory> {
        self.scene.temperature.as_ref()
    }

    fn untouched(&self) -> Option<f64> {
        let state = &self.computation.state;
        state.is_undisturbed().then(|| state.held.indenter.gap().datum)
    }

    fn is_known_until(&self, end: f64) -> Result<()> {
        let clock = &self.computation.state.clock;
        // a temperature that the law does not cover ends the run when it is reached
        let Ok(reduced) = self.scene.reduced_time(clock, end) else { return Ok(()) };
        self.scene.limits.check_age(end, reduced - clock.undisturbed_until, true)
    }

    fn lead(&mut self, stepping: Stepping, until: f64) -> (Progress, Box<dyn Control<Self>>) {
        let saved = self.saved_run.take().and_then(|saved| saved.downcast::<(Progress, StepControl)>().ok());
        let continues = |(progress, control): &(Progress, StepControl)| {
            progress.continues(self.time(), stepping, until) && control.tracks.len() == self.fields().bodies()
        };
        let (progress, control) = match saved.filter(|saved| continues(saved)) {
            Some(saved) => (*saved).clone(),
            None => (Progress::begin(self.time(), stepping), StepControl::new(stepping, self.fields().bodies())),
        };
        (progress, Box::new(control))
    }
}

impl Control<ViscoelasticContact> for StepControl {
    fn loads_act(&self, contact: &ViscoelasticContact, loads: &[Load]) -> bool {
        contact.computation.state.held.loads == loads
    }

    fn advance(&mut self, contact: &mut ViscoelasticContact, course: &Course<'_>) -> Result<StepReport> {
        let rows = contact.computation.state.held.region.rows();
        rows.or_loss(|| {
            let (report, error) = match course.given {
                Some((time, loads)) => contact.given_step(self, course, time, loads)?,
                None => adaptive_step(contact, self, course)?,
            };
            self.include(&error, report.residual);
            Ok(report)
        })
    }

    fn within(
        &self,
        contact: &ViscoelasticContact,
        histories: &Histories<'_>,
        time: f64,
    ) -> Result<(ViscoelasticContact, StepReport)> {
        let attracts = contact.attracts();
        let loads = |_: &_| histories.each().map(|history| history.checked_at(time, attracts)).collect();
        let second = contact.computation.state.start.clock.time;
        let before = self.halves.as_deref().and_then(|halves| halves.start_of(second));
        let tolerance = self.solver_tolerance(&contact.scene);
        let (found, pressed) = contact.advanced_within_step(time, tolerance, before, loads)?;
        let report = found.report(None, pressed);
        Ok((found, report))
    }

    fn tighten(&mut self, tolerance: f64) {
        self.tolerance = self.tolerance.min(tolerance);
    }

    fn rejected(&self) -> u64 {
        self.rejected
    }

    fn worst(&self) -> ErrorBudget {
        self.worst
    }

    fn bends(&self) -> Vec<&[f64]> {
        self.tracks.iter().map(|track| &track.scale.bends[..]).collect()
    }

    fn boxed(&self) -> Box<dyn Control<ViscoelasticContact>> {
        Box::new(self.clone())
    }

    #[cfg(feature = "checkpoint")]
    fn save_run(&self, contact: &ViscoelasticContact, progress: &Progress, path: &Path) -> Result<()> {
        contact.save_with(path, Some(&(progress.clone(), self.clone())))
    }

    #[cfg(feature = "checkpoint")]
    fn is_due(&self, contact: &ViscoelasticContact, due: bool) -> Result<bool> {
        let rows = contact.computation.state.held.region.rows();
        rows.or_loss(|| Ok(rows.any(due)))
    }
}

impl ViscoelasticContact {
    fn given_step(
        &mut self,
        control: &mut StepControl,
        course: &Course<'_>,
        time: f64,
        loads: &[Load],
    ) -> Result<(StepReport, TimeError)> {
        let dt = time - self.time();
        if dt == 0.0 {
            control.anew(Track::jump);
        }
        let tolerance = control.solver_tolerance(&self.scene);
        let step = Step { cancelled: course.cancelled, ..self.request(time, dt, loads, tolerance)? };
        let state = &self.computation.state;
        control.look_ahead(&self.scene, state, course.histories, course.until)?;
        let (report, error) = self.take_expecting(step, &Outlook::default())?;
        if time == course.corner {
            self.computation.state.history.reset_differences();
        }
        Ok((report, error))
    }
}
