//! The constants of a contact.

use crate::contact::Clock;
use crate::contact::read::limits::Limits;
use crate::equilibrium::Ground;
use crate::error::Result;
use crate::hereditary::HistoryInputs;
use crate::rheology::{CreepSpectrum, Material, TemperatureHistory};

/// The constants of a contact. A contact and its clones share one.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub(crate) ground: Ground,
    pub(crate) material: Material,
    pub(crate) limits: Limits,
    pub(crate) temperature: Option<TemperatureHistory>,
    /// Creep of bodies that the indenter moves over, and that end.
    pub(crate) creep: Option<CreepSpectrum>,
}

impl Scene {
    /// Inputs of the time rule.
    pub(crate) fn history_inputs(&self) -> HistoryInputs {
        let Ground { grid, attraction, .. } = &self.ground;
        let least_side = grid.spacing().into_iter().fold(f64::INFINITY, f64::min);
        HistoryInputs { least_side, pulls: attraction.is_some() }
    }

    /// The reduced time at a `time` not before the clock's.
    pub(crate) fn reduced_time(&self, clock: &Clock, time: f64) -> Result<f64> {
        match &self.temperature {
            None => Ok(time),
            Some(history) => Ok(clock.reduced_time + history.reduced_time(clock.time, time)?),
        }
    }

    /// The reduced time that passes between two times a `length` apart.
    pub(crate) fn reduced_length(&self, from: f64, to: f64, length: f64) -> Result<f64> {
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
