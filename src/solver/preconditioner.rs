//! An approximate inverse of the influence operator.

use std::sync::Arc;

use crate::kernel::{LocalKernel, SpectralOperator, TransformWorkspace};

/// M ≈ K⁻¹, a multiplication of waves on a grid without padding ([`LocalKernel::inverse`]): for the half-space a quarter
/// of the size of a convolution.
#[derive(Debug, Clone)]
pub(crate) struct Preconditioner {
    operator: Operator,
    /// What M is measured in: its values are then of order one.
    unit: f64,
    diagonal: f64,
}

#[derive(Debug, Clone)]
enum Operator {
    Double(Arc<SpectralOperator<f64>>, TransformWorkspace<f64>),
    Single(Arc<SpectralOperator<f32>>, TransformWorkspace<f32>),
}

impl Preconditioner {
    pub(crate) fn new(kernel: &LocalKernel) -> Preconditioner {
        let (grid, cells) = (kernel.grid(), kernel.grid().cells());
        let unit = 1.0 / grid.spacing()[0].min(grid.spacing()[1]);
        let operator = if kernel.is_mixed() {
            let operator = kernel.inverse(unit);
            let work = operator.workspace();
            Operator::Single(Arc::new(operator), work)
        } else {
            let operator = kernel.inverse(unit);
            let work = operator.workspace();
            Operator::Double(Arc::new(operator), work)
        };
        let mut preconditioner = Preconditioner { operator, unit, diagonal: 0.0 };
        let mut impulse = vec![0.0; grid.len()];
        // in the middle, as far as can be from mirror images
        let middle = cells[0] / 2 * cells[1] + cells[1] / 2;
        impulse[middle] = 1.0;
        preconditioner.apply(&mut impulse, 1.0);
        preconditioner.diagonal = impulse[middle];
        preconditioner
    }

    /// field ← M field, whose values are of about the order of `size`.
    pub(crate) fn apply(&mut self, field: &mut [f64], size: f64) {
        match &mut self.operator {
            Operator::Double(operator, work) => operator.apply_in_place(field, [1.0, self.unit], work),
            Operator::Single(operator, work) => {
                let size = if (1.0 / size).is_normal() { size } else { 1.0 };
                operator.apply_in_place(field, [1.0 / size, size * self.unit], work);
            }
        }
    }

    /// The diagonal m of M, the same for every cell.
    pub(crate) fn diagonal(&self) -> f64 {
        self.diagonal
    }
}
