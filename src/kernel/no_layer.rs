//! In place of the room of layers where it is not compiled.

use std::fmt;

use super::InfluenceKernel;
use crate::error::Result;
use crate::{Axis, Grid};

/// A layer of finite thickness: there is none without the feature `layers`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Layer {}

impl Layer {
    pub(super) fn on_cells(self, _: &Grid, _: [bool; 2], _: Option<Axis>, _: Option<f64>) -> Result<InfluenceKernel> {
        match self {}
    }

    pub(crate) fn thickness(&self) -> f64 {
        match *self {}
    }

    pub(super) fn compliance(&self, _: f64) -> f64 {
        match *self {}
    }

    pub(crate) fn is_on_rigid(&self) -> bool {
        match *self {}
    }

    pub(crate) fn longest_over_half_space(&self) -> f64 {
        match *self {}
    }

    pub(crate) fn share(&self, _: f64) -> f64 {
        match *self {}
    }

    pub(crate) fn poisson_ratio(&self) -> f64 {
        match *self {}
    }
}

impl fmt::Display for Layer {
    fn fmt(&self, _: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {}
    }
}
