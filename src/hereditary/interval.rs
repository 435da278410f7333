//! Time steps, and what else a time rule takes.

use crate::hereditary::exponential_rule::Interpolant;

/// Inputs of a time rule besides the past.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HistoryInputs {
    /// Whether tractions may raise the surface.
    pub(crate) pulls: bool,
    /// The shorter side of a cell \[m\].
    pub(crate) least_side: f64,
}

/// A time step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    /// Its end \[s\].
    pub(crate) time: f64,
    /// Its length \[s\], 0 for a jump.
    pub(crate) length: f64,
    /// End and length in the reduced time that passes for the material; time and length without a history of the
    /// temperature.
    pub(crate) reduced: f64,
    pub(crate) dt: f64,
    /// By how many cells the bodies move under the grid.
    pub(crate) stride: [isize; 2],
    /// How u changes within it.
    pub(crate) interpolant: Interpolant,
}
