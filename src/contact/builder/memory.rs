//! The memory that a contact takes, computed before it is built.

use std::fmt;
use std::sync::Arc;

use crate::contact::step::attraction::Attracted;
use crate::contact::{Scene, State};
use crate::equilibrium::window::placement::MAX_WINDOW_FRACTION;
use crate::equilibrium::{Indenter, Region, Trial};
use crate::error::Result;
use crate::geometry::Gap;
use crate::hereditary::History;
use crate::memory;

/// Bytes that a contact takes, made by [`Builder::memory`](crate::contact::Builder::memory) before it is built.
///
/// Bytes per computed cell, by default:
///
/// | | |
/// |---|---|
/// | state and trial step | 73 |
/// | history | 8 per relaxation time, and 8 for the change in the last step (16 without elastic response, none of an elastic body); with [`Frame::Indenter`](crate::contact::Frame::Indenter) 40, 16 per relaxation time and 24 (48, none) |
/// | displacement outside a window | 16, and the history again |
/// | solver | 29; for each body 0.02 more |
/// | its preconditioner | 7.4: a quarter of a spectrum of the grid without padding, 2 per cell of the grid, and the extension of the residual, 5.4, and 12 per column for each thread |
/// | kernel | 25: a quarter of the padded spectrum, 8 per cell of the grid, and work space, 17 |
/// | transforms on several threads | 16 more |
/// | attraction between surfaces | 76: its traction at both ends of a step and in the trial, 24, what its steps work in, 48, and the near field of the kernel and its inverse, 4, and 400 to 480 bytes a column for each thread |
///
/// and per cell of the whole grid 8 for the gap, 2 if there are several bodies; where not all cells are computed, 8 more
/// for the pressure, and 8 per computed cell for its part of the gap. Transforms need tables of their own length, which counts in line contacts: 144 bytes per cell.
///
/// Counted allocations agree to 5 % and a few kB (`tests/allocations`). Not included: 8 bytes per computed cell from
/// the first adaptive step of a body with elastic response and memory (16 with a window, 24 with
/// [`Frame::Indenter`](crate::contact::Frame::Indenter)); the displacement where not all cells are
/// computed, made on first use, with a kernel for the whole grid; 8 bytes per computed cell from the first load that
/// tilts, or presses several bodies; [snapshots](crate::contact::Snapshot); the old state during a step that moves to
/// a larger window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Memory {
    /// Cells that are computed: with [`Settings::symmetry`](crate::contact::Settings::symmetry) perhaps half or a
    /// quarter of the grid, with
    /// [`Settings::window`](crate::contact::Settings::window) at most.
    pub computed_cells: usize,
    /// Bytes of gap and pressure on the whole grid.
    pub grid: u64,
    /// Bytes of state and trial step.
    pub state: u64,
    /// Bytes of the past of the bodies.
    pub history: u64,
    /// Bytes of the solver and its preconditioner.
    pub solver: u64,
    /// Bytes of the work space of the kernel, and of its spectrum, unless another contact with the same kernel has made
    /// that already.
    pub kernel: u64,
}

impl Memory {
    /// All bytes of the contact as it is built, or, with [`Settings::window`](crate::contact::Settings::window), when
    /// its window has grown to the most.
    pub fn total(&self) -> u64 {
        let Memory { grid, state, history, solver, kernel, .. } = *self;
        [grid, state, history, solver, kernel].into_iter().fold(0, u64::saturating_add)
    }
}

/// The memory in MB, in total and by part.
impl fmt::Display for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Memory { computed_cells, grid, state, history, solver, kernel } = *self;
        let mb = |bytes: u64| bytes as f64 * 1e-6;
        let [total, grid, state, history, solver, kernel] =
            [self.total(), grid, state, history, solver, kernel].map(mb);
        write!(f, "{total:.1} MB with {computed_cells} cells computed (gap and pressure on the grid {grid:.1}, ")?;
        write!(f, "state {state:.1}, history {history:.1}, solver {solver:.1}, kernel {kernel:.1})")
    }
}

impl Scene {
    /// Bytes of a contact that is computed on a region, with a history of this time rule.
    pub(in crate::contact) fn memory_on(&self, history: &History, region: &Region) -> Memory {
        // a rank without rows is counted as one row
        let cells = region.cells().map(|count| count.max(1));
        let (count, attracts) = (cells[0].saturating_mul(cells[1]), self.ground.attraction.is_some());
        let [grid, solver, kernel] = self.ground.bytes_on(region);
        let indenter = Arc::new(Indenter::new(Gap::default(), self.ground.bodies));
        let layout = State::layout(indenter, region.clone(), history, attracts);
        let passes = if attracts { Attracted::bytes_per_cell() } else { 0 };
        // the displacement at both ends of a step counts as state
        let [per_cell, of_history] = [layout.values_per_cell(), layout.history.values_per_cell() - 2].map(|n| 8 * n);
        let of_cells = |bytes: usize| u64::try_from(bytes as u128 * count as u128).unwrap_or(u64::MAX);
        Memory {
            computed_cells: count,
            grid,
            state: of_cells(per_cell - of_history + Trial::BYTES_PER_CELL + passes),
            history: of_cells(of_history),
            solver,
            kernel,
        }
    }

    /// Rejects more cells than solvers can number, and more memory than there is, `besides` included \[bytes\].
    pub(in crate::contact) fn check_memory(&self, history: &History, region: &Region, besides: u64) -> Result<()> {
        let memory = self.memory_on(history, region);
        self.ground.check_cells(region)?;
        memory::check("the contact", u128::from(memory.total()) + u128::from(besides))
    }

    /// The most bytes that the contact can take while the axes `folded` stay so.
    pub(in crate::contact) fn most_memory(&self, history: &History, folded: [bool; 2]) -> Memory {
        let all = Region::whole(&self.ground.grid, folded);
        let whole = self.memory_on(history, &all);
        if !windowed(self, history) {
            return whole;
        }
        // the largest window, beyond which it is all of the grid
        let [rows, columns] = all.cells();
        let rows = (rows as f64 * MAX_WINDOW_FRACTION).ceil() as usize;
        let window = self.memory_on(history, &Region::of_size(&self.ground.grid, folded, [rows, columns]));
        if window.total() > whole.total() { window } else { whole }
    }
}

/// Whether only a part of the grid is computed.
pub(in crate::contact) fn windowed(scene: &Scene, history: &History) -> bool {
    history.has_far_field() && crate::equilibrium::windowed(&scene.ground)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::contact::ViscoelasticContact;
    use crate::error::Error;
    use crate::rheology::{CreepSpectrum, Material};

    /// Solvers number the cells that are computed in 32 bits, whatever memory there is.
    #[test]
    fn no_more_cells_are_computed_than_can_be_numbered() {
        let body = Material::incompressible(CreepSpectrum::new(1.0, 1.0, &[]).unwrap());
        for cells in [[65536, 65536], [1 << 32, 1], [131072, 65536]] {
            let grid = Grid::new(cells, [1.0, 1.0]).unwrap();
            let builder = ViscoelasticContact::builder(grid.clone()).material(body.clone());
            let ((scene, history), all) = (builder.scene(1).unwrap(), cells[0] * cells[1]);
            let refused = scene.check_memory(&history, &Region::whole(&grid, [false; 2]), 0).unwrap_err();
            assert!(matches!(refused, Error::CountOutOfRange { value, .. } if value == all), "{refused}");
            // a small part of them may be, in the memory of gap and pressure
            let part = Region::of_size(&grid, [false; 2], [64, 1]);
            assert!((16 * all as u64..16 * all as u64 + 100_000).contains(&scene.memory_on(&history, &part).total()));
        }
    }
}
