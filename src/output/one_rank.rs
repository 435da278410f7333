//! What one rank writes of a contact that all of them compute.

use crate::error::Result;
use crate::fields::Fields;
use crate::parallel::Rows;

impl Fields<'_> {
    /// Returns `own` if all ranks succeed, else an error on every rank.
    pub(crate) fn agreed<T>(&self, own: Result<T>) -> Result<T> {
        let rows = self.held.region.rows();
        rows.or_loss(|| rows.agree(own))
    }

    /// Runs `job` on rank 0 alone; all ranks wait for it and share its error.
    pub(crate) fn by_one_rank<T>(&self, job: impl FnOnce() -> Result<T>) -> Result<Option<T>> {
        let rows = self.held.region.rows();
        self.agreed(if rows.rank() == 0 { job().map(Some) } else { Ok(None) })
    }

    /// The local rows, with the reductions over all ranks.
    pub(crate) fn shared_rows(&self) -> Rows {
        self.held.region.rows()
    }
}
