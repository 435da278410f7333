/// Errors of a contact that several [ranks](crate::parallel) share out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RanksError {
    /// A rank has left: its program ended, failed or panicked. The contact cannot go on.
    #[error("rank {rank} has ended or failed while the others compute: look at its own error")]
    Left {
        /// The first that left.
        rank: usize,
    },

    /// Something failed on one rank; all of them get this error.
    #[error("on rank {rank}: {message}")]
    Failed {
        /// The first rank on which it failed.
        rank: usize,
        /// Its error.
        message: String,
    },

    /// The ranks made different calls, or the same call with different arguments.
    #[error("the ranks are not at the same step: all of them must make the same calls with the same arguments")]
    Apart,
}
