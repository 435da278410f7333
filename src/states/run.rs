//! Runs of contacts on elastic states.

use std::sync::Arc;

use crate::contact::{Figures, StepReport, Warnings};
use crate::error::{Error, Result};
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use crate::run::control::Control;
use crate::run::doubled::{SavedRun, lead, report};
use crate::run::progress::Progress;
use crate::run::{Contact, Stepping};
use crate::solver::RigidMotion;
use crate::states::contact::StatesContact;
use crate::states::control::OnLevels;

/// Adaptive steps are taken whole and in two halves, and the halves are kept. The error of the step is the difference
/// of both, in depth and force and in what the surfaces can ever add to them.
impl Contact for StatesContact {
    fn step_to(&mut self, time: f64, load: Load) -> Result<StepReport> {
        self.saved_run = None;
        StatesContact::step_to(self, time, time - self.time(), load)
    }

    fn step(&mut self, dt: f64, load: Load) -> Result<StepReport> {
        StatesContact::step(self, dt, load)
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn force(&self) -> f64 {
        self.levels.force
    }

    fn approach(&self) -> f64 {
        let of_load_point = self.prescribed.unwrap_or(self.levels.motions.depth + self.states.rest.approach);
        of_load_point - RigidMotion { approach: 0.0, tilt: self.tilt() }.at(self.states.load_point())
    }

    fn tilt(&self) -> [f64; 2] {
        let (rest, turned) = (self.states.rest.tilt, self.levels.motions.tilt);
        [rest[0] + turned[0], rest[1] + turned[1]]
    }

    fn contact_area(&self) -> f64 {
        self.states.area(self.levels.level)
    }

    fn is_separated(&self) -> bool {
        self.levels.level == 0.0
    }

    fn neglect(&mut self, [least, ..]: [f64; 3]) {
        self.levels.shear.iter_mut().for_each(|shear| shear.least = least);
    }

    fn slides(&self) -> bool {
        self.level() > 0.0 && self.stick_level() == 0.0
    }

    fn report(&self, dt: f64, load: Load) -> StepReport {
        let limits = &self.scene.limits;
        let (mut warnings, figures) = self.states.outside(self.level(), self.depth());
        if self.groups() > 0 {
            let reduced = self
                .scene
                .temperature
                .as_ref()
                .and_then(|history| history.reduced_time(self.time - dt, self.time).ok());
            warnings |= limits.warnings(self.reduced_time - self.undisturbed_until, reduced.unwrap_or(dt));
        }
        warnings.set(Warnings::MODULUS, limits.modulus.is_some());
        StepReport {
            contact_cells: self.states.state_at(self.level()).map_or(0, |state| state.cells),
            warnings,
            figures: Figures { modulus: limits.modulus, ..figures },
            ..report(self, dt, load)
        }
    }

    fn columns(&self) -> Vec<(&'static str, f64)> {
        self.columns_along()
    }

    fn temperature(&self) -> Option<&TemperatureHistory> {
        self.scene.temperature.as_ref()
    }

    fn lateral(&self) -> &[Arc<dyn LoadHistory>] {
        self.lateral_history()
    }

    fn untouched(&self) -> Option<f64> {
        (self.groups() == 0).then(|| self.states().approach(0.0))
    }

    fn is_beyond(&self, error: &Error) -> bool {
        matches!(error, Error::Slides { .. })
    }

    fn is_known_until(&self, end: f64) -> Result<()> {
        let Ok((_, reduced)) = self.reduced(end, end - self.time()) else { return Ok(()) };
        self.scene.limits.check_age(end, reduced - self.undisturbed_until, true)
    }

    fn lead(&mut self, stepping: Stepping, until: f64) -> (Progress, Box<dyn Control<Self>>) {
        let saved = self.saved_run.take().and_then(|saved| saved.downcast::<SavedRun<OnLevels>>().ok());
        lead(self, saved.as_deref(), stepping, until)
    }
}
