//! The pressure of an elastic state.

use crate::error::{Error, Result};

/// Greatest fall of a pressure, over the greatest pressure, that is always taken for an error of the solver.
const ALLOWED_FALL: f64 = 1e-4;
/// The same over the tolerance of a solver.
const OVER_TOLERANCE: f64 = 1e2;

/// Fall of a pressure, over the greatest, that is taken for an error of a solver of this tolerance.
pub(super) fn allowed_fall(tolerance: f64) -> f64 {
    ALLOWED_FALL.max(OVER_TOLERANCE * tolerance)
}

/// The cells in contact, in ascending order, and their pressures: 12 bytes a cell.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pressed {
    pub(crate) cells: Vec<u32>,
    pub(crate) pressures: Vec<f64>,
}

impl Pressed {
    pub(crate) fn new(pressure: &[f64]) -> Pressed {
        let cells: Vec<u32> = (0..).zip(pressure).filter(|(_, p)| **p > 0.0).map(|(cell, _)| cell).collect();
        let pressures = cells.iter().map(|&cell| pressure[cell as usize]).collect();
        Pressed { cells, pressures }
    }

    pub(super) fn is_on_the_cells_of(&self, other: &Pressed) -> bool {
        self.cells == other.cells
    }

    /// Nowhere may the pressure fall from here to `after`, while the load grows from the first level to the second,
    /// by more than this share of the greatest.
    pub(crate) fn check_growth(&self, after: &Pressed, levels: [f64; 2], allowed: f64) -> Result<()> {
        let fall = self.greatest_fall_to(after);
        if fall > allowed { Err(Error::Shrinks { levels, fall, allowed }) } else { Ok(()) }
    }

    /// Greatest fall of the pressure of a cell from here to `after`, over the greatest pressure there.
    fn greatest_fall_to(&self, after: &Pressed) -> f64 {
        let mut there = after.cells.iter().zip(&after.pressures).peekable();
        let (mut fall, mut greatest) = (0.0f64, 0.0f64);
        for (cell, before) in self.cells.iter().zip(&self.pressures) {
            while there.next_if(|(other, _)| *other < cell).is_some() {}
            let now = there.next_if(|(other, _)| *other == cell).map_or(0.0, |(_, pressure)| *pressure);
            fall = fall.max(before - now);
        }
        after.pressures.iter().for_each(|pressure| greatest = greatest.max(*pressure));
        fall / greatest
    }

    /// Adds `share` of the pressures to a field on all cells.
    pub(super) fn add_to(&self, share: f64, field: &mut [f64]) {
        self.cells.iter().zip(&self.pressures).for_each(|(&cell, pressure)| field[cell as usize] += share * pressure);
    }
}
