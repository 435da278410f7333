//! The request for a step.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::equilibrium::{Indenter, Request};
use crate::hereditary::Interval;
use crate::load::Load;
use crate::solver::Solution;

/// A step to be tried.
#[derive(Debug, Clone)]
pub(crate) struct Step<'a> {
    pub(crate) interval: Interval,
    /// The load of each body at its end.
    pub(crate) loads: &'a [Load],
    /// The indenter at its end.
    pub(crate) indenter: Arc<Indenter>,
    /// Tolerance of the solver.
    pub(crate) tolerance: f64,
    /// The end of a step of surfaces that attract each other, where it is known: nothing is solved.
    pub(crate) end: Option<&'a Solution>,
    /// Set by another thread to end the step.
    pub(crate) cancelled: Option<&'a AtomicBool>,
}

impl Step<'_> {
    /// The contact problem at its end.
    pub(crate) fn request(&self) -> Request<'_> {
        let Step { interval: Interval { time, length, .. }, loads, ref indenter, tolerance, cancelled, .. } = *self;
        Request { time, length, loads, indenter, tolerance, cancelled }
    }
}
