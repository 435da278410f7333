//! Ranks that are threads of one process.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use num_complex::Complex64;

use super::Ranks;
use super::rows::RankLoss;
use crate::error::{RanksError, Result, count_within};

/// Threads of one process that play ranks: for tests, and to try a program before it runs on several machines.
///
/// On one machine the threads of the feature `rayon` are the better choice: they share the rows of a contact without
/// copies.
pub struct Threads {
    rank: usize,
    meeting: Arc<Meeting>,
}

impl Threads {
    /// Runs `job` on `size` threads, each with its rank; returns what each of them returned, in their order.
    ///
    /// A rank that is done, or panics, has left: calls in which others wait for it fail with [`RanksError::Left`]. When all
    /// have ended, a panic goes on in the caller.
    ///
    /// # Errors
    /// If `size` is zero, or more than 1024.
    pub fn run<T: Send>(size: usize, job: impl Fn(Arc<dyn Ranks>) -> T + Sync) -> Result<Vec<T>> {
        count_within("ranks", size, (1..=MOST).contains(&size), "1 to 1024")?;
        let meeting = Arc::new(Meeting::of(size));
        let work = |rank: usize| {
            let ranks = Arc::new(Threads { rank, meeting: Arc::clone(&meeting) });
            let ended = catch_unwind(AssertUnwindSafe(|| job(ranks)));
            meeting.leave(rank);
            ended
        };
        let work = &work;
        let ended = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..size).map(|rank| scope.spawn(move || work(rank))).collect();
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(Err)).collect::<Vec<_>>()
        });
        let (mut done, mut panicked, mut departed) = (Vec::with_capacity(size), None, None);
        for ended in ended {
            match ended {
                Ok(result) => done.push(result),
                Err(panic) => match panic.downcast::<RankLoss>() {
                    Ok(departure) => departed = departed.or(Some(departure.0)),
                    Err(panic) => panicked = panicked.or(Some(panic)),
                },
            }
        }
        match (panicked, departed) {
            (Some(panic), _) => resume_unwind(panic),
            (None, Some(error)) => Err(error.into()),
            (None, None) => Ok(done),
        }
    }
}

/// Most threads: more help nobody.
const MOST: usize = 1024;

/// Where the threads meet.
struct Meeting {
    /// What each rank brings: kept, so that no meeting allocates that is no larger than one before.
    values: Vec<Mutex<Vec<f64>>>,
    numbers: Vec<Mutex<(Vec<Complex64>, Vec<usize>)>>,
    gate: Mutex<Gate>,
    opened: Condvar,
}

#[derive(Default)]
struct Gate {
    waiting: usize,
    /// How often the gate has been opened.
    openings: u64,
    /// The first rank that left.
    left: Option<usize>,
}

impl Meeting {
    fn of(size: usize) -> Meeting {
        Meeting {
            values: (0..size).map(|_| Mutex::default()).collect(),
            numbers: (0..size).map(|_| Mutex::default()).collect(),
            gate: Mutex::default(),
            opened: Condvar::new(),
        }
    }

    fn leave(&self, rank: usize) {
        lock(&self.gate).left.get_or_insert(rank);
        self.opened.notify_all();
    }

    /// Waits until all ranks are here.
    fn wait(&self) -> Result<(), RanksError> {
        let mut gate = lock(&self.gate);
        if let Some(rank) = gate.left {
            return Err(RanksError::Left { rank });
        }
        gate.waiting += 1;
        if gate.waiting == self.values.len() {
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

impl Ranks for Threads {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.meeting.values.len()
    }

    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) -> Result<(), RanksError> {
        refill(&mut lock(&self.meeting.values[self.rank]), own);
        self.meeting.wait()?;
        let (mut rest, mut agree) = (all, true);
        for (values, &count) in self.meeting.values.iter().zip(counts) {
            let (part, others) = std::mem::take(&mut rest).split_at_mut(count);
            let values = lock(values);
            agree &= values.len() == count;
            part.iter_mut().zip(&*values).for_each(|(part, &value)| *part = value);
            rest = others;
        }
        // nobody may bring anything new before all have read
        self.meeting.wait()?;
        if agree { Ok(()) } else { Err(RanksError::Apart) }
    }

    fn exchange(
        &self,
        send: &[Complex64],
        send_counts: &[usize],
        received: &mut [Complex64],
        receive_counts: &[usize],
    ) -> Result<(), RanksError> {
        {
            let (numbers, counts) = &mut *lock(&self.meeting.numbers[self.rank]);
            refill(numbers, send);
            refill(counts, send_counts);
        }
        self.meeting.wait()?;
        let (mut rest, mut agree) = (received, true);
        for (numbers, &count) in self.meeting.numbers.iter().zip(receive_counts) {
            let (part, others) = std::mem::take(&mut rest).split_at_mut(count);
            let (numbers, counts) = &*lock(numbers);
            let start = counts[..self.rank].iter().sum::<usize>();
            agree &= counts[self.rank] == count;
            part.iter_mut().zip(&numbers[start..]).for_each(|(part, &number)| *part = number);
            rest = others;
        }
        self.meeting.wait()?;
        if agree { Ok(()) } else { Err(RanksError::Apart) }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn refill<T: Copy>(kept: &mut Vec<T>, values: &[T]) {
    kept.clear();
    kept.extend_from_slice(values);
}

impl fmt::Debug for Threads {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Threads").field("rank", &self.rank).field("size", &self.size()).finish()
    }
}
