//! What a run knows of its fields.

use std::collections::VecDeque;
use std::sync::Mutex;

/// Steps end for so many fields at most.
pub(super) const MOST_FIELDS: usize = 10_000;

/// The fields that a run is asked for.
#[derive(Debug)]
pub(super) struct RunFields<C, F> {
    pub(super) accuracy: f64,
    /// Once the run has begun.
    pub(super) found: Option<F>,
    /// Ends of the steps so far.
    pub(super) ends: Vec<f64>,
    pub(super) keeps_starts: bool,
    /// The greatest error of a field so far.
    pub(super) worst: Mutex<Option<f64>>,
    /// Contacts at the starts of the last steps.
    pub(super) starts: VecDeque<C>,
}
