//! What a run asks of its contact.

use std::fmt::Debug;
#[cfg(feature = "checkpoint")]
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::contact::{Contact, StepReport};
use crate::error::Result;
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use crate::run::progress::{Progress, Stepping};

/// What a run prescribes of its next step.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    pub history: &'a dyn LoadHistory,
    /// End and load of a given step, a jump if it takes no time; none of a step as long as its error allows.
    pub given: Option<(f64, Load)>,
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

/// A contact that runs drive. It is public for bounds only: this module is private.
pub trait Driven: Contact + Debug {
    /// The control of the steps, and what the run has found so far.
    type Control: Debug + Clone;

    /// Progress and control of a run that begins here, or that continues from this saved contact.
    fn begin(&mut self, stepping: Stepping, until: f64) -> (Progress, Self::Control);

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

    /// Saves the contact with a run that continues from there.
    #[cfg(feature = "checkpoint")]
    fn save_run(&self, path: &Path, run: (&Progress, &Self::Control)) -> Result<()>;

    /// Whether a save is due on any rank: clocks differ.
    #[cfg(feature = "checkpoint")]
    fn is_due(&self, due: bool) -> Result<bool> {
        Ok(due)
    }
}
