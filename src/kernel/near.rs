//! The near field of an operator, and its inverse, for surfaces that attract each other.

use std::sync::Arc;

use super::even_spectrum::Symbol;
use super::influence::{LEAST_COMPLIANCE, waves};
use super::layout::{Ends, Layout};
use super::transform::{Shares, SpectralOperator, TransformWorkspace};
use super::{InfluenceKernel, LocalKernel, Workspace};

/// M, the inverse of a kernel that is periodic along both axes, or of a near field, wave by wave. A mean without
/// compliance has a stiffness of its own.
#[derive(Debug, Clone)]
pub(crate) struct PeriodInverse {
    operator: SpectralOperator,
    own: TransformWorkspace,
    pub(crate) mean: Mean,
}

/// What M and its kernel do to the mean of a field.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mean {
    /// Of M \[1/m\].
    pub(crate) stiffness: f64,
    /// Of its kernel \[m\].
    pub(crate) compliance: f64,
}

impl PeriodInverse {
    /// out ← M field.
    pub(crate) fn apply(&mut self, field: &[f64], out: &mut [f64], lender: &mut Workspace) {
        out.copy_from_slice(field);
        self.operator.apply_beside(out, &mut self.own, &mut lender.0);
    }
}

impl InfluenceKernel {
    /// The near field of an operator that ends: a layout without padding, and the factor of each of its waves. It is
    /// the operator between cells that are less than half of the grid apart; farther ones act as if they were nearer,
    /// the other way round.
    pub(super) fn near(&self, cells: [usize; 2], folded: [bool; 2]) -> Option<(Layout, Symbol)> {
        if self.periodic == [true; 2] {
            return None;
        }
        let layout = Layout { cells, ends: self.ends(), folded }.ending(Ends::Closed);
        let symbol = self.symbol(layout, None);
        let most = waves(layout).map(|[k1, k2]| symbol(k1, k2)).fold(0.0, f64::max);
        // energies stay positive
        Some((layout, Box::new(move |k1, k2| symbol(k1, k2).max(LEAST_COMPLIANCE * most))))
    }
}

impl Workspace {
    /// Swaps the buffers, but for those between the passes of a transform, which remain here.
    pub(crate) fn swap(&mut self, other: &mut Workspace) {
        std::mem::swap(&mut self.0, &mut other.0);
        self.0.swap_tiles(&mut other.0);
    }
}

impl LocalKernel {
    /// The inverse of a kernel that is periodic along both axes, or of the near field.
    pub(crate) fn period_inverse(&self) -> PeriodInverse {
        let (cells, folded) = (self.rows.cells(), self.folded);
        let near = self.whole.near(cells, folded).map(|(layout, near)| {
            let mean = near(0, 0);
            let inverse: Symbol = Box::new(move |k1, k2| 1.0 / near(k1, k2));
            (layout, inverse, mean)
        });
        let (layout, symbol, compliance) = near.unwrap_or_else(|| {
            let (layout, inverse) = self.whole.inverse(cells, folded);
            (layout, inverse, self.whole.of_wave([0, 0]))
        });
        let mean = Mean { stiffness: symbol(0, 0), compliance };
        let operator = SpectralOperator::new(layout, Shares::new(&layout, &self.rows), symbol);
        let own = operator.workspace_sharing(&self.operator);
        PeriodInverse { operator, own, mean }
    }

    /// The near field, [`InfluenceKernel::near`], and its work space without tiles: those of [`LocalKernel::workspace`]
    /// suffice. `None` of periodic bodies.
    pub(crate) fn near(&self) -> Option<(LocalKernel, Workspace)> {
        let (layout, symbol) = self.whole.near(self.rows.cells(), self.folded)?;
        let operator = SpectralOperator::new(layout, Shares::new(&layout, &self.rows), symbol);
        let work = Workspace(operator.workspace_sharing(&self.operator));
        Some((LocalKernel { operator: Arc::new(operator), ..self.clone() }, work))
    }

    /// [`LocalKernel::apply`] in place.
    pub(crate) fn apply_in_place(&self, field: &mut [f64], work: &mut Workspace) {
        self.operator.apply_in_place(field, &mut work.0);
    }
}

#[cfg(all(test, feature = "layers"))]
mod tests {
    use super::*;
    use crate::{Grid, Layer};

    /// Between cells less than half of the grid apart, and their mirror images, the near field is the operator, on
    /// the half-space and on a layer, whether the cells make the transform fast or not. Nowhere does it give energy
    /// away.
    #[test]
    fn the_near_field_is_the_operator_nearby() {
        for (cells, folded) in [([16, 12], [false; 2]), ([17, 23], [false; 2]), ([16, 24], [true, true])] {
            let grid = Grid::new(cells, [1.0, 1.3]).unwrap();
            let layer = Layer::bonded_to_rigid(0.2, 0.45).unwrap();
            for whole in [InfluenceKernel::half_space(&grid).unwrap(), InfluenceKernel::layer(&grid, layer).unwrap()] {
                let own = [0, 1].map(|axis| cells[axis] / if folded[axis] { 2 } else { 1 });
                let part = Grid::new(own, [0, 1].map(|axis| grid.spacing()[axis] * own[axis] as f64)).unwrap();
                let kernel = whole.on(&part, folded);
                let (near, mut work_near) = kernel.near().unwrap();
                let mut work = kernel.workspace();
                // all that acts lies within a square of half of the grid
                let begin = [0, 1].map(|axis| if folded[axis] { 0 } else { cells[axis] / 4 });
                let count = [0, 1].map(|axis| cells[axis] / if folded[axis] { 4 } else { 2 });
                let acts = |k: usize| {
                    [k / own[1], k % own[1]]
                        .iter()
                        .zip(begin)
                        .zip(count)
                        .all(|((&i, begin), count)| i >= begin && i < begin + count)
                };
                let field: Vec<f64> =
                    (0..part.len()).map(|k| if acts(k) { ((k * k + 3) as f64).sin() } else { 0.0 }).collect();
                let (mut exact, mut found) = (vec![0.0; field.len()], vec![0.0; field.len()]);
                kernel.apply(&field, &mut exact, &mut work);
                work.swap(&mut work_near);
                near.apply(&field, &mut found, &mut work);
                let most = exact.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                for k in (0..field.len()).filter(|&k| acts(k)) {
                    assert!(
                        (exact[k] - found[k]).abs() < 1e-12 * most,
                        "{cells:?}, {folded:?}, cell {k}: {} {}",
                        exact[k],
                        found[k]
                    );
                }
                let waves: Vec<f64> = (0..field.len()).map(|k| ((7 * k * k + k) as f64).cos()).collect();
                near.apply(&waves, &mut found, &mut work);
                assert!(waves.iter().zip(&found).map(|(p, v)| p * v).sum::<f64>() > 0.0);
            }
        }
    }
}
