//! The contact problem of one step, and two ways to solve it.

mod active_set;
mod cold_start;
mod passes;
mod polonsky_keer;
mod preconditioner;
mod problem;
mod rest;
mod rigid;
mod stiffness;
mod trace;

pub(crate) use active_set::ActiveSet;
pub(crate) use polonsky_keer::PolonskyKeer;
pub(crate) use problem::{Counts, Outcome, Problem, Solution, Stop};
pub(crate) use rigid::{Freedom, Modes};
pub(crate) use stiffness::{FLAT_PUNCH_TOLERANCE, flat_punch};
