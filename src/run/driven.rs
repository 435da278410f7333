//! What a run asks of its contact.

use std::fmt::Debug;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contact::{Contact, StepReport};
use crate::error::Result;
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use crate::run::progress::{Progress, Stepping};
#[cfg(feature = "checkpoint")]
use crate::run::{Run, RunContact};

/// What a run prescribes of its next step.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    pub history: &'a dyn LoadHistory,
    pub next: Next,
    /// End of the run.
    pub until: f64,
    /// The next time at which a step has to end.
    pub stop: f64,
    /// The next corner of load or temperature.
    pub corner: f64,
    /// The next time at which the displacement may have a kink: a corner, except one of the temperature that does not jump.
    pub kink: f64,
    /// Set by another thread to end the step.
    pub cancelled: Option<&'a AtomicBool>,
}

/// The next step of a run.
#[derive(Debug, Clone, Copy)]
pub enum Next {
    /// A step of given end and load; a jump if it takes no time.
    Given { time: f64, load: Load },
    /// A step as long as its error allows.
    Adaptive { tolerance: f64 },
}

/// A contact that runs drive. It is public for bounds only: this module is private.
pub trait Driven: Contact + Debug {
    /// The control of the steps, and what the run has found so far.
    type Control: Debug + Clone;

    /// The control of a run to the time `until`.
    fn control(&self, stepping: Stepping, until: f64) -> Self::Control;

    /// The progress of the run that saved this contact.
    fn saved_progress(&mut self) -> Option<Arc<Progress<Self::Control>>> {
        None
    }

    /// The load that acts; `None` if it is not known.
    fn load(&self, control: &Self::Control) -> Option<Load>;

    fn temperature(&self) -> Option<&TemperatureHistory>;

    /// The approach at which the upright bodies touch \[m\], if they never have.
    fn untouched(&self) -> Option<f64>;

    /// Takes the next step. Differences of steps start anew where it ends at a corner.
    fn advance(&mut self, control: &mut Self::Control, course: &Course<'_>) -> Result<StepReport>;

    /// The contact at a time within the last step, under the load of the history, and the report of the step to that time.
    fn within(&self, control: &Self::Control, history: &dyn LoadHistory, time: f64) -> Result<(Self, StepReport)>;

    /// Number of adaptive steps rejected for their error.
    fn rejected(control: &Self::Control) -> u64;

    /// Saves a run if that is due, or the run is `over`.
    #[cfg(feature = "checkpoint")]
    fn autosave(_run: &mut Run<'_, Self>, _over: bool) -> Result<()>
    where
        Self: RunContact,
    {
        Ok(())
    }
}
