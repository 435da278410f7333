//! In place of the room of temperatures where it is not compiled.

use crate::error::Result;

/// A temperature that changes in time: there is none without the feature `temperature`.
#[derive(Debug, Clone)]
pub enum TemperatureHistory {}

impl TemperatureHistory {
    pub(crate) fn slowest(&self, _: f64) -> Result<f64> {
        match *self {}
    }

    pub(crate) fn reduced_time(&self, _: f64, _: f64) -> Result<f64> {
        match *self {}
    }

    pub(crate) fn next_corner(&self, _: f64) -> Option<f64> {
        match *self {}
    }

    pub(crate) fn jumps_at(&self, _: f64) -> bool {
        match *self {}
    }

    pub(crate) fn length_of(&self, _: f64, _: f64, _: f64) -> Result<f64> {
        match *self {}
    }
}
