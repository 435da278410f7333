//! How many cells a contact is across.

use std::f64::consts::FRAC_PI_4;

use crate::extent::Extent;
use crate::parallel::Rows;
use crate::sum;

/// The interval that holds two others.
fn joined(a: Option<[usize; 2]>, b: Option<[usize; 2]>) -> Option<[usize; 2]> {
    match (a, b) {
        (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
        (one, other) => one.or(other),
    }
}

/// How contact goes on beyond the first and the last cells of a field along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ends {
    /// Whether contact ends with the first cell, and with the last. Where it does not, the cells beyond are mirror
    /// images.
    pub(crate) open: [bool; 2],
    /// Whether the first and the last cells are neighbours.
    pub(crate) joined: bool,
}

/// A pressure on some rows, and how it goes on beyond them.
pub(crate) struct Outline<'a> {
    pub(crate) rows: &'a Rows,
    pub(crate) pressure: &'a [f64],
    pub(crate) ends: [Ends; 2],
    /// How many cells of the grid each of its cells stands for.
    pub(crate) images: usize,
}

/// Cells in contact, and their sides along each axis with which contact ends.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Resolution {
    cells: f64,
    sides: [f64; 2],
}

impl Outline<'_> {
    /// Of all cells under pressure, with their number among those of the rows of all ranks, and the rectangle of this
    /// rank's rows that holds its own: one look at each row. A call of all ranks; the resolution does not depend on
    /// their number.
    pub(crate) fn resolution(&self) -> (Resolution, usize, Option<Extent>) {
        let Outline { rows, pressure, ends: [down, right], .. } = self;
        let ([n1, n2], band, first) = (rows.cells(), rows.band_cells() / rows.cells()[1], rows.own().start);
        let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).filter(|(a, b)| (**a > 0.0) != (**b > 0.0)).count();
        // rows are read from their first pressed cell to the last
        let bounds = |row: &[f64]| {
            let low = row.iter().position(|p| *p > 0.0)?;
            Some([low, row.iter().rposition(|p| *p > 0.0).map_or(n2, |last| last + 1)])
        };
        let ([mut cells, mut across, mut along], mut extent) = ([0; 3], None);
        let (mut above, mut above_is_whole) = (None, false);
        for (i, row) in pressure.chunks_exact(n2).enumerate() {
            let (own, mut is_whole) = (bounds(row), false);
            if let Some([low, high]) = own {
                let inner = &row[low..high];
                let count = inner.iter().filter(|p| **p > 0.0).count();
                let left = low > 0 || right.open[0] || right.joined && high < n2;
                let after = high < n2 || right.open[1] || right.joined && low > 0;
                cells += count;
                along += usize::from(left) + usize::from(after);
                // a row without holes has no other sides
                is_whole = count == high - low;
                along += if is_whole { 0 } else { differ(inner, &inner[1..]) };
                across += if first + i == 0 && down.open[0] { count } else { 0 };
                across += if first + i + 1 == n1 && down.open[1] { count } else { 0 };
                let row = Extent { low: [i, low], high: [i, high - 1] };
                extent = Some(extent.map_or(row, |extent: Extent| extent.with(row)));
            }
            if i % band > 0
                && let Some([low, high]) = joined(own, above)
            {
                across += match (own, above) {
                    // rows without holes that lie side by side differ at their ends
                    (Some([a, b]), Some([c, d])) if is_whole && above_is_whole && a.max(c) < b.min(d) => {
                        a.abs_diff(c) + b.abs_diff(d)
                    }
                    _ => differ(&row[low..high], &pressure[(i - 1) * n2..][low..high]),
                };
            }
            (above, above_is_whole) = (own, is_whole);
        }
        if down.joined && self.is_one_band() && !pressure.is_empty() {
            across += differ(&pressure[..n2], &pressure[(n1 - 1) * n2..]);
        }
        let [cells, across, along] = [cells, across, along].map(|count| rows.count(count));
        // sides between bands, which ranks may not share, are as frequent as the others
        let ([n1, n2], seam) = (rows.cells(), usize::from(self.ends[0].joined));
        let counted = if self.is_one_band() { n1 } else { n1 - n1.div_ceil(rows.band_cells() / n2) };
        let share = if self.is_one_band() { 1.0 } else { (n1 - 1 + seam) as f64 / counted as f64 };
        let resolution = Resolution { cells: cells as f64, sides: [across as f64 * share, along as f64] };
        (resolution.imaged(self.images), cells, extent)
    }

    /// Of the cells under each of `N` bodies from `first` on, with the rectangles of the field that hold them. In one
    /// process.
    pub(crate) fn resolutions<const N: usize>(
        &self,
        first: usize,
        body: impl Fn(usize) -> usize,
    ) -> [(Resolution, Option<Extent>); N] {
        let mut found = [(Resolution::default(), None); N];
        let n2 = self.rows.cells()[1];
        for k in (0..self.pressure.len()).filter(|&k| self.pressure[k] > 0.0) {
            let own = body(k);
            if let Some((Resolution { cells, sides }, extent)) = own.checked_sub(first).and_then(|n| found.get_mut(n)) {
                let same = |other: usize| self.pressure[other] > 0.0 && body(other) == own;
                let [one, across, along] = self.of_cell(k, same);
                (*cells, *sides) = (*cells + one, sum::add(*sides, [across, along]));
                let cell = Extent::of([k / n2, k % n2]);
                *extent = Some(extent.map_or(cell, |extent: Extent| extent.with(cell)));
            }
        }
        found.map(|(resolution, extent)| (resolution.imaged(self.images), extent))
    }

    fn is_one_band(&self) -> bool {
        self.rows.len() <= self.rows.band_cells()
    }

    /// Of a cell: 1, and the number of its sides along each axis beyond which there is no contact, which is `same`.
    fn of_cell(&self, k: usize, same: impl Fn(usize) -> bool) -> [f64; 3] {
        let [n1, n2] = self.rows.cells();
        let (i, j, [down, right]) = (self.rows.own().start + k / n2, k % n2, self.ends);
        let end = |is_end: bool| f64::from(u8::from(is_end));
        let before = match i {
            0 if down.joined => !same(k + (n1 - 1) * n2),
            0 => down.open[0],
            _ => !same(k - n2),
        };
        let after = match n1 - i {
            1 if down.joined => !same(k - i * n2),
            1 => down.open[1],
            _ => !same(k + n2),
        };
        let left = if j > 0 { !same(k - 1) } else { right.open[0] || right.joined && !same(k + n2 - 1) };
        let right = if j + 1 < n2 { !same(k + 1) } else { right.open[1] || right.joined && !same(k + 1 - n2) };
        [1.0, end(before) + end(after), end(left) + end(right)]
    }
}

impl Resolution {
    fn imaged(self, images: usize) -> Resolution {
        let Resolution { cells, sides } = self;
        Resolution { cells: cells * images as f64, sides: sides.map(|sides| sides * images as f64) }
    }

    /// Cells across the contact, if they are few: 4/π times the mean chord along the axis on which it is shorter,
    /// which is the diameter of a disc; at most the `extent` of all cells on a grid of so many `cells`. `None`
    /// without contact, and where contact has no end.
    pub(crate) fn few(&self, extent: Extent, cells: [usize; 2], periodic: [bool; 2]) -> Option<f64> {
        let is_line = |axis: usize| cells[axis] == 1 && periodic[axis];
        let line = is_line(0) || is_line(1);
        let along = |axis: usize| {
            let extent = (extent.high[axis] + 1 - extent.low[axis]) as f64;
            let chord = 2.0 * self.cells / self.sides[axis] / if line { 1.0 } else { FRAC_PI_4 };
            // 50 cells are a disc 8 wide; by where it lies between the cells the mean chord makes of it one of 7 to 8.5
            let few = extent < 8.0 || chord < 7.0 || !line && self.cells < 50.0;
            few.then(|| chord.min(extent))
        };
        let ended = (0..2).filter(|&axis| !is_line(axis) && self.sides[axis] > 0.0);
        ended.filter_map(along).reduce(f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::Threads;

    fn pressed_cells(pressure: &[f64], n2: usize) -> impl Iterator<Item = Extent> {
        pressure.iter().enumerate().filter(|(_, p)| **p > 0.0).map(move |(k, _)| Extent::of([k / n2, k % n2]))
    }

    /// Random spots on fields of one band and of several, on one rank and on three, against sides counted one by one.
    #[test]
    fn sides_are_counted_whatever_the_number_of_ranks() {
        let mut state = 9_u64;
        let mut below = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % n
        };
        let mut in_bands = 0;
        for scene in 0..40 {
            let cells =
                if scene % 8 == 0 { [120 + below(60), 150 + below(60)] } else { [1 + below(20), 1 + below(20)] };
            let [n1, n2] = cells;
            let (joined, folded) = ([below(2) == 1, below(2) == 1], [below(2) == 1, below(2) == 1]);
            let ends =
                [0, 1].map(|axis| Ends { open: [!joined[axis] && !folded[axis], !joined[axis]], joined: joined[axis] });
            let most = below(4);
            let pressure: Vec<f64> = (0..n1 * n2).map(|_| if below(4) <= most { 1.0 } else { 0.0 }).collect();
            let pressed = |k: usize| pressure[k] > 0.0;
            let ended = |k: usize, axis: usize| {
                let (at, n, stride) = if axis == 0 { (k / n2, n1, n2) } else { (k % n2, n2, 1) };
                let Ends { open, joined } = ends[axis];
                let around = k - at * stride;
                let before = if at > 0 {
                    !pressed(k - stride)
                } else {
                    open[0] || joined && !pressed(around + (n - 1) * stride)
                };
                let after = if at + 1 < n { !pressed(k + stride) } else { open[1] || joined && !pressed(around) };
                f64::from(u8::from(before)) + f64::from(u8::from(after))
            };
            let expected = [0, 1].map(|axis| (0..n1 * n2).filter(|&k| pressed(k)).map(|k| ended(k, axis)).sum::<f64>());
            let rows = Rows::all(cells);
            let outline = Outline { rows: &rows, pressure: &pressure, ends, images: 1 };
            let (found, pressed, own) = outline.resolution();
            assert_eq!((found.cells, found.sides[1]), (pressure.iter().sum(), expected[1]), "{scene}");
            assert_eq!((pressed as f64, own.is_some()), (found.cells, pressed > 0), "{scene}");
            assert_eq!(own, Extent::hull(pressed_cells(&pressure, n2)), "{scene}");
            let exact = if outline.is_one_band() { 1e-12 } else { 0.1 };
            in_bands += usize::from(!outline.is_one_band());
            assert!((found.sides[0] - expected[0]).abs() <= exact * expected[0], "{scene}: {found:?} {expected:?}");
            let on_ranks = Threads::run(3, |ranks| {
                let rows = Rows::of_rank(cells, ranks);
                let own = &pressure[rows.own().start * n2..rows.own().end * n2];
                Outline { rows: &rows, pressure: own, ends, images: 1 }.resolution().0
            });
            assert!(on_ranks.unwrap().iter().all(|other| *other == found), "{scene}");
            let [(one, extent)] = outline.resolutions::<1>(0, |_| 0);
            assert_eq!((one.cells, one.sides), (found.cells, expected), "{scene}");
            assert_eq!(extent.is_some(), found.cells > 0.0, "{scene}");
        }
        assert!(in_bands > 3);
    }
}
