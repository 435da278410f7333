//! The memory that a contact takes, computed before it is built.

use std::fmt;

use crate::contact::indenter::even_axes;
use crate::contact::settings::{Settings, Solver};
use crate::contact::window::placement::MAX_WINDOW_FRACTION;
use crate::contact::window::region::Region;
use crate::error::{Result, count_within};
use crate::hereditary;
use crate::kernel::InfluenceKernel;
use crate::memory;
use crate::parallel::Rows;
use crate::solver::{Bands, Extension};

/// Bytes that a contact takes, made by [`Builder::memory`](crate::contact::Builder::memory) before it is built.
///
/// Bytes per computed cell, by default:
///
/// | | |
/// |---|---|
/// | state and trial step | 73 |
/// | history | 8 per relaxation time, and 8 for the change in the last step (16 without elastic response, none of an elastic body); with [`Frame::Indenter`](crate::contact::Frame::Indenter) 40, 16 per relaxation time and 24 (48, none); direct sums: 8 per step taken ([`TimeRule::RectangleUncached`](crate::contact::TimeRule::RectangleUncached) 8 more) |
/// | displacement outside a window | 16, and the history again |
/// | solver | 29, as [`Solver::PolonskyKeer`]; for each body 0.02 more |
/// | its preconditioner | 7.4, none of [`Solver::PolonskyKeer`]: a quarter of a spectrum of the grid without padding, 2, and the extension of the residual, 5.4, and 12 per column for each thread |
/// | kernel | 25: a quarter of the padded spectrum, 8, and work space, 17 |
/// | transforms on several threads | 16 more |
///
/// and per cell of the whole grid 8 for the gap, 8 for the pressure where not all cells are computed, 2 if there are several
/// bodies. Transforms need tables of their own length, which counts in line contacts: 144 bytes per cell.
///
/// Counted allocations agree to 5 % and a few kB (`tests/allocations`). Not included: 8 bytes per computed cell from the first
/// adaptive step of a body with elastic response and memory (16 with a window, 24 with
/// [`Frame::Indenter`](crate::contact::Frame::Indenter)); the displacement where not all cells are
/// computed, made on first use, with a kernel for the whole grid; 8 bytes per computed cell from the first load that tilts,
/// or presses several bodies; [snapshots](crate::contact::Snapshot); the old state during a step that moves to a larger
/// window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Memory {
    /// Cells that are computed: with [`Settings::symmetry`] perhaps half or a quarter of the grid, with
    /// [`Settings::window`] at most.
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
    /// Bytes that each further step adds: fields of direct sums, up to [`Settings::history_limit`].
    pub each_step: u64,
}

impl Memory {
    /// All bytes of the contact as it is built, or, with [`Settings::window`], when its window has grown to the most.
    pub fn total(&self) -> u64 {
        let Memory { grid, state, history, solver, kernel, .. } = *self;
        [grid, state, history, solver, kernel].into_iter().fold(0, u64::saturating_add)
    }
}

/// The memory in MB, in total and by part.
impl fmt::Display for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mb = |bytes: u64| bytes as f64 * 1e-6;
        let Memory { computed_cells, grid, state, history, solver, kernel, each_step } = *self;
        write!(
            f,
            "{:.1} MB with {computed_cells} cells computed (gap and pressure on the grid {:.1}, state {:.1}, history {:.1}, \
             solver {:.1}, kernel {:.1})",
            mb(self.total()),
            mb(grid),
            mb(state),
            mb(history),
            mb(solver),
            mb(kernel)
        )?;
        if each_step > 0 { write!(f, ", {:.1} MB more with each step", mb(each_step)) } else { Ok(()) }
    }
}

/// What the memory of a contact depends on, besides the cells that are computed.
pub(in crate::contact) struct Footprint<'a> {
    /// Cells of the whole grid.
    pub(in crate::contact) all: usize,
    pub(in crate::contact) bodies: usize,
    pub(in crate::contact) settings: &'a Settings,
    pub(in crate::contact) kernel: &'a InfluenceKernel,
    /// The time rule of the history.
    pub(in crate::contact) history: &'a hereditary::History,
}

/// Cells that a contact is computed on.
pub(in crate::contact) struct Computed {
    pub(in crate::contact) cells: [usize; 2],
    pub(in crate::contact) folded: [bool; 2],
    /// Whether the cells and their mirror images are the whole grid.
    pub(in crate::contact) covers: bool,
    /// The rows of all ranks that share them out; the cells are the local ones.
    pub(in crate::contact) shared: Option<Rows>,
}

impl Computed {
    pub(in crate::contact) fn on(region: &Region) -> Computed {
        // a rank without rows has about as little as one row takes
        let cells = region.cells().map(|count| count.max(1));
        let shared = region.is_shared().then(|| region.rows());
        Computed { cells, folded: region.folded(), covers: region.covers(), shared }
    }
}

impl Footprint<'_> {
    /// Bytes of a contact that is computed on these cells.
    pub(in crate::contact) fn on(&self, computed: &Computed) -> Memory {
        let &Computed { cells, folded, covers, ref shared } = computed;
        let count = cells[0].saturating_mul(cells[1]);
        let (all, n, bodies) = (self.all as u128, count as u128, self.bodies as u128);
        let gap = if bodies > 1 { 10 } else { 8 };
        // the whole of it, which ranks do not have, what is computed of it, and the pressure that is shown
        let whole = if shared.is_some() { 0 } else { gap * all };
        let grid = if count == self.all { gap * n } else { whole + 8 * all + gap * n };
        // the state counts two fields of it
        let history = 8 * self.history.values_per_cell(!covers).saturating_sub(2) as u128 * n;
        let rows = shared.clone().unwrap_or_else(|| Rows::all(cells));
        let [kernel, inverse] = self.kernel.bytes(&rows, folded);
        let sums = Bands::bytes(&Rows::all(cells), self.bodies) as u128;
        let solver = match self.settings.solver {
            // three fields, a mark, and runs of cells
            Solver::ActiveSet => (24 + 1 + 4) * n + sums + inverse + Extension::bytes(&rows),
            // three fields, a mark, and runs of cells
            Solver::PolonskyKeer => (24 + 1 + 4) * n + sums,
        };
        let saturated = |bytes: u128| u64::try_from(bytes).unwrap_or(u64::MAX);
        Memory {
            computed_cells: count,
            grid: saturated(grid),
            // pressure and K p now, before and tried; displacement now and before; the gap
            state: saturated(73 * n),
            history: saturated(history),
            solver: saturated(solver),
            kernel: saturated(kernel),
            each_step: if self.history.grows() { saturated(8 * n) } else { 0 },
        }
    }

    /// Rejects more cells than solvers can number, and more memory than there is, `besides` included \[bytes\].
    pub(in crate::contact) fn check(&self, computed: &Computed, besides: u64) -> Result<()> {
        let memory = self.on(computed);
        let cells = memory.computed_cells;
        let allowed = "4294967295 at most: take fewer cells, or let symmetry and window of the Settings compute fewer";
        count_within("cells that are computed", cells, u32::try_from(cells).is_ok(), allowed)?;
        memory::check("the contact", u128::from(memory.total()) + u128::from(besides))
    }

    /// The most bytes that the contact can take while the axes `folded` stay so.
    pub(in crate::contact) fn most(&self, cells: [usize; 2], folded: [bool; 2], windowed: bool) -> Memory {
        let cells = [0, 1].map(|axis| if folded[axis] { cells[axis] / 2 } else { cells[axis] });
        let whole = self.on(&Computed { cells, folded, covers: true, shared: None });
        if !windowed {
            return whole;
        }
        // the largest window, beyond which it is all of the grid
        let part = (cells[0] as f64 * MAX_WINDOW_FRACTION).ceil() as usize;
        let window = self.on(&Computed { cells: [part, cells[1]], folded, covers: false, shared: None });
        if window.total() > whole.total() { window } else { whole }
    }
}

/// Axes about whose middle the gap of all bodies together is even, bitwise.
pub(in crate::contact) fn symmetry_of(gaps: &[&Vec<f64>], cells: [usize; 2]) -> [bool; 2] {
    // the lowest body, and the first of several as low
    let lowest = |k: usize| {
        let own = gaps.iter().map(|gap| gap[k]).enumerate();
        own.fold((0, f64::INFINITY), |lowest, (body, h)| if h < lowest.1 { (body, h) } else { lowest })
    };
    let datum = gaps.iter().flat_map(|gap| gap.iter()).copied().fold(f64::INFINITY, f64::min);
    even_axes(cells, |k, mirror| {
        let (own, image) = (lowest(k), lowest(mirror));
        own.0 == image.0 && own.1 - datum == image.1 - datum
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::error::Error;
    use crate::rheology::CreepSpectrum;

    /// Solvers number the cells that are computed in 32 bits, whatever memory there is.
    #[test]
    fn no_more_cells_are_computed_than_can_be_numbered() {
        let creep = CreepSpectrum::new(1.0, 1.0, &[]).unwrap();
        let (settings, history) = (Settings::default(), hereditary::History::exponential(&creep));
        for cells in [[65536, 65536], [1 << 32, 1], [131072, 65536]] {
            let kernel = InfluenceKernel::half_space(&Grid::new(cells, [1.0, 1.0]).unwrap()).unwrap();
            let all = cells[0] * cells[1];
            let footprint = Footprint { all, bodies: 1, settings: &settings, kernel: &kernel, history: &history };
            let whole = Computed { cells, folded: [false; 2], covers: true, shared: None };
            let refused = footprint.check(&whole, 0).unwrap_err();
            assert!(matches!(refused, Error::CountOutOfRange { value, .. } if value == all), "{refused}");
            // a small part of them may be, in the memory of gap and pressure
            let part = Computed { cells: [64, 1], folded: [false; 2], covers: false, shared: None };
            assert!((16 * all as u64..16 * all as u64 + 100_000).contains(&footprint.on(&part).total()));
        }
    }
}
