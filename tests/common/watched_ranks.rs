//! Ranks whose calls are watched: counted, or made to fail.

use std::fmt;
use std::sync::Arc;

use viscocontact::parallel::{Ranks, RanksError};

/// What is asked of a rank.
pub enum Call {
    Gather,
    /// So many numbers are sent to other ranks.
    Exchange(usize),
}

/// Calls `watch` before each call, which returns the error of `watch`.
pub struct WatchedRanks<F> {
    inner: Arc<dyn Ranks>,
    watch: F,
}

impl<F: Fn(Call) -> Result<(), RanksError> + Send + Sync + 'static> WatchedRanks<F> {
    pub fn around(inner: Arc<dyn Ranks>, watch: F) -> Arc<dyn Ranks> {
        Arc::new(WatchedRanks { inner, watch })
    }
}

impl<F> fmt::Debug for WatchedRanks<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("WatchedRanks").field(&self.inner).finish()
    }
}

impl<F: Fn(Call) -> Result<(), RanksError> + Send + Sync> Ranks for WatchedRanks<F> {
    fn rank(&self) -> usize {
        self.inner.rank()
    }

    fn size(&self) -> usize {
        self.inner.size()
    }

    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) -> Result<(), RanksError> {
        (self.watch)(Call::Gather)?;
        self.inner.gather(own, counts, all)
    }

    fn exchange(
        &self,
        send: &[f64],
        send_counts: &[usize],
        received: &mut [f64],
        receive_counts: &[usize],
    ) -> Result<(), RanksError> {
        (self.watch)(Call::Exchange(send_counts.iter().sum::<usize>() - send_counts[self.rank()]))?;
        self.inner.exchange(send, send_counts, received, receive_counts)
    }
}
