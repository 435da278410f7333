//! The waves of a shape, and what a grid misses of them.

use crate::Grid;

/// What a shape tells of its waves ([`Geometry::waves`](crate::geometry::Geometry::waves)), so that a contact warns
/// where its grid cannot hold them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waves {
    /// Lengths along x1 and x2 after which the shape repeats \[m\]; +∞ along an axis without a period.
    pub period: [f64; 2],
    /// Shortest wavelengths along x1 and x2 \[m\]; +∞ along an axis without waves.
    pub shortest: [f64; 2],
}

/// What a grid misses of the waves of shapes: `None` where it holds them.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Missed {
    /// Cells in the shortest wave, if fewer than [`LEAST_CELLS`].
    pub(crate) cells: Option<f64>,
    /// Periods of a shape in the period of the body, if no whole number.
    pub(crate) periods: Option<f64>,
}

/// Fewer cells resolve a wave badly: the pressure on its crests is off by a tenth.
const LEAST_CELLS: f64 = 4.0;
/// Relative differences of lengths below this are rounding.
const ROUNDING: f64 = 1e-6;

impl Missed {
    /// Of shapes on bodies that are `periodic` along these axes, the grid being one period.
    pub(crate) fn of(waves: &[Waves], grid: &Grid, periodic: [bool; 2]) -> Missed {
        let mut missed = Missed::default();
        // along its one cell a contact is uniform
        for axis in (0..2).filter(|&axis| grid.cells()[axis] > 1) {
            for Waves { period, shortest } in waves {
                let cells = shortest[axis] / grid.spacing()[axis];
                if cells < LEAST_CELLS * (1.0 - ROUNDING) {
                    missed.cells = Some(cells.min(missed.cells.unwrap_or(LEAST_CELLS)));
                }
                let periods = grid.lengths()[axis] / period[axis];
                let is_whole = (periods / periods.round().max(1.0) - 1.0).abs() < ROUNDING;
                if periodic[axis] && period[axis].is_finite() && !is_whole {
                    missed.periods = Some(periods);
                }
            }
        }
        missed
    }
}
