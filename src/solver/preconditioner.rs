//! An approximate inverse of the kernel.

use std::sync::Arc;

use super::{Attenuation, ContactSet, Extension, ExtensionKind};
use crate::kernel::{LocalKernel, SpectralOperator, TransformWorkspace, Workspace};

/// Eᵀ M E ≈ (K on A)⁻¹, with M ≈ K⁻¹, a multiplication in wave space on a grid without padding
/// ([`LocalKernel::inverse`]): for the half-space a quarter of the size of a convolution.
///
/// M alone, cut off at the edge of the set A of cells in contact, would be wrong over a strip along the edge, a cell
/// wide, and the more so the finer the mesh. The [`Extension`] E continues the residual smoothly beyond the edge
/// instead; on a layer no farther than the layer is thick ([`attenuation`]).
#[derive(Debug, Clone)]
pub(crate) struct Preconditioner {
    operator: Arc<SpectralOperator>,
    work: TransformWorkspace,
    /// The diagonal of M.
    pub(crate) diagonal: f64,
    extension: Extension,
    /// The version of A that `extension` is made for.
    version: u64,
}

impl Preconditioner {
    /// The preconditioner of a kernel, whose buffers it borrows.
    pub(crate) fn new(kernel: &LocalKernel, lender: &mut Workspace) -> Preconditioner {
        let (rows, [n1, n2]) = (kernel.rows(), kernel.rows().cells());
        let (operator, work) = kernel.inverse();
        let extension = Extension::new(rows, kernel.periodic_axes(), attenuation(kernel));
        let mut preconditioner =
            Preconditioner { operator: Arc::new(operator), work, diagonal: 0.0, extension, version: 0 };
        let mut impulse = vec![0.0; kernel.grid().len()];
        // in the middle, as far as possible from its mirror images
        let own_row = (n1 / 2).checked_sub(rows.own().start).filter(|_| rows.own().contains(&(n1 / 2)));
        let middle = own_row.map(|row| row * n2 + n2 / 2);
        middle.into_iter().for_each(|k| impulse[k] = 1.0);
        preconditioner.filter(&mut impulse, lender);
        preconditioner.diagonal = rows.greatest(middle.map_or(f64::NEG_INFINITY, |k| impulse[k]));
        preconditioner
    }

    /// field ← Eᵀ M E field, which is zero outside A.
    pub(crate) fn apply(&mut self, field: &mut [f64], set: &ContactSet, lender: &mut Workspace) {
        self.fit(set);
        self.extension.extend(field, &set.member);
        self.filter(field, lender);
        self.extension.gather(field, &set.member, ExtensionKind::Attenuated);
    }

    /// field ← Eᵀ field: the values of other cells are moved to the cells of A around them, whose sum becomes the sum
    /// over all cells.
    pub(crate) fn gather(&mut self, field: &mut [f64], set: &ContactSet) {
        self.fit(set);
        self.extension.gather(field, &set.member, ExtensionKind::Unbounded);
    }

    /// out ← Eᵀ of the values of `field` outside A: they are moved to the cells of A around them.
    pub(crate) fn gather_outside(&mut self, field: &[f64], set: &ContactSet, out: &mut [f64]) {
        out.copy_from_slice(field);
        set.segments.cells().for_each(|k| out[k] = 0.0);
        self.gather(out, set);
    }

    fn fit(&mut self, set: &ContactSet) {
        if std::mem::replace(&mut self.version, set.version) != set.version {
            self.extension.fit(&set.member);
        }
    }

    /// field ← M field.
    pub(crate) fn filter(&mut self, field: &mut [f64], lender: &mut Workspace) {
        self.operator.apply_beside(field, &mut self.work, &mut lender.0);
    }
}

/// Range of the extension of the residual. For wavelengths beyond its thickness a layer on a half-space responds like
/// the half-space. One on a rigid base acts as a bed of springs, which needs no extension, or, if it is incompressible,
/// as −∇⁻², whose pressure falls to zero at the edge: then the residual continues with the opposite sign. A fifth of
/// that suits both.
fn attenuation(kernel: &LocalKernel) -> Option<Attenuation> {
    let layer = kernel.whole.layer_of()?;
    let remains = -0.2 + 1.2 * layer.longest_over_half_space();
    let (cells, spacing) = (kernel.rows().cells(), kernel.grid().spacing());
    // blocks are as long as broad in cells
    let side = match cells {
        [_, 1] => spacing[0],
        [1, _] => spacing[1],
        _ => (spacing[0] * spacing[1]).sqrt(),
    };
    (remains < 1.0).then(|| Attenuation { reach: layer.thickness() / side, remains })
}
