//! Ranks whose calls are watched: counted, or made to fail.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

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

/// A rank with calls left to it: the others fail as if `lost` had left.
pub fn with_calls_left(inner: Arc<dyn Ranks>, lost: usize) -> (Arc<dyn Ranks>, Arc<AtomicUsize>) {
    let calls_left = Arc::new(AtomicUsize::new(usize::MAX));
    let left = Arc::clone(&calls_left);
    let watch = move |_| {
        let calls = left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
        calls.map(|_| ()).map_err(|_| RanksError::Left { rank: lost })
    };
    (WatchedRanks::around(inner, watch), calls_left)
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
