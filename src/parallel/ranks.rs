//! The engine that joins ranks.

use std::fmt::Debug;

use crate::error::RanksError;

/// An engine that runs several ranks at once. It provides two calls, each a call of all ranks together.
///
/// [`Threads`](super::Threads) is one; another, over MPI, is the crate `viscocontact-mpi`.
///
/// A rank that leaves (its program ends, fails or panics) must not leave the others waiting: their calls return
/// [`RanksError::Left`], or the engine ends them. A call that fails is not repeated: the call of the contact that needed it
/// returns the error.
pub trait Ranks: Debug + Send + Sync {
    /// Which of the ranks this is, from 0.
    fn rank(&self) -> usize;

    /// How many there are.
    fn size(&self) -> usize;

    /// Writes the values of all ranks to `all`, one rank after the other: `counts[r]` of rank r.
    ///
    /// # Errors
    /// If a rank has left.
    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) -> Result<(), RanksError>;

    /// Sends to each rank r the next `send_counts[r]` numbers of `send`, and receives from it the next
    /// `receive_counts[r]` of `received`; r may be the rank itself.
    ///
    /// # Errors
    /// If a rank has left.
    fn exchange(
        &self,
        send: &[f64],
        send_counts: &[usize],
        received: &mut [f64],
        receive_counts: &[usize],
    ) -> Result<(), RanksError>;
}
