//! Fields to an accuracy: what a run is asked for, and what finds them.

mod of_run;

use std::fmt::Debug;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use crate::error::Result;
use crate::load::LoadHistory;
use crate::run::control::{Exact, FieldReport};

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
    /// Set by another thread to end what is found before the first step.
    pub cancelled: Option<&'a Arc<AtomicBool>>,
}

/// Times at which steps end for fields, and the tolerance of adaptive steps.
#[derive(Debug)]
pub struct Prepared {
    pub stops: Vec<f64>,
    pub tolerance: f64,
}

/// Finds fields to an accuracy.
pub trait FieldFinder<C>: Debug + Send + Sync {
    /// Looks at the run before its first step.
    fn prepare(&mut self, contact: &C, request: &FieldRequest<'_>) -> Result<Prepared>;

    /// Sees a step of the run, from `start` to the time of its contact.
    fn follow(&mut self, _: &C, _: &dyn LoadHistory, _start: f64) {}

    /// What has the field of a contact of the last step to the accuracy, where the contact has not; before a jump of
    /// the load at its time, or after it. Ends where another thread sets `cancelled`.
    fn exact_field(
        &self,
        contact: &C,
        history: &dyn LoadHistory,
        after: bool,
        cancelled: Option<&Arc<AtomicBool>>,
    ) -> Result<(Option<Exact<C>>, FieldReport)>;
}

/// Steps end for so many fields at most.
pub(crate) const MOST_FIELDS: usize = 10_000;

/// The fields that a run is asked for.
#[derive(Debug)]
pub(super) struct RunFields<C> {
    pub(super) accuracy: f64,
    pub(super) finder: Box<dyn FieldFinder<C>>,
    /// Whether the run has begun.
    pub(super) is_prepared: bool,
    /// The maximum error of a field so far.
    pub(super) worst: Mutex<Option<f64>>,
}
