//! Time steps.

use crate::hereditary::exponential_rule::Interpolant;

/// A time step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    /// Its end \[s\].
    pub(crate) time: f64,
    /// Its length \[s\], 0 for a jump.
    pub(crate) length: f64,
    /// End and length in the reduced time that passes for the material; time and length without a history of the temperature.
    pub(crate) reduced: f64,
    pub(crate) dt: f64,
    /// By how many cells the bodies move under the grid.
    pub(crate) stride: [isize; 2],
    /// How u changes within it.
    pub(crate) interpolant: Interpolant,
}
