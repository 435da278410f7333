//! How deep the bodies are pressed into a layer.

use crate::Grid;
use crate::contact::{Indenter, Region, Scene};
use crate::solver::RigidMotion;

impl Scene {
    /// Greatest displacement in contact over the thickness of a layer, as far as the layer and not its base is displaced; `None` without
    /// layer or contact. `motions` count from the datum of the gap. A call of all ranks.
    pub(in crate::contact) fn compression(
        &self,
        indenter: &Indenter,
        region: &Region,
        pressure: &[f64],
        motions: impl Fn(usize) -> RigidMotion,
    ) -> Option<f64> {
        let (layer, rows) = (self.kernel.layer_of()?, region.rows());
        let in_contact = || (0..pressure.len()).filter(|&k| pressure[k] > 0.0);
        let displaced = |k: usize| {
            let at = indenter.index(&self.grid, region, k);
            motions(indenter.gap().owner(at)).at(region.center(k)) - indenter.gap().above[at]
        };
        let cells = region.images() * rows.count(in_contact().count());
        let deepest = rows.greatest(in_contact().map(displaced).fold(0.0, f64::max));
        let share = layer.share(cells as f64 * self.grid.cell_area());
        (cells > 0).then(|| share * deepest / layer.thickness())
    }
}

impl Indenter {
    /// The index in the gap of the cell `k` of a region.
    pub(super) fn index(&self, grid: &Grid, region: &Region, k: usize) -> usize {
        let [i, j] = region.cell(k);
        if self.is_local { k } else { i * grid.cells()[1] + j }
    }
}
