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
    /// What the next call returns, since the save after this step failed: `Some(None)` if the run was over.
    pub(super) unreported: Option<Option<StepReport>>,
}
