//! Slopes of the undeformed bodies in contact.

use crate::Grid;
use crate::equilibrium::{Indenter, Region};
use crate::solver::{HaloExchange, HaloRows};

/// Slopes beyond this are not small. Where the paraboloid of a sphere is this steep, the sphere itself is 7 % deeper.
pub(crate) const STEEP: f64 = 0.5;

/// What the slopes of the gap on the whole grid say.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slopes {
    /// Whether any cell is steep.
    any_steep: bool,
    /// Whether the bodies are flatter than real ones, but not flat.
    too_flat: bool,
}

/// The cells that a gap is on: the whole grid, or the computed cells of the local rows of a rank.
#[derive(Clone, Copy)]
struct Cells {
    spacing: [f64; 2],
    /// Number of columns.
    n2: usize,
    /// Axes along which the first row or column borders on its image.
    folded: [bool; 2],
}

impl Indenter {
    /// Maximum slope of the gap on the cells of a region that carry `pressure`, if it is steep. A call of all ranks.
    pub(crate) fn steepest(&self, grid: &Grid, region: &Region, pressure: &[f64]) -> Option<f64> {
        let whole = whole(grid);
        // most indenters are steep nowhere, and steps need not look again
        if !self.slopes(grid).any_steep {
            return None;
        }
        let cells = if self.is_local { local(region) } else { whole };
        let squared = |k: usize| self.squared_slope(cells, self.index(grid, region, k));
        let in_contact = (0..pressure.len()).filter(|&k| pressure[k] > 0.0);
        let greatest = region.rows().greatest(in_contact.map(squared).fold(0.0, f64::max));
        (greatest > STEEP * STEEP).then(|| greatest.sqrt())
    }

    /// Whether the bodies are flatter on the whole grid than real ones, though not flat.
    pub(crate) fn is_too_flat(&self, grid: &Grid) -> bool {
        self.slopes(grid).too_flat
    }

    fn slopes(&self, grid: &Grid) -> Slopes {
        *self.slopes.get_or_init(|| {
            let [squared, relief] = self.greatest_slope_and_relief(whole(grid));
            self.slopes_of(squared, relief, grid)
        })
    }

    fn slopes_of(&self, squared: f64, relief: f64, grid: &Grid) -> Slopes {
        // across a line contact the side of its one cell is a unit, not a length of the bodies
        let longest = (0..2).filter(|&k| grid.cells()[k] > 1).map(|k| grid.lengths()[k]).fold(0.0, f64::max);
        // less than a nanometre over a millimetre, or than 1e-4 of more than 0.1 m: lengths in mm or µm that are read
        // as metres
        let rises_little = squared < 1e-6 * 1e-6 || longest > 0.1 && relief < 1e-4 * longest;
        // a smaller part of the height of the lowest point is rounding
        let too_flat = squared > 0.0 && rises_little && relief > 1e-12 * self.gap.datum.abs();
        Slopes { any_steep: squared > STEEP * STEEP, too_flat }
    }

    /// Square of the maximum slope of all cells of the gap, and its largest finite height above the lowest \[m\].
    fn greatest_slope_and_relief(&self, cells: Cells) -> [f64; 2] {
        let above = &self.gap.above;
        let squared = (0..above.len()).map(|k| self.squared_slope(cells, k)).fold(0.0, f64::max);
        [squared, above.iter().copied().filter(|h| h.is_finite()).fold(0.0, f64::max)]
    }

    /// Fetches the rows of the gap beyond the local rows of a rank, and finds its slopes on all ranks. A call of all
    /// ranks.
    pub(super) fn with_rows_beyond(mut self, region: &Region) -> Indenter {
        let (rows, [_, n2]) = (region.rows(), region.cells());
        let above = &self.gap.above;
        self.beyond = HaloRows::new(&rows, |rank| rows.of(rank), [rows.cells()[0], n2], false);
        if let Some(mut exchange) = HaloExchange::new(&rows, n2) {
            let own = rows.own().len();
            exchange.fetch(&mut self.beyond, n2, own, |k, row| row.copy_from_slice(&above[k * n2..][..n2]));
        }
        let own = self.greatest_slope_and_relief(local(region));
        let [squared, relief] = own.map(|own| rows.greatest(own));
        self.slopes = self.slopes_of(squared, relief, &region.whole).into();
        self
    }

    /// Square of the slope of the gap in a cell: along each axis the lesser of the slopes to both neighbours on the
    /// same body.
    fn squared_slope(&self, Cells { spacing, n2, folded }: Cells, k: usize) -> f64 {
        let (gap, j) = (&self.gap, k % n2);
        let above = &gap.above;
        let on_body =
            |side: Option<usize>| side.filter(|&side| gap.owner(side) == gap.owner(k)).map(|side| above[side]);
        let image = |axis: usize| folded[axis].then_some(above[k]);
        let row_before = || self.beyond.before().map(|row| row[j]).or(image(0));
        let row_after = || self.beyond.after().map(|row| row[j]);
        let sides = [
            [
                if k >= n2 { on_body(Some(k - n2)) } else { row_before() },
                if k + n2 < above.len() { on_body(Some(k + n2)) } else { row_after() },
            ],
            [if j > 0 { on_body(Some(k - 1)) } else { image(1) }, on_body((j + 1 < n2).then_some(k + 1))],
        ];
        let along = |axis: usize| {
            let rises =
                sides[axis].iter().flatten().map(|side| (side - above[k]).abs()).filter(|rise| rise.is_finite());
            rises.reduce(f64::min).unwrap_or(0.0) / spacing[axis]
        };
        along(0).powi(2) + along(1).powi(2)
    }
}

/// The cells of the whole grid.
fn whole(grid: &Grid) -> Cells {
    Cells { spacing: grid.spacing(), n2: grid.cells()[1], folded: [false; 2] }
}

/// The cells of a region of local rows.
fn local(region: &Region) -> Cells {
    Cells { spacing: region.grid().spacing(), n2: region.cells()[1], folded: region.folded() }
}
