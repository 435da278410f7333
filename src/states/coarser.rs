//! A run beside another one in steps twice as long, whose difference tells the error of a field where levels do not.

use crate::contact::ViscoelasticContact;
use crate::equilibrium::Ground;
use crate::error::Result;
use crate::hereditary::{Interpolant, StepContext};
use crate::load::LoadHistory;
use crate::states::repeated::LEAST_FORCE;

/// Order of the error of a pressure in the length of all steps.
const ORDER: f64 = 1.5;

#[derive(Debug)]
pub(super) struct Coarser {
    /// `None` once a step has failed.
    contact: Option<Box<ViscoelasticContact>>,
    interpolant: Interpolant,
    /// Times at which both runs end a step.
    times: Vec<f64>,
    /// Whether the run takes its steps in two halves: then this one takes the same steps as a whole.
    in_halves: bool,
    /// The greatest force of the run so far.
    force: f64,
}

impl Coarser {
    /// For a run that begins with this contact.
    pub(super) fn new(contact: &ViscoelasticContact, times: &[f64], is_adaptive: bool) -> Coarser {
        let Ground { settings, attraction, .. } = &contact.scene.ground;
        let interpolant = if is_adaptive { settings.adaptive_interpolant() } else { settings.interpolant() };
        let (in_halves, contact) = (is_adaptive && attraction.is_some(), Some(Box::new(contact.clone())));
        Coarser { contact, interpolant, times: times.to_vec(), in_halves, force: 0.0 }
    }

    /// Takes the step of the run from `start` on, together with the one before, unless that ended at a corner, a jump
    /// or a field.
    pub(super) fn follow(&mut self, run: &ViscoelasticContact, history: &dyn LoadHistory, start: f64) {
        self.force = self.force.max(run.force());
        let Some(contact) = &mut self.contact else { return };
        let time = run.time();
        let (is_second, jumps) = (contact.time() < start, time == start);
        let is_corner = history.next_breakpoint(start).is_some_and(|corner| corner <= time);
        if !(is_second || jumps || is_corner || self.in_halves || self.times.contains(&time)) {
            return;
        }
        let mut take = || -> Result<()> {
            let loads = [run.load()];
            let mut step = contact.request(time, time - contact.time(), &loads, contact.settings().tolerance)?;
            step.interval.interpolant = self.interpolant;
            contact.take_expecting(step, &StepContext::default())?;
            Ok(())
        };
        if take().is_err() {
            self.contact = None;
        } else if is_corner {
            contact.computation.state.history.reset_differences();
        }
    }

    /// The error of the pressure of the run, where both have ended a step and something has pressed.
    pub(super) fn error_of(&self, run: &ViscoelasticContact) -> Option<f64> {
        let contact = self.contact.as_ref().filter(|contact| contact.time() == run.time())?;
        let [off, sum] = run.fields().pressure_beside(contact.fields()).map(|sum| sum * run.grid().cell_area());
        let size = sum.max(LEAST_FORCE * self.force);
        (size > 0.0).then(|| off / size / (2f64.powf(ORDER) - 1.0))
    }
}
