//! Loops over fields: compiled for the vector units of the machine that runs them, and shared between threads.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

/// Work of a thread on its share of a field. `run` must be `#[inline(always)]`: only then is it compiled for vectors
/// wider than the baseline. Arithmetic and its order stay the same, so that results are bitwise the same.
pub(crate) trait Task {
    /// Buffers of one thread.
    type Lane;
    type Item;

    /// Computes the `k`-th share.
    fn run(&self, k: usize, lane: &mut Self::Lane, share: &mut [Self::Item]);
}

/// Runs `task` on the shares of `data`, `length` values each, one lane per share: in parallel if there are several
/// lanes and the feature `rayon` is on.
pub(crate) fn for_each_share<T: Task + Sync>(task: &T, lanes: &mut [T::Lane], data: &mut [T::Item], length: usize)
where
    T::Lane: Send,
    T::Item: Send,
{
    let arch = Arch::new();
    share_out(0, lanes, data, length, &|k, lane, share| arch.dispatch(Vectorised { task, k, lane, share }));
}

fn share_out<L: Send, T: Send>(
    first: usize,
    lanes: &mut [L],
    data: &mut [T],
    length: usize,
    job: &(dyn Fn(usize, &mut L, &mut [T]) + Sync),
) {
    if lanes.len() > 1 && data.len() > length {
        let middle = lanes.len() / 2;
        let (lanes, other_lanes) = lanes.split_at_mut(middle);
        let (data, other_data) = data.split_at_mut(middle.saturating_mul(length).min(data.len()));
        join(
            true,
            || share_out(first, lanes, data, length, job),
            || share_out(first + middle, other_lanes, other_data, length, job),
        );
    } else if let (Some(lane), Some(share)) = (lanes.first_mut(), data.chunks_mut(length).next()) {
        job(first, lane, share);
    }
}

struct Vectorised<'a, T: Task> {
    task: &'a T,
    k: usize,
    lane: &'a mut T::Lane,
    share: &'a mut [T::Item],
}

impl<T: Task> WithSimd for Vectorised<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.task.run(self.k, self.lane, self.share);
    }
}

/// Runs both closures, in parallel if they are `shared` and the feature `rayon` is on.
pub(crate) fn join(shared: bool, first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
    #[cfg(feature = "rayon")]
    if shared {
        let (mut first, mut second) = (Some(first), Some(second));
        return in_parallel(&mut || first.take().map_or((), |run| run()), &mut || {
            second.take().map_or((), |run| run())
        });
    }
    let _ = shared;
    first();
    second();
}

/// [`rayon::join`], whose many functions are compiled once, and not for each pair of closures: they were a tenth of the
/// machine code of this crate.
#[cfg(feature = "rayon")]
fn in_parallel(first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
    rayon::join(first, second);
}

/// Runs `job`, which works on fields of so many cells, on a thread of the pool if threads share the work. A call from a thread
/// outside of the pool goes through its queue, which allocates a block for 63 calls: many loops go through it once.
pub(crate) fn in_pool<T: Send>(cells: usize, job: impl FnOnce() -> T + Send) -> T {
    #[cfg(feature = "rayon")]
    if lanes(cells) > 1 {
        return rayon::scope(|_| job());
    }
    let _ = cells;
    job()
}

/// Number of threads that share the work on a field of `cells` cells.
pub(crate) fn lanes(cells: usize) -> usize {
    #[cfg(feature = "rayon")]
    if cells >= MIN_SHARED_CELLS {
        return rayon::current_num_threads();
    }
    let _ = cells;
    1
}

/// Below this number of cells the overhead of threads exceeds their gain.
#[cfg(feature = "rayon")]
const MIN_SHARED_CELLS: usize = 1 << 15;

/// Cells that a thread passes over at a time. Sums are taken over bands of about so many cells, whatever the number of threads.
pub(crate) const BAND_CELLS: usize = 1 << 13;

/// Where fields of so many cells are halved between threads: at the start of a band.
pub(crate) fn middle(cells: usize) -> usize {
    cells.div_ceil(BAND_CELLS) / 2 * BAND_CELLS
}

/// Calls `job` with each band of some fields, and the number of its first cell.
pub(crate) fn for_each_band<T: Send, const M: usize>(fields: [&mut [T]; M], job: impl Fn(usize, [&mut [T]; M]) + Sync) {
    let cells = fields.first().map_or(0, |field| field.len());
    let mut no_results = vec![(); cells.div_ceil(BAND_CELLS)];
    let job = |band: Range<usize>, fields: [&mut [T]; M], _: &mut [()]| job(band.start, fields);
    over_bands(0..cells, BAND_CELLS, fields, (&mut no_results, 1), lanes(cells) > 1, &job);
}

/// Calls `job` with each band of `length` cells, its part of the fields and its part of the results, which has `count` of them.
pub(crate) fn over_bands<T: Send, R: Send, const M: usize>(
    cells: Range<usize>,
    length: usize,
    fields: [&mut [T]; M],
    (results, count): (&mut [R], usize),
    shared: bool,
    job: &(dyn Fn(Range<usize>, [&mut [T]; M], &mut [R]) + Sync),
) {
    if results.len() <= count {
        return job(cells, fields, results);
    }
    let bands = results.len() / count / 2;
    let middle = bands * length;
    let mut halves = fields.map(|field| field.split_at_mut(middle));
    let first = halves.each_mut().map(|(first, _)| std::mem::take(first));
    let second = halves.map(|(_, second)| second);
    let (results, others) = results.split_at_mut(bands * count);
    let (before, after) = (cells.start..cells.start + middle, cells.start + middle..cells.end);
    join(
        shared,
        || over_bands(before, length, first, (results, count), shared, job),
        || over_bands(after, length, second, (others, count), shared, job),
    );
}
