//! Where and how often a run is saved.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::contact::StepReport;

/// Where and how often a run is saved, and the time of the last save.
#[derive(Debug)]
pub(super) struct Autosave {
    pub(super) path: PathBuf,
    pub(super) every: Duration,
    pub(super) last: Instant,
    /// Report of a step after which the file could not be written; `None` in it of the end of the run.
    pub(super) unreported: Option<Option<StepReport>>,
}
