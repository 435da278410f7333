//! The rows that a rank has, and sums over the rows of all.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{BAND_CELLS, Ranks, join, lanes, rows_in_a_tile};
use crate::error::{RanksError, Result};
use crate::sum;

/// The computed rows of a grid, cut into bands. This process holds all of them, or some if ranks share them out.
///
/// Bands are whole tiles of the transforms, folded or not (the preconditioner mirrors axes that end), about
/// [`BAND_CELLS`] cells, or one tile where that is more. A sum is taken in each band, and over the bands by halves:
/// so it does not depend on the number of threads or ranks. A process by itself does this without a copy, a call or
/// an allocation.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    /// Rows of all ranks, and cells of a row.
    cells: [usize; 2],
    own: Range<usize>,
    /// Rows of a band.
    band: usize,
    shared: Option<Arc<Shared>>,
}

/// Compares the rows, not the groups.
impl PartialEq for Rows {
    fn eq(&self, other: &Rows) -> bool {
        (self.cells, &self.own, self.band) == (other.cells, &other.own, other.band)
    }
}

/// Connection of a rank to the group.
#[derive(Debug)]
struct Shared {
    group: Arc<dyn Ranks>,
    /// Kept, so that no sum allocates that is no longer than an earlier one.
    buffers: Mutex<Buffers>,
    /// Why a call of the group failed. Until that is returned ([`Rows::or_loss`]), no other call is made.
    lost: Mutex<Option<RanksError>>,
}

#[derive(Debug, Default)]
struct Buffers {
    own: Vec<f64>,
    all: Vec<f64>,
    counts: Vec<usize>,
}

impl Rows {
    /// All rows of a field of so many cells.
    pub(crate) fn all(cells: [usize; 2]) -> Rows {
        let tile = rows_in_a_tile([true; 2]);
        let band = tile * (BAND_CELLS / (tile * cells[1]).max(1)).max(1);
        Rows { cells, own: 0..cells[0], band, shared: None }
    }

    /// The rows of a rank of the group.
    pub(crate) fn of_rank(cells: [usize; 2], group: Arc<dyn Ranks>) -> Rows {
        let shared = Some(Arc::new(Shared { group, buffers: Mutex::default(), lost: Mutex::default() }));
        Rows { shared, ..Rows::all(cells) }.of_cells(cells)
    }

    /// The rows of another field that the same ranks share out.
    pub(crate) fn of_cells(&self, cells: [usize; 2]) -> Rows {
        let mut rows = Rows { shared: self.shared.clone(), ..Rows::all(cells) };
        rows.own = rows.of(self.rank());
        rows
    }

    /// The group that shares them out.
    pub(crate) fn group(&self) -> Option<&Arc<dyn Ranks>> {
        self.shared.as_ref().map(|shared| &shared.group)
    }

    pub(crate) fn are_shared(&self) -> bool {
        self.shared.is_some()
    }

    /// Which of the ranks this is.
    pub(crate) fn rank(&self) -> usize {
        self.group().map_or(0, |group| group.rank())
    }

    /// Number of ranks.
    pub(crate) fn ranks(&self) -> usize {
        self.group().map_or(1, |group| group.size())
    }

    /// Rows and columns of all ranks.
    pub(crate) fn cells(&self) -> [usize; 2] {
        self.cells
    }

    /// Number of cells of all ranks.
    pub(crate) fn len(&self) -> usize {
        self.cells[0] * self.cells[1]
    }

    /// The local rows.
    pub(crate) fn own(&self) -> Range<usize> {
        self.own.clone()
    }

    /// The rows of a rank.
    pub(crate) fn of(&self, rank: usize) -> Range<usize> {
        let bands = part(self.cells[0].div_ceil(self.band), rank, self.ranks());
        (bands.start * self.band).min(self.cells[0])..(bands.end * self.band).min(self.cells[0])
    }

    /// Number of local bands.
    pub(crate) fn bands(&self) -> usize {
        self.own.len().div_ceil(self.band)
    }

    /// Number of bands of a rank.
    pub(crate) fn bands_of(&self, rank: usize) -> usize {
        self.of(rank).len().div_ceil(self.band)
    }

    /// Number of cells of a band, the last of which may be shorter.
    pub(crate) fn band_cells(&self) -> usize {
        self.band * self.cells[1]
    }

    /// The cells of a local band in a field of local rows.
    pub(crate) fn band(&self, band: usize) -> Range<usize> {
        let (length, cells) = (self.band_cells(), self.own.len() * self.cells[1]);
        band * length..((band + 1) * length).min(cells)
    }

    /// Computes `part` of each band, and merges the parts of the bands of all ranks by halves.
    pub(crate) fn merge<const K: usize>(
        &self,
        part: impl Fn(Range<usize>) -> [f64; K] + Sync,
        merge: impl Fn([f64; K], [f64; K]) -> [f64; K] + Sync,
    ) -> [f64; K] {
        self.merge_bands(&|band| part(self.band(band)), &merge)
    }

    /// [`Rows::merge`], compiled once for all sums of K numbers.
    fn merge_bands<const K: usize>(
        &self,
        part: &(dyn Fn(usize) -> [f64; K] + Sync),
        merge: &(dyn Fn([f64; K], [f64; K]) -> [f64; K] + Sync),
    ) -> [f64; K] {
        let Some(shared) = &self.shared else {
            return halves(0..self.bands(), lanes(self.own.len() * self.cells[1]) > 1, part, merge);
        };
        let own = &mut |own: &mut Vec<f64>| (0..self.bands()).for_each(|band| own.extend_from_slice(&part(band)));
        let buffers = self.gathered(shared, own, &|rank| K * self.bands_of(rank));
        let all = buffers.all.as_chunks::<K>().0;
        let sum = halves(0..all.len(), false, &|band: usize| all[band], merge);
        *lock(&shared.buffers) = buffers;
        sum
    }

    /// Sums K terms of each cell over the cells that have any.
    pub(crate) fn sum_terms<const K: usize>(&self, terms: impl Fn(usize) -> Option<[f64; K]> + Sync) -> [f64; K] {
        let part = |band: Range<usize>| {
            let mut sums = [0.0; K];
            for k in band {
                // called here, to be inlined
                if let Some(terms) = terms(k) {
                    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
                }
            }
            sums
        };
        self.merge(part, sum::add)
    }

    /// Σ part over the bands.
    pub(crate) fn sum_of(&self, part: impl Fn(Range<usize>) -> f64 + Sync) -> f64 {
        self.merge(|band| [part(band)], |[a], [b]| [a + b])[0]
    }

    /// Σ values of a field of local rows.
    pub(crate) fn sum(&self, values: &[f64]) -> f64 {
        self.sum_of(|band| sum::sum(&values[band]))
    }

    /// Σ f(a, b) over the values of two fields of local rows.
    pub(crate) fn sum_of_pairs(&self, a: &[f64], b: &[f64], f: impl Fn(f64, f64) -> f64 + Sync) -> f64 {
        self.sum_of(|band| sum::sum_of_pairs(&a[band.clone()], &b[band], &f))
    }

    /// Merges the numbers of the ranks, rank by rank: for a maximum or a minimum. A sum would depend on the number of
    /// ranks: see
    /// [`Rows::merge`].
    pub(crate) fn join<const K: usize>(
        &self,
        own: [f64; K],
        merge: impl Fn([f64; K], [f64; K]) -> [f64; K],
    ) -> [f64; K] {
        let Some(shared) = &self.shared else { return own };
        let buffers = self.gathered(shared, &mut |sent| sent.extend_from_slice(&own), &|_| K);
        let joined = buffers.all.as_chunks::<K>().0.iter().copied().reduce(merge).unwrap_or(own);
        *lock(&shared.buffers) = buffers;
        joined
    }

    /// The largest of the values of the ranks.
    pub(crate) fn greatest(&self, own: f64) -> f64 {
        self.join([own], |[a], [b]| [a.max(b)])[0]
    }

    /// The least of the values of the ranks.
    pub(crate) fn least(&self, own: f64) -> f64 {
        self.join([own], |[a], [b]| [a.min(b)])[0]
    }

    /// Whether `own` is true on any rank.
    pub(crate) fn any(&self, own: bool) -> bool {
        if self.shared.is_none() { own } else { self.greatest(f64::from(u8::from(own))) > 0.0 }
    }

    /// The sum of the counts of the ranks.
    pub(crate) fn count(&self, own: usize) -> usize {
        if self.shared.is_none() { own } else { self.join([own as f64], |[a], [b]| [a + b])[0] as usize }
    }

    /// Gathers `count(rank)` numbers of each rank, and passes the numbers of all ranks to `read`: NaN if one is lost.
    pub(crate) fn gather<R>(
        &self,
        own: impl Iterator<Item = f64>,
        count: impl Fn(usize) -> usize,
        read: impl FnOnce(&[f64]) -> R,
    ) -> R {
        let Some(shared) = &self.shared else { return read(&own.collect::<Vec<_>>()) };
        let mut own = own;
        let buffers = self.gathered(shared, &mut |sent| sent.extend(&mut own), &count);
        let found = read(&buffers.all);
        *lock(&shared.buffers) = buffers;
        found
    }

    /// The buffers, to be given back, with what `own` writes on each of the ranks.
    fn gathered(&self, shared: &Shared, own: &mut dyn FnMut(&mut Vec<f64>), count: &dyn Fn(usize) -> usize) -> Buffers {
        let mut buffers = std::mem::take(&mut *lock(&shared.buffers));
        let Buffers { own: sent, all, counts } = &mut buffers;
        sent.clear();
        own(sent);
        counts.clear();
        counts.extend((0..self.ranks()).map(count));
        all.resize(counts.iter().sum(), 0.0);
        shared.gather(sent, counts, all);
        buffers
    }

    /// Sends numbers to each rank, and receives numbers from each; if a rank is lost, `received` stays as it is. A
    /// process by itself receives what it sends.
    pub(crate) fn exchange_into(
        &self,
        (send, send_counts): (&[f64], &[usize]),
        (received, receive_counts): (&mut [f64], &[usize]),
    ) {
        let Some(shared) = &self.shared else { return received.copy_from_slice(send) };
        shared.call(|group| group.exchange(send, send_counts, received, receive_counts));
    }

    /// Runs `job`, a call of all ranks, and returns its result, or the loss of a rank, in `job` or before it: sums
    /// and gathered values of `job` are NaN then. The loss is returned once. Nothing is sent to other ranks, nor
    /// waited for.
    pub(crate) fn or_loss<T>(&self, job: impl FnOnce() -> Result<T>) -> Result<T> {
        let done = job();
        match self.shared.as_ref().and_then(|shared| lock(&shared.lost).take()) {
            Some(loss) => Err(loss.into()),
            None => done,
        }
    }

    /// An error if a rank is lost: for what must not follow then, as a file or a state that is replaced.
    pub(crate) fn intact(&self) -> Result<(), RanksError> {
        self.shared.as_ref().and_then(|shared| lock(&shared.lost).clone()).map_or(Ok(()), Err)
    }

    /// Returns `own` if all ranks succeed, else the error of the first rank that failed.
    pub(crate) fn agree<T>(&self, own: Result<T>) -> Result<T> {
        if !self.are_shared() {
            return own;
        }
        let message = own.as_ref().err().map_or(String::new(), |error| format!("{error:?}"));
        // 53 bits survive as an f64
        let mark = message.bytes().fold(0_u64, |mark, byte| (mark * 31 + u64::from(byte)) % (1 << 53));
        let first_failed = |all: &[f64]| {
            let all = all.as_chunks::<2>().0;
            let failed = all.iter().position(|&[length, _]| length > 0.0).map(|rank| (rank, all[rank][0] as usize));
            failed.filter(|_| !all.iter().all(|other| *other == all[0]))
        };
        let found = self.gather([message.len() as f64, mark as f64].into_iter(), |_| 2, first_failed);
        self.intact()?;
        // no rank has failed, or all have in the same way
        let Some((rank, length)) = found else { return own };
        let own = if self.rank() == rank { message.as_bytes() } else { &[] };
        let bytes = own.iter().map(|&byte| f64::from(byte));
        let bytes = self.gather(bytes, |of| if of == rank { length } else { 0 }, <[f64]>::to_vec);
        self.intact()?;
        let message = bytes.into_iter().map(|byte| byte as u8).collect::<Vec<_>>();
        Err(RanksError::Failed { rank, message: String::from_utf8_lossy(&message).into_owned() }.into())
    }

    /// Rejects numbers that are not the same, bit by bit, on all ranks.
    pub(crate) fn same<const K: usize>(&self, numbers: [f64; K]) -> Result<()> {
        if !self.are_shared() {
            return Ok(());
        }
        let other = |others: &[f64; K]| others.map(f64::to_bits) != numbers.map(f64::to_bits);
        let differ = self.gather(numbers.into_iter(), |_| K, |all| all.as_chunks().0.iter().any(other));
        self.intact()?;
        if differ { Err(RanksError::Apart.into()) } else { Ok(()) }
    }
}

impl Shared {
    /// Gathers numbers of all ranks: NaN if one is lost.
    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) {
        if !self.call(|group| group.gather(own, counts, all)) {
            all.fill(f64::NAN);
        }
    }

    /// Makes a call of the group, unless one has failed; whether it succeeded.
    fn call(&self, call: impl FnOnce(&dyn Ranks) -> Result<(), RanksError>) -> bool {
        let mut lost = lock(&self.lost);
        if lost.is_none() {
            *lost = call(&*self.group).err();
        }
        lost.is_none()
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The part of `n` things that a rank has.
pub(crate) fn part(n: usize, rank: usize, size: usize) -> Range<usize> {
    let start = |rank: usize| (n as u128 * rank as u128 / size as u128) as usize;
    start(rank)..start(rank + 1)
}

/// Merges the parts of some bands by halves.
fn halves<const K: usize>(
    bands: Range<usize>,
    in_threads: bool,
    part: &(dyn Fn(usize) -> [f64; K] + Sync),
    merge: &(dyn Fn([f64; K], [f64; K]) -> [f64; K] + Sync),
) -> [f64; K] {
    if bands.len() <= 1 {
        return part(bands.start);
    }
    let middle = bands.start + bands.len() / 2;
    let (mut before, mut after) = ([0.0; K], [0.0; K]);
    join(
        in_threads,
        || before = halves(bands.start..middle, in_threads, part, merge),
        || after = halves(middle..bands.end, in_threads, part, merge),
    );
    merge(before, after)
}
