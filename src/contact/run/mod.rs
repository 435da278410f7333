//! Runs along a load history.

mod adaptive_step;
mod drift;
pub(in crate::contact) mod error_budget;
pub(in crate::contact) mod follow;
mod held;
pub(in crate::contact) mod progress;
mod returns;
mod run_scale;
mod step_control;
pub(in crate::contact) mod stepping;
