//! Loops over fields: compiled for the vector units of the machine that runs them, and shared between threads.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

/// Work of a thread on its share of a field. `run` must be `#[inline(always)]`: only then is it compiled for vectors
/// wider than the baseline. Arithmetic and its order stay the same, so that results are bitwise the same.
pub(crate) trait Task {
    /// Buffers of one thread.
    type Lane;
    type Item;

    /// Computes the share that begins at the item `start`.
    fn run(&self, start: usize, lane: &mut Self::Lane, share: &mut [Self::Item]);
}

/// Runs `task` on the shares of `data`, `length` values each, one lane per share: in parallel if there are several
/// lanes and the feature `rayon` is on.
pub(crate) fn for_each_share<'a, T: Task + Sync>(
    task: &T,
    lanes: &'a mut [T::Lane],
    data: &'a mut [T::Item],
    length: usize,
) where
    T::Lane: Send,
    T::Item: Send,
{
    let arch = Arch::new();
    let shares = lanes.len().min(data.len().div_ceil(length));
    let cut = |(lanes, data): Shares<'a, T>, k: usize| {
        let (lanes, data) = (lanes.split_at_mut(k), data.split_at_mut(k * length));
        [(lanes.0, data.0), (lanes.1, data.1)]
    };
    fork(0..shares, true, (lanes, data), &cut, &|k, (lanes, share)| {
        if let (Some(lane), false) = (lanes.first_mut(), share.is_empty()) {
            arch.dispatch(Vectorised { task, start: k * length, lane, share });
        }
    });
}

/// Halves the units, and the data with them, down to single ones, and calls `job` with the number of each: the halves
/// in parallel if they are `shared`. `cut` splits data before the unit of this number, counted from the first unit of
/// the data.
pub(crate) fn fork<D: Send>(
    units: Range<usize>,
    shared: bool,
    data: D,
    cut: &(dyn Fn(D, usize) -> [D; 2] + Sync),
    job: &(dyn Fn(usize, D) + Sync),
) {
    if units.len() <= 1 {
        return job(units.start, data);
    }
    let half = units.len() / 2;
    let (middle, [before, after]) = (units.start + half, cut(data, half));
    join(
        shared,
        || fork(units.start..middle, shared, before, cut, job),
        || fork(middle..units.end, shared, after, cut, job),
    );
}

/// Lanes, and the data that they share out.
type Shares<'a, T> = (&'a mut [<T as Task>::Lane], &'a mut [<T as Task>::Item]);

struct Vectorised<'a, T: Task> {
    task: &'a T,
    start: usize,
    lane: &'a mut T::Lane,
    share: &'a mut [T::Item],
}

impl<T: Task> WithSimd for Vectorised<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.task.run(self.start, self.lane, self.share);
    }
}

/// Runs both closures, in parallel if they are `shared` and the feature `rayon` is on.
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

/// Runs `job`, which works on fields of so many cells, on a thread of the pool if threads share the work. A call from
/// a thread outside of the pool goes through its queue, which allocates a block for 63 calls: many loops go through
/// it once.
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

/// Cells that a thread passes over at a time. Sums are taken over bands of about so many cells, whatever the number
/// of threads.
pub(crate) const BAND_CELLS: usize = 1 << 13;

/// Calls `job` with each band of some fields, and the number of its first cell. The first field has one value for
/// each cell, the others may have none or several.
pub(crate) fn for_each_band<T: Send, const M: usize>(fields: [&mut [T]; M], job: impl Fn(usize, [&mut [T]; M]) + Sync) {
    let cells = fields.first().map_or(0, |field| field.len());
    let bands = 0..cells.div_ceil(BAND_CELLS);
    let job = |band: usize, fields: [&mut [T]; M]| job(band * BAND_CELLS, fields);
    fork(bands, lanes(cells) > 1, fields, &|fields, k| cut(fields, k * BAND_CELLS), &job);
}

/// Cuts fields at a cell of the first of them, which has one value for each cell.
pub(crate) fn cut<T, const M: usize>(fields: [&mut [T]; M], at: usize) -> [[&mut [T]; M]; 2] {
    let cells = fields.first().map_or(1, |field| field.len());
    let mut halves = fields.map(|field| {
        let per_cell = field.len() / cells;
        field.split_at_mut(at * per_cell)
    });
    let before = halves.each_mut().map(|(before, _)| std::mem::take(before));
    [before, halves.map(|(_, after)| after)]
}
