//! The stress on a section, and in a volume.

use educe::Educe;

use super::Stress;
use crate::values::counted;
use crate::{Axis, Grid};

/// The stress on a vertical section, see [`SubsurfaceStress::on_section`](super::SubsurfaceStress::on_section).
#[derive(Clone, PartialEq, Educe)]
#[educe(Debug)]
#[non_exhaustive]
pub struct StressSection {
    /// The direction of the section on the surface.
    pub along: Axis,
    /// The other coordinate, constant \[m\].
    pub at: f64,
    /// Cell centres along the section \[m\].
    #[educe(Debug(method(counted)))]
    pub positions: Vec<f64>,
    /// Depths \[m\].
    #[educe(Debug(method(counted)))]
    pub depths: Vec<f64>,
    /// The stress, one for each position and depth, depths fastest: the stress below `positions[i]` at `depths[k]` is entry
    /// `i * depths.len() + k`.
    #[educe(Debug(method(counted)))]
    pub values: Vec<Stress>,
}

impl StressSection {
    /// A quantity of the stress, such as [`Stress::von_mises`], in the order of [`StressSection::values`].
    pub fn map(&self, quantity: impl Fn(&Stress) -> f64) -> Vec<f64> {
        self.values.iter().map(quantity).collect()
    }
}

/// The stress in a volume, see [`SubsurfaceStress::in_volume`](super::SubsurfaceStress::in_volume).
#[derive(Clone, PartialEq, Educe)]
#[educe(Debug)]
#[non_exhaustive]
pub struct StressVolume {
    /// The grid of the surface.
    pub grid: Grid,
    /// Depths \[m\].
    #[educe(Debug(method(counted)))]
    pub depths: Vec<f64>,
    /// The stress, plane by plane, each in the order of fields.
    #[educe(Debug(method(counted)))]
    pub values: Vec<Stress>,
}

impl StressVolume {
    /// The stress at the `index`-th depth, below the centre of each cell; `None` if there are not as many.
    pub fn plane(&self, index: usize) -> Option<&[Stress]> {
        self.values.chunks_exact(self.grid.len()).nth(index)
    }
}
