//! What a run knows of its fields.

use std::sync::Mutex;

use crate::run::control::FieldFinder;

/// Steps end for so many fields at most.
pub(crate) const MOST_FIELDS: usize = 10_000;

/// The fields that a run is asked for.
#[derive(Debug)]
pub(super) struct RunFields<C> {
    pub(super) accuracy: f64,
    pub(super) finder: Box<dyn FieldFinder<C>>,
    /// Whether the run has begun.
    pub(super) is_prepared: bool,
    /// The greatest error of a field so far.
    pub(super) worst: Mutex<Option<f64>>,
}
