//! The part of the grid that is computed.

use std::ops::Range;

use crate::Grid;
use crate::equilibrium::resolution::Ends;
use crate::extent::Extent;
use crate::geometry::Gap;
use crate::kernel::images;
use crate::parallel::Rows;
use crate::solver::{Freedom, Modes};

/// A rectangle of cells; where the scene is symmetric, half or a quarter of it. Elsewhere fields are mirror images,
/// or there is no contact.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Region {
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::grid::saved"))]
    pub(crate) whole: Grid,
    /// Its cells, with the coordinates of the whole.
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::grid::saved"))]
    grid: Grid,
    /// Its first cell.
    pub(super) first: [usize; 2],
    /// Axes along which every field is even about the middle: only the upper half is computed.
    pub(super) folded: [bool; 2],
    /// The rows of all ranks where they are shared out; then its cells are the local ones.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    shared: Option<Rows>,
}

impl Region {
    fn new(whole: &Grid, folded: [bool; 2], first: [usize; 2], cells: [usize; 2]) -> Region {
        Region { whole: whole.clone(), grid: whole.part(first, cells), first, folded, shared: None }
    }

    /// All of `grid`, except for mirror images along folded axes, which have an even number of cells.
    pub(crate) fn whole(grid: &Grid, folded: [bool; 2]) -> Region {
        let all = grid.cells();
        let first = [0, 1].map(|axis| if folded[axis] { all[axis] / 2 } else { 0 });
        Region::new(grid, folded, first, [0, 1].map(|axis| all[axis] - first[axis]))
    }

    /// A part of [`Region::whole`] with so many cells.
    pub(crate) fn of_size(grid: &Grid, folded: [bool; 2], cells: [usize; 2]) -> Region {
        Region::new(grid, folded, Region::whole(grid, folded).first, cells)
    }

    /// All of `grid`, as [`Region::whole`], its rows shared out between the ranks of the grid.
    pub(crate) fn shared(grid: &Grid, folded: [bool; 2], rows: &Rows) -> Region {
        let Region { first: [start, first], grid: part, .. } = Region::whole(grid, folded);
        let [n1, n2] = part.cells();
        let rows = rows.of_cells([n1, n2]);
        let own = Region::new(grid, folded, [start + rows.own().start, first], [rows.own().len(), n2]);
        Region { shared: Some(rows), ..own }
    }

    /// The local rows of it, if ranks share out the rows of `own`, or all of it.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn shared_like(self, own: &Region) -> Region {
        match &own.shared {
            Some(rows) => Region::shared(&self.whole, self.folded, rows),
            None => self,
        }
    }

    /// The region that the gap of an indenter is on: the whole grid, or the local rows of ranks.
    pub(crate) fn of_gap(&self) -> Region {
        if self.is_shared() { self.clone() } else { Region::whole(&self.whole, [false; 2]) }
    }

    /// A region of suitable size that holds these cells of the whole grid, and a fraction `margin` more along each
    /// axis.
    pub(crate) fn around(grid: &Grid, folded: [bool; 2], held: Extent, margin: f64) -> Region {
        let (mut first, mut cells) = ([0; 2], [0; 2]);
        for axis in 0..2 {
            let (n, middle) = (grid.cells()[axis], grid.cells()[axis] / 2);
            let (low, high) = (held.low[axis], held.high[axis]);
            let extent = if folded[axis] {
                (high + 1).saturating_sub(middle).max(middle.saturating_sub(low))
            } else {
                high + 1 - low
            };
            let wanted = suitable((extent as f64 * (1.0 + margin)).ceil() as usize + 1);
            if folded[axis] {
                (first[axis], cells[axis]) = (middle, wanted.min(n - middle));
            } else {
                cells[axis] = wanted.min(n);
                first[axis] = (low + extent / 2).saturating_sub(cells[axis] / 2).min(n - cells[axis]);
            }
        }
        Region::new(grid, folded, first, cells)
    }

    /// The least rectangle that holds the lowest cell of each body.
    pub(crate) fn lowest_cells(grid: &Grid, gap: &Gap, bodies: usize) -> Extent {
        let n2 = grid.cells()[1];
        let lowest = (0..bodies).filter_map(|body| {
            let own = (0..gap.above.len()).filter(|&k| gap.owner(k) == body);
            // of mirror images the last is the one that is computed
            own.rev().min_by(|&a, &b| gap.above[a].total_cmp(&gap.above[b]))
        });
        Extent::hull(lowest.map(|k| Extent::of([k / n2, k % n2]))).unwrap_or(Extent::of([0; 2]))
    }

    /// A region of these cells and their images along axes that are no longer folded.
    pub(crate) fn unfolded(&self, still_folded: [bool; 2]) -> Region {
        if self.covers() {
            return Region::whole(&self.whole, still_folded);
        }
        let mut held = self.extent();
        for axis in (0..2).filter(|&axis| self.folded[axis] && !still_folded[axis]) {
            held.low[axis] = self.whole.cells()[axis] - 1 - held.high[axis];
        }
        Region::around(&self.whole, still_folded, held, 0.0)
    }

    /// Whether it is a region of `grid`.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn is_of(&self, grid: &Grid) -> bool {
        let all = grid.cells();
        let inside = |axis: usize| {
            let (first, cells) = (self.first[axis], self.grid.cells()[axis]);
            cells > 0
                && first.checked_add(cells).is_some_and(|end| end <= all[axis])
                && (!self.folded[axis] || (all[axis].is_multiple_of(2) && first == all[axis] / 2))
        };
        self.whole == *grid && inside(0) && inside(1) && self.grid == grid.part(self.first, self.grid.cells())
    }

    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Its rows, with the reductions over all ranks.
    pub(crate) fn rows(&self) -> Rows {
        self.shared.clone().unwrap_or_else(|| Rows::all(self.cells()))
    }

    pub(crate) fn is_shared(&self) -> bool {
        self.shared.is_some()
    }

    /// The motions of a body on its cells, as far as they are free.
    pub(crate) fn modes(&self, freedom: Freedom) -> Modes<'_> {
        Modes::new(&self.grid, &self.rows(), freedom)
    }

    /// The rows of the whole grid that public fields cover: all, or the local rows of this rank.
    pub(crate) fn shown_rows(&self) -> Range<usize> {
        if self.is_shared() { self.computed_rows() } else { 0..self.whole.cells()[0] }
    }

    /// Its rows, as rows of the whole grid.
    pub(crate) fn computed_rows(&self) -> Range<usize> {
        self.first[0]..self.first[0] + self.cells()[0]
    }

    /// Number of cells that fields are shown on.
    pub(crate) fn shown_len(&self) -> usize {
        self.shown_rows().len() * self.whole.cells()[1]
    }

    pub(crate) fn cells(&self) -> [usize; 2] {
        self.grid.cells()
    }

    pub(crate) fn folded(&self) -> [bool; 2] {
        self.folded
    }

    pub(crate) fn len(&self) -> usize {
        self.grid.len()
    }

    /// How many cells of the whole grid each of its cells stands for.
    pub(crate) fn images(&self) -> usize {
        images(self.folded)
    }

    /// Whether it is the whole grid itself.
    pub(crate) fn is_whole(&self) -> bool {
        self.len() == self.whole.len()
    }

    /// Whether its cells are all that is shown.
    pub(crate) fn is_shown(&self) -> bool {
        self.len() == self.shown_len()
    }

    /// Whether the region of all ranks, with its mirror images, is the whole grid.
    pub(crate) fn covers(&self) -> bool {
        self.is_shared() || self.images() * self.len() == self.whole.len()
    }

    /// The lowest value of a field on the whole grid outside it and its mirror images; +∞ if they are all of it.
    pub(crate) fn lowest_outside(&self, whole: &[f64]) -> f64 {
        if self.covers() {
            return f64::INFINITY;
        }
        let n2 = self.whole.cells()[1];
        let outside = whole.iter().enumerate().filter(|(k, _)| self.find([k / n2, k % n2]).is_none());
        outside.map(|(_, &value)| value).fold(f64::INFINITY, f64::min)
    }

    /// How contact goes on beyond it, on bodies with these periodic axes.
    pub(crate) fn ends(&self, periodic: [bool; 2]) -> [Ends; 2] {
        let all = self.shared.as_ref().map_or(self.cells(), Rows::cells);
        [0, 1].map(|axis| {
            let folded = self.folded[axis];
            let first = if folded { self.whole.cells()[axis] / 2 } else { 0 };
            let covers = first + all[axis] == self.whole.cells()[axis];
            let goes_on = periodic[axis] && covers;
            Ends { open: [!folded && !goes_on, !goes_on], joined: goes_on && !folded }
        })
    }

    /// The first and the last of its cells, as cells of the whole grid.
    pub(crate) fn extent(&self) -> Extent {
        Extent { low: self.first, high: [0, 1].map(|axis| self.first[axis] + self.cells()[axis] - 1) }
    }

    /// Area of a cell with its mirror images, force over Σ p \[m²\].
    pub(crate) fn cell_area(&self) -> f64 {
        self.whole.cell_area() * self.images() as f64
    }

    /// Its cell that is, or is the image of, a cell of the whole grid.
    pub(crate) fn find(&self, cell: [usize; 2]) -> Option<usize> {
        let mut own = [0; 2];
        for axis in 0..2 {
            let (n, index) = (self.whole.cells()[axis], cell[axis]);
            let index = if self.folded[axis] && index < n / 2 { n - 1 - index } else { index };
            own[axis] = index.checked_sub(self.first[axis]).filter(|&own| own < self.cells()[axis])?;
        }
        Some(own[0] * self.cells()[1] + own[1])
    }

    /// The cell of the whole grid that its cell `k` is.
    pub(crate) fn cell(&self, k: usize) -> [usize; 2] {
        let n2 = self.cells()[1];
        [self.first[0] + k / n2, self.first[1] + k % n2]
    }

    /// The coordinates of its cell `k`.
    pub(crate) fn center(&self, k: usize) -> [f64; 2] {
        let n2 = self.cells()[1];
        self.grid.center(k / n2, k % n2)
    }
}

/// The next of the sizes 4, 5, 6, 7, 8, 10, 12, 14, 16, 20 …: transforms of them are fast, and a contact that grows
/// need not change them often.
fn suitable(cells: usize) -> usize {
    let step = 1 << cells.max(4).ilog2().saturating_sub(2);
    cells.max(4).next_multiple_of(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(cells: [usize; 2]) -> Grid {
        Grid::new(cells, cells.map(|n| n as f64)).unwrap()
    }

    #[test]
    fn edge_cells_are_counted_once() {
        for (cells, expected) in
            [([3, 3], 8), ([1, 4], 4), ([4, 1], 4), ([1, 1], 1), ([2, 5], 10), ([4, 6], 16), ([2, 2], 4)]
        {
            for folded in [[false, false], [true, false], [false, true], [true, true]] {
                if (0..2).any(|axis| folded[axis] && cells[axis] % 2 == 1) {
                    continue;
                }
                let region = Region::whole(&grid(cells), folded);
                assert_eq!(
                    region.positive_on_edge(&vec![1.0; region.len()], [false; 2]),
                    expected,
                    "{cells:?} {folded:?}"
                );
            }
        }
        let inside = Region::around(&grid([64, 64]), [false; 2], Extent { low: [20, 30], high: [25, 35] }, 0.1);
        assert_eq!(inside.positive_on_edge(&vec![1.0; inside.len()], [false; 2]), 0);
        let aside = Region::around(&grid([64, 64]), [false; 2], Extent { low: [0, 30], high: [5, 35] }, 0.1);
        assert_eq!(aside.positive_on_edge(&vec![1.0; aside.len()], [false; 2]), aside.cells()[1]);
    }

    #[test]
    fn sizes_grow_by_a_quarter_at_most() {
        let sizes: Vec<usize> = (1..200).map(suitable).collect();
        assert!(
            sizes.iter().zip(1..).all(|(&size, wanted)| size >= wanted && (wanted < 4 || 4 * size <= 5 * wanted + 3))
        );
        assert_eq!(suitable(129), 160);
    }
}
