//! The stress on a section, and in a volume.

use super::Stress;
use crate::values::Counted;
use crate::{Axis, Grid};

/// The stress on a vertical section, see [`SubsurfaceStress::on_section`](super::SubsurfaceStress::on_section).
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub struct StressSection {
    /// The direction of the section on the surface.
    pub along: Axis,
    /// The other coordinate, constant \[m\].
    pub at: f64,
    /// Cell centres along the section \[m\].
    pub positions: Vec<f64>,
    /// Depths \[m\].
    pub depths: Vec<f64>,
    /// The stress, one for each position and depth, depths fastest: the stress below `positions[i]` at `depths[k]` is
    /// entry `i * depths.len() + k`.
    pub values: Vec<Stress>,
}

debug_by! {
    self: StressSection =>
    along: self.along, at: self.at, positions: Counted(&self.positions), depths: Counted(&self.depths),
    values: Counted(&self.values)
}

impl StressSection {
    /// A quantity of the stress, such as [`Stress::von_mises`], in the order of [`StressSection::values`].
    pub fn map(&self, quantity: impl Fn(&Stress) -> f64) -> Vec<f64> {
        self.values.iter().map(quantity).collect()
    }
}

/// The stress in a volume, see [`SubsurfaceStress::in_volume`](super::SubsurfaceStress::in_volume).
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub struct StressVolume {
    /// The grid of the surface.
    pub grid: Grid,
    /// Depths \[m\].
    pub depths: Vec<f64>,
    /// The stress, plane by plane, each in the order of fields.
    pub values: Vec<Stress>,
}

debug_by!(self: StressVolume => grid: self.grid, depths: Counted(&self.depths), values: Counted(&self.values));

impl StressVolume {
    /// The stress at the `index`-th depth, below the centre of each cell; `None` if there are not as many.
    pub fn plane(&self, index: usize) -> Option<&[Stress]> {
        self.values.chunks_exact(self.grid.len()).nth(index)
    }
}
