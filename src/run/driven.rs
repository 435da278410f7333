//! What a run asks of its contact.

use std::fmt::Debug;
#[cfg(feature = "checkpoint")]
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::contact::{Contact, StepReport};
use crate::error::Result;
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use crate::run::histories::Histories;
use crate::run::progress::{Progress, Stepping};

/// What a run prescribes of its next step.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    pub histories: &'a Histories<'a>,
    /// End and loads of a given step, a jump if it takes no time; none of a step as long as its error allows.
    pub given: Option<(f64, &'a [Load])>,
    /// End of the run.
    pub until: f64,
    /// The next time at which a step has to end.
    pub stop: f64,
    /// The next corner of load or temperature.
    pub corner: f64,
    /// The next time at which the displacement may have a kink: a corner, except one of the temperature that does not
    /// jump.
    pub kink: f64,
    /// Set by another thread to end the step.
    pub cancelled: Option<&'a AtomicBool>,
}

/// Fields that a run is asked for.
#[derive(Debug, Clone, Copy)]
pub struct FieldRequest<'a> {
    pub history: &'a dyn LoadHistory,
    pub accuracy: f64,
    /// Start and end of the run.
    pub start: f64,
    pub until: f64,
    /// Times at which fields are asked for.
    pub times: &'a [f64],
    /// Whether the run chooses its steps by their error.
    pub is_adaptive: bool,
}

/// Times at which steps end for fields, and the tolerance of adaptive steps.
#[derive(Debug)]
pub struct Prepared {
    pub stops: Vec<f64>,
    pub tolerance: f64,
}

/// Finds fields to an accuracy.
pub trait FieldFinder<C: Driven>: Debug + Send + Sync {
    /// Looks at the run before its first step.
    fn prepare(&mut self, contact: &C, request: &FieldRequest<'_>) -> Result<Prepared>;

    /// Sees a step of the run, from `start` to the time of its contact.
    fn follow(&mut self, _: &C, _: &dyn LoadHistory, _start: f64) {}

    /// What has the field of a contact of the last step to the accuracy, where the contact has not; before a jump of
    /// the load at its time, or after it.
    fn exact_field(
        &self,
        contact: &C,
        history: &dyn LoadHistory,
        after: bool,
    ) -> Result<(Option<C::Exact>, FieldReport)>;
}

/// How exact the pressure of a [`Sample`](crate::run::Sample) is, and what it took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct FieldReport {
    /// Estimated error in time of the pressure, Σ |δp| over Σ p; over a hundredth of the greatest force so far, if
    /// that is more. `None` while bodies may be about to touch for the first time, or nothing has pressed, and where
    /// a step for the estimate failed.
    pub error: Option<f64>,
    /// Number of elastic contacts that were solved for it, with those for the whole run before its first field.
    pub elastic_contacts: usize,
    /// Convolutions that these took.
    pub convolutions: usize,
}

/// A contact that runs drive. It is public for bounds only: this module is private.
pub trait Driven: Contact + Debug {
    /// The control of the steps, and what the run has found so far.
    type Control: Debug + Clone;
    /// What has fields to an accuracy.
    type Exact: Debug + Clone;

    /// The contact to show in the place of the run's own.
    fn instead(_: &Self::Exact) -> Option<&Self> {
        None
    }

    /// Progress and control of a run that begins here, or that continues from this saved contact.
    fn begin(&mut self, stepping: Stepping, until: f64) -> (Progress, Self::Control);

    /// Whether these loads act; false if it is not known.
    fn bears(&self, control: &Self::Control, loads: &[Load]) -> bool;

    fn temperature(&self) -> Option<&TemperatureHistory>;

    /// The approach at which the upright bodies touch \[m\], if they never have.
    fn untouched(&self) -> Option<f64>;

    /// Fails if the material of bodies that touch is not known until the end of a run.
    fn is_known_until(&self, end: f64) -> Result<()>;

    /// Takes the next step. Differences of steps start anew where it ends at a corner.
    fn advance(&mut self, control: &mut Self::Control, course: &Course<'_>) -> Result<StepReport>;

    /// The contact at a time within the last step, under the loads of the histories, and the report of the step to
    /// that time.
    fn within(&self, control: &Self::Control, histories: &Histories<'_>, time: f64) -> Result<(Self, StepReport)>;

    /// Lowers the tolerance of the adaptive steps.
    fn tighten(control: &mut Self::Control, tolerance: f64);

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
