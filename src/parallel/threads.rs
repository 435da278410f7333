//! Ranks that are threads of one process.

use std::panic::resume_unwind;
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use super::Ranks;
use super::rows::lock;
use crate::error::{RanksError, Result, count_within};

/// Threads of one process that play ranks: for tests, and to try a program before it runs on several machines.
///
/// On one machine the threads of the feature `rayon` are the better choice: they share the rows of a contact without
/// copies.
pub struct Threads {
    rank: usize,
    meeting: Arc<Rendezvous>,
}

impl Threads {
    /// Runs `job` on `size` threads, each with its rank; returns the results in the order of the ranks.
    ///
    /// A rank that is done, or panics, has left: calls in which others wait for it fail with [`RanksError::Left`].
    /// When all have ended, the panic of a rank continues in the caller.
    ///
    /// # Errors
    /// If `size` is zero, or more than 1024.
    pub fn run<T: Send>(size: usize, job: impl Fn(Arc<dyn Ranks>) -> T + Sync) -> Result<Vec<T>> {
        count_within("ranks", size, (1..=MOST).contains(&size), "1 to 1024")?;
        let meeting = Arc::new(Rendezvous::of(size));
        let work = |rank: usize| {
            let _leaves = Leaving { rank, meeting: &meeting };
            job(Arc::new(Threads { rank, meeting: Arc::clone(&meeting) }))
        };
        let work = &work;
        let ended = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..size).map(|rank| scope.spawn(move || work(rank))).collect();
            threads.into_iter().map(|thread| thread.join()).collect::<Vec<_>>()
        });
        // a panic of the job is its caller's
        Ok(ended.into_iter().map(|ended| ended.unwrap_or_else(|panic| resume_unwind(panic))).collect())
    }
}

/// Marks a rank as gone when it is dropped, as its job ends or panics, and wakes the waiting ranks.
struct Leaving<'a> {
    rank: usize,
    meeting: &'a Rendezvous,
}

impl Drop for Leaving<'_> {
    fn drop(&mut self) {
        lock(&self.meeting.gate).left.get_or_insert(self.rank);
        self.meeting.opened.notify_all();
    }
}

/// Upper limit of threads.
const MOST: usize = 1024;

/// Rendezvous point of the threads.
struct Rendezvous {
    /// Numbers of each rank. The buffers are kept, so that no meeting allocates that is no larger than one before.
    brought: Vec<Mutex<Brought>>,
    gate: Mutex<Gate>,
    opened: Condvar,
}

/// Numbers of a rank, and how many of them are for each rank: all for each, if there are no counts.
#[derive(Default)]
struct Brought {
    numbers: Vec<f64>,
    counts: Vec<usize>,
}

#[derive(Default)]
struct Gate {
    waiting: usize,
    /// How often the gate has been opened.
    openings: u64,
    /// The first rank that left.
    left: Option<usize>,
}

impl Rendezvous {
    fn of(size: usize) -> Rendezvous {
        let brought = (0..size).map(|_| Mutex::default()).collect();
        Rendezvous { brought, gate: Mutex::default(), opened: Condvar::new() }
    }

    /// Waits until all ranks are here.
    fn wait(&self) -> Result<(), RanksError> {
        let mut gate = lock(&self.gate);
        if let Some(rank) = gate.left {
            return Err(RanksError::Left { rank });
        }
        gate.waiting += 1;
        if gate.waiting == self.brought.len() {
            (gate.waiting, gate.openings) = (0, gate.openings + 1);
            self.opened.notify_all();
            return Ok(());
        }
        let opening = gate.openings;
        loop {
            gate = self.opened.wait(gate).unwrap_or_else(PoisonError::into_inner);
            // who left afterwards was here
            if gate.openings != opening {
                return Ok(());
            }
            if let Some(rank) = gate.left {
                return Err(RanksError::Left { rank });
            }
        }
    }
}

impl Threads {
    /// Offers `numbers` to all ranks, and receives `received_counts[r]` numbers from each rank r.
    fn meet(
        &self,
        (numbers, counts): (&[f64], &[usize]),
        received: &mut [f64],
        received_counts: &[usize],
    ) -> Result<(), RanksError> {
        {
            let own = &mut *lock(&self.meeting.brought[self.rank]);
            numbers.clone_into(&mut own.numbers);
            counts.clone_into(&mut own.counts);
        }
        self.meeting.wait()?;
        let (mut rest, mut agree) = (received, true);
        for (brought, &count) in self.meeting.brought.iter().zip(received_counts) {
            let (part, others) = std::mem::take(&mut rest).split_at_mut(count);
            let Brought { numbers, counts } = &*lock(brought);
            let start = counts.iter().take(self.rank).sum::<usize>();
            agree &= counts.get(self.rank).unwrap_or(&numbers.len()) == &count;
            part.iter_mut().zip(&numbers[start..]).for_each(|(part, &number)| *part = number);
            rest = others;
        }
        // no rank may offer new numbers before all ranks have read the old ones
        self.meeting.wait()?;
        if agree { Ok(()) } else { Err(RanksError::Apart) }
    }
}

impl Ranks for Threads {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.meeting.brought.len()
    }

    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) -> Result<(), RanksError> {
        self.meet((own, &[]), all, counts)
    }

    fn exchange(
        &self,
        send: &[f64],
        send_counts: &[usize],
        received: &mut [f64],
        receive_counts: &[usize],
    ) -> Result<(), RanksError> {
        self.meet((send, send_counts), received, receive_counts)
    }
}

debug_by!(self: Threads => rank: self.rank, size: self.size());
