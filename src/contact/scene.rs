//! What never changes once a contact is built.

use std::sync::Arc;

use crate::Grid;
#[cfg(feature = "checkpoint")]
use crate::contact::checkpoint::built::Built;
use crate::contact::settings::Settings;
use crate::hereditary::Bodies;
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
    /// What tells it from other scenes, as far as steps change it.
    #[cfg(feature = "checkpoint")]
    pub(super) built: Built,
}

impl Scene {
    /// What the memory of the bodies needs of it.
    pub(super) fn creeping_bodies(&self) -> Bodies<'_> {
        Bodies { material: &self.material, history_limit: self.settings.history_limit }
    }
}
