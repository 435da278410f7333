//! What never changes once a contact is built.

use std::sync::Arc;

use crate::Grid;
#[cfg(feature = "checkpoint")]
use crate::contact::checkpoint::built::Built;
use crate::contact::settings::Settings;
use crate::hereditary::HistoryInputs;
use crate::kernel::InfluenceKernel;
use crate::rheology::Material;

/// Grid, kernel, material and settings of a contact. A contact and its clones share one.
#[derive(Debug)]
pub(crate) struct Scene {
    pub(super) grid: Grid,
    pub(super) kernel: Arc<InfluenceKernel>,
    pub(super) material: Material,
    pub(super) settings: Settings,
    /// Number of rigid bodies.
    pub(super) bodies: usize,
    /// Fingerprint of the gap as built.
    #[cfg(feature = "checkpoint")]
    pub(super) built: Built,
}

impl Scene {
    /// Inputs of the time rule.
    pub(super) fn history_inputs(&self) -> HistoryInputs<'_> {
        let least_side = self.grid.spacing().into_iter().fold(f64::INFINITY, f64::min);
        HistoryInputs { material: &self.material, history_limit: self.settings.history_limit, least_side }
    }
}
