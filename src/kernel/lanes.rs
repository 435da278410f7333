//! Loops over fields: compiled for the vector units of the machine they run on, shared between threads.

use pulp::{Arch, Simd, WithSimd};

/// A piece of work that a thread does on its share of a field. Its `run` must be `#[inline(always)]`: only so is it
/// compiled for wider vectors than every machine has. Arithmetic and its order stay the same, bit by bit.
pub(crate) trait Task {
    /// What a thread needs of its own.
    type Lane;
    type Item;

    /// Does the `k`-th share.
    fn run(&self, k: usize, lane: &mut Self::Lane, share: &mut [Self::Item]);
}

/// Does `task` with every lane and its share of `data`, `length` values each: in parallel if there are several lanes and
/// the feature `rayon` is on.
pub(crate) fn for_each_share<J: Task + Sync>(task: &J, lanes: &mut [J::Lane], data: &mut [J::Item], length: usize)
where
    J::Lane: Send,
    J::Item: Send,
{
    let arch = Arch::new();
    #[cfg(feature = "rayon")]
    if lanes.len() > 1 {
        use rayon::prelude::*;
        let shares = lanes.par_iter_mut().zip(data.par_chunks_mut(length));
        shares.enumerate().for_each(|(k, (lane, share))| arch.dispatch(Vectorised { task, k, lane, share }));
        return;
    }
    for (k, (lane, share)) in lanes.iter_mut().zip(data.chunks_mut(length)).enumerate() {
        arch.dispatch(Vectorised { task, k, lane, share });
    }
}

struct Vectorised<'a, J: Task> {
    task: &'a J,
    k: usize,
    lane: &'a mut J::Lane,
    share: &'a mut [J::Item],
}

impl<J: Task> WithSimd for Vectorised<'_, J> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.task.run(self.k, self.lane, self.share);
    }
}

/// Does both jobs, in parallel if they are `shared` and the feature `rayon` is on.
pub(crate) fn join(shared: bool, first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
    #[cfg(feature = "rayon")]
    if shared {
        rayon::join(first, second);
        return;
    }
    let _ = shared;
    first();
    second();
}

/// Threads that may share the work on a field of so many cells.
pub(crate) fn lanes(cells: usize) -> usize {
    #[cfg(feature = "rayon")]
    if cells >= WORTH_SHARING {
        return rayon::current_num_threads();
    }
    let _ = cells;
    1
}

/// Fields with fewer cells are not worth a hand-over between threads.
#[cfg(feature = "rayon")]
const WORTH_SHARING: usize = 1 << 15;
