//! An approximate inverse of the influence operator.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::Grid;
use crate::kernel::{Layout, SpectralOperator, TransformWorkspace, images};

/// M ≈ K⁻¹: on an infinite plane K multiplies the wave q by 2/|q| (Westergaard 1939), so M multiplies
/// by |q|/2 on a periodic grid without padding, a quarter of the size of a convolution.
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
    pub(crate) fn new(grid: &Grid, folded: [bool; 2], single: bool) -> Preconditioner {
        let (cells, spacing) = (grid.cells(), grid.spacing());
        let layout = Layout { cells, padded: false, folded };
        let period = [layout.period(0), layout.period(1)];
        let wave_number = |axis: usize, k: usize| TAU * k as f64 / (period[axis] as f64 * spacing[axis]);
        // a uniform pressure on a square of side L sinks it by 0.95 L p on average (Love): the mean is
        // treated as a wave of that compliance
        let [l1, l2] = grid.lengths();
        let mean = 1.05 / (images(folded) as f64 * l1 * l2).sqrt();
        let unit = 1.0 / spacing[0].min(spacing[1]);
        let symbol = |k1, k2| match (k1, k2) {
            (0, 0) => mean / unit,
            _ => 0.5 * wave_number(0, k1).hypot(wave_number(1, k2)) / unit,
        };
        let operator = if single {
            let operator = Arc::new(SpectralOperator::from_symbol(layout, symbol));
            Operator::Single(Arc::clone(&operator), operator.workspace())
        } else {
            let operator = Arc::new(SpectralOperator::from_symbol(layout, symbol));
            Operator::Double(Arc::clone(&operator), operator.workspace())
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
