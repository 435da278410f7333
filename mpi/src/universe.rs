//! The world of MPI as a group of ranks.

use std::sync::{Arc, Mutex, PoisonError};

use mpi::Threading;
use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::environment::{Universe, initialize_with_threading};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use viscocontact::parallel::{Ranks, RanksError};

use crate::chunks::{Chunks, MOST};

/// All processes that `mpirun` has started, as ranks.
///
/// Made once in a program, by [`Mpi::start`]. When the last contact and the program have let go of it, MPI ends. A
/// rank that lets go of it before the others has left: their calls fail with [`RanksError::Left`].
pub struct Mpi {
    /// Ends MPI when it is dropped.
    universe: Universe,
    most: usize,
    left: Mutex<Option<usize>>,
}

/// MPI could not be started.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MpiError {
    /// It was started before in this process: it cannot be twice.
    StartedBefore,
}

impl std::fmt::Display for MpiError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            MpiError::StartedBefore => {
                f.write_str("MPI was started before in this process: share what Mpi::start returned")
            }
        }
    }
}

impl std::error::Error for MpiError {}

impl Mpi {
    /// Starts MPI, and lets a panic of any rank, after its message, end all of them: nobody waits for it.
    ///
    /// # Errors
    /// If it was started before in this process.
    pub fn start() -> Result<Arc<Mpi>, MpiError> {
        Mpi::start_with_messages(MOST)
    }

    /// The same with at most so many numbers in one call of MPI, which counts with 32 bits: for tests of longer messages.
    ///
    /// # Errors
    /// As [`Mpi::start`].
    pub fn start_with_messages(most: usize) -> Result<Arc<Mpi>, MpiError> {
        let (universe, _) = initialize_with_threading(Threading::Serialized).ok_or(MpiError::StartedBefore)?;
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            before(panic);
            SimpleCommunicator::world().abort(1);
        }));
        Ok(Arc::new(Mpi { universe, most: most.clamp(1, MOST), left: Mutex::new(None) }))
    }

    /// Meets all ranks: agrees on the number of calls that follow, and learns whether one is leaving.
    fn meet(&self, leaves: bool, calls: usize) -> Result<usize, RanksError> {
        let mut left = self.left.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(rank) = *left {
            return Err(RanksError::Left { rank });
        }
        let (rank, size) = (self.rank(), self.size());
        let own = [if leaves { (size - rank) as u64 } else { 0 }, calls as u64];
        let mut all = [0_u64; 2];
        self.universe.world().all_reduce_into(&own, &mut all, SystemOperation::max());
        if all[0] > 0 {
            let rank = size - all[0] as usize;
            *left = Some(rank);
            return Err(RanksError::Left { rank });
        }
        Ok(all[1] as usize)
    }
}

impl Ranks for Mpi {
    fn rank(&self) -> usize {
        self.universe.world().rank() as usize
    }

    fn size(&self) -> usize {
        self.universe.world().size() as usize
    }

    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) -> Result<(), RanksError> {
        let chunks = Chunks::new(counts, self.most);
        let calls = self.meet(false, chunks.calls())?;
        let world = self.universe.world();
        if calls <= 1 {
            let (counts, starts) = chunks.whole();
            world.all_gather_varcount_into(own, &mut PartitionMut::new(all, counts, starts));
            return Ok(());
        }
        let mut received = vec![0.0; chunks.longest()];
        for call in 0..calls {
            let (counts, starts) = chunks.of(call);
            let part = &own[chunks.range(self.rank(), call)];
            world.all_gather_varcount_into(part, &mut PartitionMut::new(&mut received[..], counts, starts));
            chunks.copy_out(call, &received, all);
        }
        Ok(())
    }

    fn exchange(
        &self,
        send: &[f64],
        send_counts: &[usize],
        received: &mut [f64],
        receive_counts: &[usize],
    ) -> Result<(), RanksError> {
        let [out, back] = [send_counts, receive_counts].map(|counts| Chunks::new(counts, self.most));
        let calls = self.meet(false, out.calls().max(back.calls()))?;
        let world = self.universe.world();
        if calls <= 1 {
            let ((out, out_at), (back, back_at)) = (out.whole(), back.whole());
            let send = Partition::new(send, out, out_at);
            world.all_to_all_varcount_into(&send, &mut PartitionMut::new(received, back, back_at));
            return Ok(());
        }
        let (mut sent, mut came) = (vec![0.0; out.longest()], vec![0.0; back.longest()]);
        for call in 0..calls {
            out.copy_in(call, send, &mut sent);
            let ((out, out_at), (counts, starts)) = (out.of(call), back.of(call));
            let part = Partition::new(&sent[..], out, out_at);
            world.all_to_all_varcount_into(&part, &mut PartitionMut::new(&mut came[..], counts, starts));
            back.copy_out(call, &came, received);
        }
        Ok(())
    }
}

/// Tells the others, who may be waiting.
impl Drop for Mpi {
    fn drop(&mut self) {
        let _ = self.meet(true, 0);
    }
}

impl std::fmt::Debug for Mpi {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Mpi").field("rank", &self.rank()).field("size", &self.size()).finish()
    }
}
