//! What a run of a contact on elastic states carries from step to step.

use crate::load::Load;
use crate::states::contact::StatesContact;
use crate::states::control::StepControl;

/// The control of the steps of a run, and the state at the start of the last one.
#[derive(Debug, Clone)]
pub struct StatesControl {
    /// The load that acts; unknown before the first step.
    pub(super) load: Option<Load>,
    pub(super) tolerance: f64,
    pub(super) before: StatesContact,
    pub(super) steps: StepControl,
    /// Whether the last step was taken in two halves.
    pub(super) halved: bool,
}
