//! Runs along a load history.

pub(in crate::contact) mod follow;
pub(in crate::contact) mod progress;
mod step_control;
pub(in crate::contact) mod stepping;
