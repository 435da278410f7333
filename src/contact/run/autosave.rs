//! Where a run is saved, and when it is time to.

use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Where a run is saved, how often, and when it was last.
#[derive(Debug)]
pub(in crate::contact) struct Autosave {
    pub(in crate::contact) path: PathBuf,
    every: Duration,
    last: Instant,
}

impl Autosave {
    pub(in crate::contact) fn new(path: PathBuf, every: Duration) -> Autosave {
        Autosave { path, every, last: Instant::now() }
    }

    pub(in crate::contact) fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every
    }

    pub(in crate::contact) fn done(&mut self) {
        self.last = Instant::now();
    }
}
