//! The constants of an elastic contact.

use std::sync::Arc;

use crate::Grid;
use crate::attraction::Attraction;
use crate::equilibrium::{Indenter, Region, Settings};
use crate::error::{Refusal, Result, count_within, missing};
use crate::kernel::{HalfSpace, InfluenceKernel};
use crate::parallel::Rows;
use crate::rounded::rounded;
use crate::solver::{Bands, Extension};

/// Grid, kernel and settings, without a material.
#[derive(Debug, Clone)]
pub(crate) struct Ground {
    pub(crate) grid: Grid,
    pub(crate) kernel: Arc<InfluenceKernel>,
    pub(crate) settings: Settings,
    /// The attraction between the surfaces.
    pub(crate) attraction: Option<Arc<dyn Attraction>>,
    /// The slope at which it softens \[Pa/m\]; 0 without one.
    pub(crate) softening: f64,
    /// Number of rigid bodies.
    pub(crate) bodies: usize,
}

impl Ground {
    /// The constants of a contact of so many bodies without attraction, on a half-space unless a kernel is given.
    ///
    /// # Errors
    /// If a setting is out of range, there is no body or too many, or the kernel belongs to another grid or cannot be
    /// made.
    pub(crate) fn of(
        grid: &Grid,
        kernel: Option<&Arc<InfluenceKernel>>,
        settings: Settings,
        bodies: usize,
    ) -> Result<Ground> {
        settings.validate()?;
        check_bodies(bodies)?;
        let kernel = match kernel {
            Some(kernel) if kernel.grid() != grid => {
                let [(made, [a, b]), (has, [c, d])] =
                    [kernel.grid(), grid].map(|grid| (grid.cells(), grid.spacing().map(|side| rounded(side, 5))));
                let what = format!(
                    "the kernel was made for {} × {} cells of {a} m × {b} m, the contact has {} × {} of {c} m × {d} m",
                    made[0], made[1], has[0], has[1]
                );
                return Err(Refusal::value("kernel_wrong_grid", what, ": make it for the grid of the contact").into());
            }
            Some(kernel) => Arc::clone(kernel),
            None => Arc::new(InfluenceKernel::half_space(grid)?),
        };
        Ok(Ground { grid: grid.clone(), kernel, settings, attraction: None, softening: 0.0, bodies })
    }

    /// The region of bodies apart: where only a window is computed, around the cells that they would touch first.
    pub(crate) fn first_region(&self, folded: [bool; 2], indenter: &Indenter, windowed: bool) -> Region {
        if windowed {
            let lowest = Region::lowest_cells(&self.grid, indenter.gap(), self.bodies);
            Region::around(&self.grid, folded, lowest, 0.0)
        } else {
            Region::whole(&self.grid, folded)
        }
    }

    /// Rejects more cells than solvers can number.
    pub(crate) fn check_cells(&self, region: &Region) -> Result<()> {
        let [m1, m2] = region.cells();
        let cells = m1.max(1).saturating_mul(m2);
        let allowed = "4294967295 at most: take fewer cells, or let symmetry and window of the Settings compute fewer";
        count_within("cells that are computed", cells, u32::try_from(cells).is_ok(), allowed)
    }

    /// Bytes of gap and pressure on the whole grid, of the solver with its preconditioner, and of kernel and work
    /// space, of a contact that is computed on a region.
    pub(crate) fn bytes_on(&self, region: &Region) -> [u64; 3] {
        // a rank without rows is counted as one row
        let cells = region.cells().map(|count| count.max(1));
        let (count, shown) = (cells[0].saturating_mul(cells[1]), region.shown_len());
        let (all, n) = (shown as u128, count as u128);
        let gap = if self.bodies > 1 { 10 } else { 8 };
        // the whole gap, which ranks do not have; its computed part; the pressure on the grid
        let whole = if region.is_shared() { 0 } else { gap * all };
        let grid = if count == shown { gap * n } else { whole + 8 * all + gap * n };
        let rows = if region.is_shared() { region.rows() } else { Rows::all(cells) };
        let [kernel, inverse, near] = self.kernel.bytes(&rows, region.folded());
        // three fields, a mark, and runs of cells
        let own = (24 + 1 + 4) * n + Bands::bytes(&Rows::all(cells), self.bodies) as u128;
        let solver = own + inverse + Extension::bytes(&rows);
        let kernel = kernel + if self.attraction.is_some() { near } else { 0 };
        [grid, solver, kernel].map(|bytes| u64::try_from(bytes).unwrap_or(u64::MAX))
    }
}

/// Rejects no rigid body, and too many.
pub(crate) fn check_bodies(bodies: usize) -> Result<()> {
    if bodies == 0 {
        return Err(missing("geometry"));
    }
    count_within("rigid bodies", bodies, u16::try_from(bodies).is_ok(), "65535 at most")
}

/// Whether only a part of the grid is computed: under pressures on half-spaces only, since the displacement outside a
/// window is bounded for these alone.
pub(crate) fn windowed(ground: &Ground) -> bool {
    let half_space = ground.kernel.half_space_below() == Some(HalfSpace::LoadedOnGrid);
    ground.settings.window && ground.attraction.is_none() && half_space
}
