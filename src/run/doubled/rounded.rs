//! A load history without the loads that are lost in the rounding of a run.

use crate::error::UserError;
use crate::load::{Load, LoadHistory};

/// A history in which the bodies just touch where a load is positive, but below `least`: levels are
/// powers of loads, and those of a pulse that begins at 1e-250 of its maximum underflow.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WithoutRounding<'a> {
    pub(crate) history: &'a dyn LoadHistory,
    /// Approach at which the undisturbed bodies touch.
    pub(crate) rest: f64,
    pub(crate) least: f64,
}

impl WithoutRounding<'_> {
    pub(crate) fn round(&self, mut load: Load) -> Load {
        let (value, touch) = match &mut load {
            Load::Force { normal, .. } => (normal, 0.0),
            Load::Approach { approach: value, .. } | Load::Spring { drive: value, .. } => (value, self.rest),
        };
        if *value > touch && *value - touch < self.least {
            *value = touch;
        }
        load
    }
}

impl LoadHistory for WithoutRounding<'_> {
    fn at(&self, t: f64) -> Load {
        self.round(self.history.at(t))
    }

    fn before(&self, t: f64) -> Load {
        self.round(self.history.before(t))
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        self.history.next_breakpoint(after)
    }

    fn failure(&self) -> Option<UserError> {
        self.history.failure()
    }
}
