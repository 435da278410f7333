//! The trait by which a run advances a contact of any kind: in space [`StepControl`](super::step_control::StepControl),
//! else [`Doubled`](super::doubled::Doubled).

use std::fmt::Debug;
#[cfg(feature = "checkpoint")]
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::contact::StepReport;
use crate::error::Result;
use crate::fields::KeptFields;
use crate::load::Load;
use crate::run::error_budget::ErrorBudget;
use crate::run::histories::Histories;
#[cfg(feature = "checkpoint")]
use crate::run::progress::Progress;

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

/// What has a field to an accuracy.
#[derive(Debug, Clone)]
pub enum Exact<C> {
    /// The fields themselves.
    Fields(Box<KeptFields>),
    /// A contact to show in the place of the run's own.
    Contact(Box<C>),
}

/// How exact the pressure of a [`Sample`](crate::run::Sample) is, and what it took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct FieldReport {
    /// Estimated error in time of the pressure, Σ |δp| over Σ p; over a hundredth of the maximum force so far, if
    /// that is more. `None` while bodies may be about to touch for the first time, or nothing has pressed, and where
    /// a step for the estimate failed.
    pub error: Option<f64>,
    /// Number of elastic contacts that were solved for it, with those for the whole run before its first field.
    pub elastic_contacts: usize,
    /// Convolutions that these took.
    pub convolutions: usize,
}

/// Number of shorter attempts after the solver has failed to converge.
pub(crate) const MOST_UNSOLVED: u32 = 5;

/// The control of the steps of a contact, with what the run has found so far. It is public for bounds only: this
/// module is private.
pub trait Control<C>: Debug + Send + Sync {
    /// Whether these loads act; false if it is not known.
    fn loads_act(&self, contact: &C, loads: &[Load]) -> bool;

    /// Takes the next step. Differences of steps start anew where it ends at a corner.
    fn advance(&mut self, contact: &mut C, course: &Course<'_>) -> Result<StepReport>;

    /// The contact at a time within the last step, under the loads of the histories, and the report of the step to
    /// that time.
    fn within(&self, contact: &C, histories: &Histories<'_>, time: f64) -> Result<(C, StepReport)>;

    /// Lowers the tolerance of the adaptive steps.
    fn tighten(&mut self, _tolerance: f64) {}

    /// Number of adaptive steps rejected for their error.
    fn rejected(&self) -> u64;

    /// The maximum errors so far.
    fn worst(&self) -> ErrorBudget;

    /// The times at which the load of each body bends, as far as the run was looked at before.
    fn bends(&self) -> Vec<&[f64]>;

    /// A clone.
    fn boxed(&self) -> Box<dyn Control<C>>;

    /// Saves the contact with a run that continues from there.
    #[cfg(feature = "checkpoint")]
    fn save_run(&self, contact: &C, progress: &Progress, path: &Path) -> Result<()>;

    /// Whether a save is due on any rank: clocks differ.
    #[cfg(feature = "checkpoint")]
    fn is_due(&self, _: &C, due: bool) -> Result<bool> {
        Ok(due)
    }
}

impl<C> Clone for Box<dyn Control<C>> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}
