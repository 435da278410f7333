//! An approximate inverse of the influence operator.

use std::sync::Arc;

use crate::kernel::{LocalKernel, SpectralOperator, TransformWorkspace};

/// M ≈ K⁻¹, a multiplication in wave space on a grid without padding ([`LocalKernel::inverse`]): for the half-space a quarter
/// of the size of a convolution.
#[derive(Debug, Clone)]
pub(crate) struct Preconditioner {
    operator: Arc<SpectralOperator>,
    work: TransformWorkspace,
    diagonal: f64,
}

impl Preconditioner {
    pub(crate) fn new(kernel: &LocalKernel) -> Preconditioner {
        let cells = kernel.grid().cells();
        let operator = kernel.inverse();
        let work = operator.workspace();
        let mut preconditioner = Preconditioner { operator: Arc::new(operator), work, diagonal: 0.0 };
        let mut impulse = vec![0.0; kernel.grid().len()];
        // in the middle, as far as possible from its mirror images
        let middle = cells[0] / 2 * cells[1] + cells[1] / 2;
        impulse[middle] = 1.0;
        preconditioner.apply(&mut impulse);
        preconditioner.diagonal = impulse[middle];
        preconditioner
    }

    /// field ← M field.
    pub(crate) fn apply(&mut self, field: &mut [f64]) {
        self.operator.apply_in_place(field, &mut self.work);
    }

    /// The diagonal m of M, the same for every cell.
    pub(crate) fn diagonal(&self) -> f64 {
        self.diagonal
    }
}
