//! The part of the grid that is computed.

use crate::Grid;
use crate::contact::window::extent::Extent;
use crate::geometry::Gap;
use crate::kernel::images;

/// A rectangle of cells, by symmetry perhaps the half or the quarter of one: what happens elsewhere is its mirror image, or
/// out of reach.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Region {
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::grid::saved"))]
    whole: Grid,
    /// Its cells, with the coordinates of the whole.
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::grid::saved"))]
    grid: Grid,
    /// Its first cell.
    first: [usize; 2],
    /// Axes along which every field is even about the middle: only the upper half is computed.
    folded: [bool; 2],
}

impl Region {
    fn new(whole: &Grid, folded: [bool; 2], first: [usize; 2], cells: [usize; 2]) -> Region {
        Region { whole: whole.clone(), grid: whole.part(first, cells), first, folded }
    }

    /// All of `grid`, but for mirror images along folded axes, which have an even number of cells.
    pub(crate) fn whole(grid: &Grid, folded: [bool; 2]) -> Region {
        let all = grid.cells();
        let first = [0, 1].map(|axis| if folded[axis] { all[axis] / 2 } else { 0 });
        Region::new(grid, folded, first, [0, 1].map(|axis| all[axis] - first[axis]))
    }

    /// A region of suitable size that holds these cells of the whole grid, and the part `margin` of their number more.
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

    /// A small one that holds the lowest cell of each body.
    pub(crate) fn first_touched(grid: &Grid, folded: [bool; 2], gap: &Gap, bodies: usize) -> Region {
        Region::around(grid, folded, Region::lowest_cells(grid, gap, bodies), 0.0)
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

    /// The same cells, and their images along axes that are no longer folded.
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

    /// Whether it is one of `grid`.
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

    pub(crate) fn cells(&self) -> [usize; 2] {
        self.grid.cells()
    }

    pub(crate) fn folded(&self) -> [bool; 2] {
        self.folded
    }

    pub(crate) fn len(&self) -> usize {
        self.grid.len()
    }

    /// Number of cells of the whole grid.
    pub(crate) fn whole_len(&self) -> usize {
        self.whole.len()
    }

    /// How many cells of the whole grid each of its cells stands for.
    pub(crate) fn images(&self) -> usize {
        images(self.folded)
    }

    /// Whether it is the whole grid itself.
    pub(crate) fn is_whole(&self) -> bool {
        self.len() == self.whole.len()
    }

    /// Whether it and its images are the whole grid.
    pub(crate) fn covers(&self) -> bool {
        self.images() * self.len() == self.whole.len()
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

    /// The first and the last of its cells, as cells of the whole grid.
    pub(crate) fn extent(&self) -> Extent {
        Extent { low: self.first, high: [0, 1].map(|axis| self.first[axis] + self.cells()[axis] - 1) }
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

    /// Takes its share out of a field on the whole grid.
    pub(crate) fn cut<V: Copy>(&self, whole: &[V]) -> Vec<V> {
        self.share(whole).collect()
    }

    /// Writes its share of a gap over another.
    pub(crate) fn cut_gap_into(&self, gap: &Gap, own: &mut Gap) {
        own.datum = gap.datum;
        own.above.iter_mut().zip(self.share(&gap.above)).for_each(|(own, value)| *own = value);
        if let (Some(own), Some(owner)) = (&mut own.owner, &gap.owner) {
            own.iter_mut().zip(self.share(owner)).for_each(|(own, value)| *own = value);
        }
    }

    fn share<V: Copy>(&self, whole: &[V]) -> impl Iterator<Item = V> {
        let n2 = self.whole.cells()[1];
        (0..self.len()).map(|k| self.cell(k)).map(move |[i, j]| whole[i * n2 + j])
    }

    /// Its share of a gap; nothing if that is all of it.
    pub(crate) fn cut_gap(&self, gap: &Gap) -> Option<Gap> {
        (!self.is_whole()).then(|| Gap {
            datum: gap.datum,
            above: self.cut(&gap.above),
            owner: gap.owner.as_ref().map(|owner| self.cut(owner)),
        })
    }

    /// Writes a field of its own over the cells, and the images of cells, that it belongs to.
    pub(crate) fn spread(&self, own: &[f64], whole: &mut [f64]) {
        let ([n1, n2], [_, m2]) = (self.whole.cells(), self.cells());
        for (i, row) in own.chunks_exact(m2).enumerate() {
            let i = self.first[0] + i;
            let images = [Some(i), self.folded[0].then_some(n1 - 1 - i)];
            for i in images.into_iter().flatten() {
                let line = &mut whole[i * n2..(i + 1) * n2];
                line[self.first[1]..self.first[1] + m2].copy_from_slice(row);
                if self.folded[1] {
                    let start = n2 - self.first[1] - m2;
                    line[start..start + m2].iter_mut().rev().zip(row).for_each(|(out, &value)| *out = value);
                }
            }
        }
    }

    /// A field on another region of the same grid from one of its own; `elsewhere` says what it is on cells that are
    /// none of its own, nor images of them.
    pub(crate) fn carry<V: Copy>(&self, own: &[V], other: &Region, elsewhere: impl Fn(usize) -> V) -> Vec<V> {
        (0..other.len()).map(|k| self.find(other.cell(k)).map_or_else(|| elsewhere(k), |own_k| own[own_k])).collect()
    }

    /// The least rectangle of the whole grid that holds the cells, and the images of cells, whose value in `own` is positive;
    /// `None` if there is none.
    pub(crate) fn reach(&self, own: &[f64]) -> Option<Extent> {
        let rows = own.chunks_exact(self.cells()[1]).enumerate().filter_map(|(i, row)| {
            let first = row.iter().position(|&value| value > 0.0)?;
            let last = row.iter().rposition(|&value| value > 0.0)?;
            Some(Extent { low: [i, first], high: [i, last] })
        });
        let Extent { mut low, mut high } = Extent::hull(rows)?;
        for axis in 0..2 {
            (low[axis], high[axis]) = (low[axis] + self.first[axis], high[axis] + self.first[axis]);
            if self.folded[axis] {
                low[axis] = low[axis].min(self.whole.cells()[axis] - 1 - high[axis]);
            }
        }
        Some(Extent { low, high })
    }

    /// Number of cells on the edge of the whole grid whose value in `own` is positive; periodic axes have no edge.
    pub(crate) fn positive_on_edge(&self, own: &[f64], periodic: [bool; 2]) -> usize {
        let [m1, m2] = self.cells();
        let ends = |axis: usize, count: usize| {
            let last = self.first[axis] + count == self.whole.cells()[axis];
            let outermost = [self.first[axis] == 0, last].map(|at_end| at_end && !periodic[axis]);
            [outermost[0].then_some(0), outermost[1].then_some(count - 1).filter(|&last| last > 0 || !outermost[0])]
        };
        let (rows, columns) = (ends(0, m1), ends(1, m2));
        let positive = |row: &[f64]| row.iter().filter(|&&value| value > 0.0).count();
        let across: usize = rows.into_iter().flatten().map(|i| positive(&own[i * m2..(i + 1) * m2])).sum();
        let inner = (0..m1).filter(|i| !rows.contains(&Some(*i)));
        let down = inner.map(|i| columns.into_iter().flatten().filter(|j| own[i * m2 + j] > 0.0).count());
        self.images() * (across + down.sum::<usize>())
    }
}

/// The next of the sizes 4, 5, 6, 7, 8, 10, 12, 14, 16, 20 …: transforms of them are fast, and a contact that grows need not
/// change them often.
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

    /// What is cut out and spread again is the same, on every cell and its images.
    #[test]
    fn regions_know_their_cells() {
        let whole = grid([20, 30]);
        for folded in [[false, false], [true, false], [false, true], [true, true]] {
            for region in [
                Region::whole(&whole, folded),
                Region::around(&whole, folded, Extent { low: [8, 12], high: [11, 16] }, 0.2),
                Region::around(&whole, folded, Extent { low: [0, 29], high: [19, 29] }, 0.2),
            ] {
                let even = |cell: [usize; 2]| {
                    let [x, y] = [0, 1].map(|axis| whole.coordinate(axis, cell[axis]));
                    [x, y]
                        .iter()
                        .zip(folded)
                        .fold(0.0, |sum, (x, folded)| 10.0 * sum + if folded { x.abs() } else { *x })
                };
                let field: Vec<f64> = (0..600).map(|k| even([k / 30, k % 30])).collect();
                let own = region.cut(&field);
                for (k, &value) in own.iter().enumerate() {
                    assert_eq!(
                        region.grid().center(k / region.cells()[1], k % region.cells()[1]),
                        whole.center(region.cell(k)[0], region.cell(k)[1])
                    );
                    assert_eq!((region.find(region.cell(k)), value), (Some(k), even(region.cell(k))));
                }
                let mut spread = vec![f64::NAN; 600];
                region.spread(&own, &mut spread);
                for k in 0..600 {
                    let cell = [k / 30, k % 30];
                    assert!(if region.find(cell).is_some() { spread[k] == field[k] } else { spread[k].is_nan() });
                }
                assert_eq!(region.covers(), spread.iter().all(|x| !x.is_nan()));
                let cell = [region.cell(0), region.cell(region.len() - 1)];
                for k in [0, region.len() - 1] {
                    let mut one = vec![0.0; region.len()];
                    one[k] = 1.0;
                    let mut images = vec![0.0; 600];
                    region.spread(&one, &mut images);
                    let of = |axis: usize| {
                        let along = |k: usize| [k / 30, k % 30][axis];
                        let touched = || (0..600).filter(|&k| images[k] > 0.0).map(along);
                        (touched().min().unwrap(), touched().max().unwrap())
                    };
                    let Extent { low, high } = region.reach(&one).unwrap();
                    assert_eq!([(low[0], high[0]), (low[1], high[1])], [of(0), of(1)], "{cell:?} {folded:?}");
                }
                assert_eq!(region.reach(&vec![0.0; region.len()]), None);
                let carried = region.carry(&own, &Region::whole(&whole, [false; 2]), |_| f64::NAN);
                assert!(carried.iter().zip(&spread).all(|(a, b)| a == b || (a.is_nan() && b.is_nan())));
            }
        }
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
