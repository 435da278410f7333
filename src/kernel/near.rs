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
mod tests;
