//! Where a contact presses.

use crate::equilibrium::resolution::{Outline, Resolution};
use crate::equilibrium::{Ground, Indenter, Region};
use crate::extent::Extent;

/// Bodies whose cells are counted together.
const TOGETHER: usize = 8;

/// Where a solution presses: found before the state changes, since all ranks take part.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pressed {
    /// Number of pressed cells of the region.
    pub(crate) cells: usize,
    /// The rectangle of the grid that holds them.
    pub(crate) reach: Option<Extent>,
    /// Cells across the contact of the body with the fewest, if they are few.
    pub(crate) few: Option<f64>,
}

impl Pressed {
    /// Where a pressure on a region presses. A call of all ranks.
    pub(crate) fn by(pressure: &[f64], ground: &Ground, region: &Region, indenter: &Indenter) -> Pressed {
        let Ground { grid, kernel, bodies, .. } = ground;
        let (rows, periodic) = (region.rows(), kernel.periodic_axes());
        let (ends, images) = (region.ends(periodic), region.images());
        let outline = Outline { rows: &rows, pressure, ends, images };
        let (resolution, cells, own) = outline.resolution();
        let few = |resolution: Resolution, extent: Extent| resolution.few(extent, grid.cells(), periodic);
        let reach = region.reach_of(own);
        if *bodies == 1 {
            return Pressed { cells, reach, few: reach.and_then(|reach| few(resolution, reach)) };
        }
        let body = |k: usize| indenter.gap().owner(indenter.index(grid, region, k));
        let each = (0..*bodies).step_by(TOGETHER).flat_map(|first| outline.resolutions::<TOGETHER>(first, body));
        let each = each.filter_map(|(resolution, extent)| few(resolution, region.shown_extent(extent?)));
        Pressed { cells, reach, few: each.reduce(f64::min) }
    }
}
