//! The constants of a contact.

use std::sync::Arc;

use crate::Grid;
use crate::adhesion::Attraction;
#[cfg(feature = "checkpoint")]
use crate::contact::checkpoint::built::Built;
use crate::contact::read::limits::Limits;
use crate::contact::{Clock, Settings};
use crate::error::Result;
use crate::hereditary::HistoryInputs;
use crate::kernel::InfluenceKernel;
use crate::rheology::{Material, TemperatureHistory};

/// Grid, kernel, material and settings of a contact. A contact and its clones share one.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub(crate) grid: Grid,
    pub(crate) kernel: Arc<InfluenceKernel>,
    pub(crate) material: Material,
    pub(crate) limits: Limits,
    pub(crate) settings: Settings,
    pub(crate) temperature: Option<TemperatureHistory>,
    /// The attraction between the surfaces.
    pub(crate) attraction: Option<Arc<dyn Attraction>>,
    /// The slope at which it softens \[Pa/m\]; 0 without one.
    pub(crate) softening: f64,
    /// Whether the contact shows steady motions, and takes no steps.
    pub(crate) steady: bool,
    /// Number of rigid bodies.
    pub(crate) bodies: usize,
    /// Fingerprint of the gap as built.
    #[cfg(feature = "checkpoint")]
    pub(crate) built: Built,
}

impl Scene {
    /// Inputs of the time rule.
    pub(crate) fn history_inputs(&self) -> HistoryInputs<'_> {
        let least_side = self.grid.spacing().into_iter().fold(f64::INFINITY, f64::min);
        let (material, history_limit) = (&self.material, self.settings.history_limit);
        HistoryInputs { material, history_limit, least_side, pulls: self.attraction.is_some() }
    }

    /// The reduced time at a `time` not before the clock's.
    pub(crate) fn reduced_time(&self, clock: &Clock, time: f64) -> Result<f64> {
        match &self.temperature {
            None => Ok(time),
            Some(history) => Ok(clock.reduced_time + history.reduced_time(clock.time, time)?),
        }
    }

    /// The reduced time that passes between two times a `length` apart.
    pub(crate) fn reduced_length(&self, [from, to]: [f64; 2], length: f64) -> Result<f64> {
        match &self.temperature {
            Some(history) if length > 0.0 => history.reduced_time(from, to),
            _ => Ok(length),
        }
    }

    /// Approximate time in which the reduced time grows by `reduced` after the clock's, at most `most`.
    pub(crate) fn length_of(&self, clock: &Clock, reduced: f64, most: f64) -> Result<f64> {
        match &self.temperature {
            None => Ok(reduced.min(most)),
            Some(history) => history.length_of(clock.time, reduced, most),
        }
    }
}
