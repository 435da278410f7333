//! Progress within the search for a state, and its end by the caller.

use std::cell::Cell;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};

use super::SteadySliding;

/// How far the search for a state has come, for [`SteadySliding::watched_by`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SlidingProgress {
    /// Sets of cells that were tried so far, on all meshes.
    pub sets: usize,
    /// Iterations on these sets: two pairs of transforms each.
    pub iterations: usize,
    /// The residual of the last of these sets, over the range of the gap that the contact closes; infinite before the first one.
    pub residual: f64,
}

/// The caller's function, if there is one.
#[derive(Clone, Default)]
pub(super) struct Watcher(Option<Arc<Mutex<Call>>>);

type Call = dyn FnMut(&SlidingProgress) -> ControlFlow<()> + Send;

impl fmt::Debug for Watcher {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "watched" } else { "unwatched" })
    }
}

/// The watch over one search.
pub(super) struct Watch {
    watcher: Watcher,
    progress: Cell<SlidingProgress>,
    ended: Cell<bool>,
}

impl Watch {
    pub(super) fn new(watcher: &Watcher) -> Watch {
        let progress = SlidingProgress { sets: 0, iterations: 0, residual: f64::INFINITY };
        Watch { watcher: watcher.clone(), progress: Cell::new(progress), ended: Cell::new(false) }
    }

    /// Whether the watcher has ended the search.
    pub(super) fn has_ended(&self) -> bool {
        self.ended.get()
    }

    /// Asks the watcher before an iteration. Returns whether it lets the search continue.
    pub(super) fn goes_on(&self) -> bool {
        let progress = self.progress.get();
        let call = |call: &Arc<Mutex<Call>>| call.lock().unwrap_or_else(PoisonError::into_inner)(&progress);
        let ends = self.watcher.0.as_ref().is_some_and(|own| call(own).is_break());
        self.ended.set(self.ended.get() || ends);
        self.progress.set(SlidingProgress { iterations: progress.iterations + 1, ..progress });
        !self.ended.get()
    }

    /// After a set of cells was tried.
    pub(super) fn tried(&self, residual: f64) {
        let progress = self.progress.get();
        self.progress.set(SlidingProgress { sets: progress.sets + 1, residual, ..progress });
    }
}

impl SteadySliding {
    /// Calls `watcher` before each iteration within [`SteadySliding::at`], and within the states of a sweep, on any of its threads. Where it breaks the search ends in
    /// [`Error::Cancelled`](crate::Error::Cancelled), and the state found last is kept: another thread may ask for it by a flag.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use std::sync::Arc;
    /// use std::sync::atomic::{AtomicBool, Ordering};
    ///
    /// use viscocontact::prelude::*;
    ///
    /// let cancelled = Arc::new(AtomicBool::new(false));
    /// let flag = Arc::clone(&cancelled);
    /// let mut sliding = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 0.01)?))
    ///     .build_sliding()?
    ///     .watched_by(move |_| if flag.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) });
    /// sliding.at([0.1, 0.0], Load::force(0.5))?;
    /// cancelled.store(true, Ordering::Relaxed); // by another thread
    /// assert!(matches!(sliding.at([0.2, 0.0], Load::force(0.5)), Err(Error::Cancelled { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    #[must_use]
    pub fn watched_by(
        mut self,
        watcher: impl FnMut(&SlidingProgress) -> ControlFlow<()> + Send + 'static,
    ) -> SteadySliding {
        self.watcher = Watcher(Some(Arc::new(Mutex::new(watcher))));
        self
    }
}
