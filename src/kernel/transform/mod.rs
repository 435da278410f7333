//! A two-dimensional linear operator with a real even spectrum: transform, multiply, transform back (Eq. 7 of the
//! paper).
//!
//! Both the influence kernel (zero-padded, so that the convolution is linear) and the preconditioner
//! (periodic) are such operators. Nothing is computed that is known to be zero, mirrored or discarded:
//!
//! * Zero rows are not transformed, and discarded rows of the result are not computed.
//! * Two real rows are transformed as the real and imaginary parts of one complex row.
//! * An axis about which all fields are even is folded: half of the cells, cosine transforms.
//! * Between rows and columns the coefficients are stored in tiles of 8 × 8, so that both passes access contiguous
//!   memory; a column is transformed, multiplied and transformed back while it is in cache.
//! * Rows and columns are independent of each other: threads share them, and the result is bitwise the same.

mod column;
mod distributed_transform;
mod line;
mod memory;
mod tasks;
mod tiles;
mod workspace;

use super::layout::Layout;
use crate::parallel::{TILE, for_each_share, rows_in_a_tile};
use column::Column;
pub(crate) use distributed_transform::Shares;
use line::LineTransform;
use tasks::{Columns, ColumnsInPlace, RowsForward, RowsInverse, multiply_apart};
use workspace::Lane;
pub(crate) use workspace::TransformWorkspace;

/// Complex numbers in a tile.
const AREA: usize = TILE * TILE;

/// A linear operator on fields, diagonal in wave-number space with a real even spectrum.
#[derive(Clone)]
pub(crate) struct SpectralOperator {
    layout: Layout,
    rows: LineTransform,
    columns: LineTransform,
    /// For each coefficient of a row, the independent values of its column, divided by the normalisation of the
    /// transforms.
    spectrum: Vec<f64>,
    /// The transform of a single column, which has no tiles.
    column: Option<Column>,
    /// Shares of the ranks, if they share out the rows; `spectrum` holds the local columns.
    shares: Option<Shares>,
}

impl SpectralOperator {
    /// Multiplication of the Fourier coefficients on [`Layout::period`] by `symbol(k1, k2)`, for wave numbers
    /// 0 … period/2 along each axis; where ranks share out the rows, for local columns k2 alone.
    pub(crate) fn new(
        layout: Layout,
        shares: Option<Shares>,
        symbol: impl Fn(usize, usize) -> f64,
    ) -> SpectralOperator {
        let [columns, rows] = [0, 1].map(|axis| LineTransform::new(layout.line(axis), layout.folded[axis]));
        let scale = 1.0 / (rows.norm() * columns.norm());
        let own = shares.as_ref().map_or(0..rows.independent(), |shares| shares.columns(&layout));
        let mut spectrum = Vec::with_capacity(own.len() * columns.independent());
        for k2 in own {
            spectrum.extend((0..columns.independent()).map(|k1| scale * symbol(k1, k2)));
        }
        let column = layout.is_single_column().then(|| Column::new(&columns));
        SpectralOperator { layout, rows, columns, spectrum, column, shares }
    }

    /// Number of tiles side by side.
    fn across(&self) -> usize {
        self.rows.independent().div_ceil(TILE)
    }

    /// Number of complex values in all tiles, or the most that a rank has of them at a time.
    fn tiles(&self) -> usize {
        self.layout.tiles(self.shares.as_ref()) as usize
    }

    /// Number of tiles below each other.
    fn down(&self) -> usize {
        self.layout.cells[0].div_ceil(self.rows_in_a_tile())
    }

    /// Distance between the columns of a block: whole cache lines, but no power of two, which would map the columns to
    /// the same cache sets.
    fn stride(&self) -> usize {
        self.columns.len().next_multiple_of(TILE) + TILE
    }

    fn rows_in_a_tile(&self) -> usize {
        rows_in_a_tile([false, self.rows.is_folded()])
    }

    /// Applies the operator to `input` and writes the result to `output`; both hold one value per cell.
    pub(crate) fn apply(&self, input: &[f64], output: &mut [f64], work: &mut TransformWorkspace) {
        self.convolve(input, work);
        self.read(output, work);
    }

    /// [`SpectralOperator::apply`] in place.
    pub(crate) fn apply_in_place(&self, field: &mut [f64], work: &mut TransformWorkspace) {
        self.convolve(field, work);
        self.read(field, work);
    }

    /// [`SpectralOperator::apply_in_place`] with buffers of a [`SpectralOperator::workspace_sharing`] another one.
    pub(crate) fn apply_beside(
        &self,
        field: &mut [f64],
        work: &mut TransformWorkspace,
        lender: &mut TransformWorkspace,
    ) {
        let lent = work.tiles.is_empty();
        if lent {
            work.swap_tiles(lender);
        }
        self.apply_in_place(field, work);
        if lent {
            work.swap_tiles(lender);
        }
    }

    /// Convolves `input`: the result remains in the workspace, its rows still transformed.
    fn convolve(&self, input: &[f64], work: &mut TransformWorkspace) {
        if let Some(shares) = &self.shares {
            return self.convolve_shared(shares, input, work);
        }
        if let Some(column) = &self.column {
            return self.convolve_column(column, input, &mut work.column);
        }
        let share = self.down().div_ceil(work.lanes.len());
        let task = RowsForward { operator: self, input };
        // buffers that are lent may be longer
        let tiles = &mut work.tiles[..self.tiles()];
        for_each_share(&task, &mut work.lanes, tiles, share * self.across() * AREA);
        if let [lane] = &mut work.lanes[..] {
            let task = ColumnsInPlace { operator: self, across: self.across() };
            return for_each_share(&task, std::slice::from_mut(lane), tiles, usize::MAX);
        }
        let share = self.across().div_ceil(work.lanes.len());
        let task = Columns { operator: self, tiles };
        for_each_share(&task, &mut work.lanes, &mut work.result[..self.tiles()], share * self.down() * AREA);
    }

    /// Reads the result of [`SpectralOperator::convolve`] from the workspace.
    fn read(&self, output: &mut [f64], work: &mut TransformWorkspace) {
        if let Some(column) = &self.column {
            return match &self.shares {
                Some(shares) => output.copy_from_slice(&work.column.all[shares.rows.own()]),
                None => self.read_column(column, &work.column, output),
            };
        }
        let share = self.down().div_ceil(work.lanes.len());
        let in_place = work.lanes.len() == 1;
        let tiles = if in_place { &work.tiles } else { &work.result };
        let task = RowsInverse { operator: self, tiles, in_place };
        for_each_share(&task, &mut work.lanes, output, share * self.rows_in_a_tile() * self.layout.cells[1]);
    }

    /// Transforms the columns of a panel, multiplies them by the spectrum, and transforms them back.
    #[inline(always)]
    fn convolve_panel(&self, panel: usize, lane: &mut Lane) {
        let (line, values) = (&self.columns, self.columns.independent());
        let columns = if self.rows.is_folded() { TILE / 2 } else { TILE };
        let spectra = self.spectrum[panel * TILE * values..].chunks(values * TILE / columns);
        let scratch = lane.scratch.get();
        for (column, spectrum) in lane.block.get().chunks_exact_mut(self.stride()).take(columns).zip(spectra) {
            let column = &mut column[..line.len()];
            line.pad(column, self.layout.cells[0]);
            line.bare_forward(column, scratch);
            match (self.rows.is_folded(), line.is_folded()) {
                (false, false) => {
                    // wave numbers above P/2 mirror those below
                    let (rising, falling) = column.split_at_mut(values);
                    for (z, s) in rising.iter_mut().zip(spectrum) {
                        *z *= *s;
                    }
                    for (z, s) in falling.iter_mut().rev().zip(&spectrum[1..]) {
                        *z *= *s;
                    }
                }
                (_, folded) => {
                    let (first, second) = spectrum.split_at(values);
                    let second = if second.is_empty() { first } else { second };
                    if folded {
                        line.multiply_folded(column, first, second);
                    } else {
                        multiply_apart(column, first, second);
                    }
                }
            }
            line.bare_inverse(column, scratch);
        }
    }
}

debug_by!(self: SpectralOperator => layout: self.layout);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::even_spectrum::even_spectrum;
    use crate::kernel::layout::Ends;

    impl SpectralOperator {
        /// Convolution with the even kernel whose coefficient at distance (i, j) is `coefficient(i, j)`; called for
        /// distances below the number of cells (twice that along a folded axis), taken as zero beyond.
        pub(crate) fn from_coefficients(layout: Layout, coefficient: impl Fn(usize, usize) -> f64) -> SpectralOperator {
            SpectralOperator::new(layout, None, even_spectrum(layout, None, &|[i, j]| coefficient(i, j)))
        }
    }

    const FOLDS: [[bool; 2]; 4] = [[false, false], [false, true], [true, false], [true, true]];
    const SIZES: [[usize; 2]; 10] =
        [[1, 1], [7, 1], [12, 1], [9, 9], [4, 3], [3, 5], [6, 6], [5, 9], [2, 40], [33, 14]];

    fn signal(cells: [usize; 2]) -> Vec<f64> {
        (0..cells[0] * cells[1]).map(|k| ((k * k + 3) as f64).sin()).collect()
    }

    /// Σ over all cells, and their mirror images along folded axes, of `coefficient` at their distance.
    fn sum(
        Layout { cells, folded, .. }: Layout,
        input: &[f64],
        [i, j]: [usize; 2],
        coefficient: impl Fn(usize, usize) -> f64,
    ) -> f64 {
        let mut sum = 0.0;
        for k in 0..cells[0] {
            for l in 0..cells[1] {
                let across = |axis: usize, a: usize, b: usize| {
                    [a.abs_diff(b), if folded[axis] { a + b + 1 } else { usize::MAX }]
                };
                for d1 in across(0, i, k) {
                    for d2 in across(1, j, l) {
                        if d1 < usize::MAX && d2 < usize::MAX {
                            sum += coefficient(d1, d2) * input[k * cells[1] + l];
                        }
                    }
                }
            }
        }
        sum
    }

    /// The operator against its definition as a sum: even, odd and not smooth sizes, whole and folded axes, one thread
    /// and three.
    #[test]
    fn convolution_matches_the_sum() {
        for folded in FOLDS {
            for cells in SIZES {
                let layout = Layout { cells, ends: [Ends::Free; 2], folded };
                let coefficient = |i: usize, j: usize| 1.0 / (1.0 + (i * i + 2 * j * j) as f64);
                let operator = SpectralOperator::from_coefficients(layout, coefficient);
                let input = signal(cells);
                let mut output = vec![f64::NAN; input.len()];
                // many times: what remains in the workspace must not grow
                let mut work = operator.buffers(1, operator.tiles());
                for _ in 0..500 {
                    operator.apply(&input, &mut output, &mut work);
                }
                for (k, value) in output.iter().enumerate() {
                    let exact = sum(layout, &input, [k / cells[1], k % cells[1]], coefficient);
                    assert!((value - exact).abs() < 1e-12, "{cells:?} {folded:?} {k}: {value} {exact}");
                }
                let (mut threaded, mut work) = (vec![f64::NAN; input.len()], operator.buffers(3, operator.tiles()));
                for _ in 0..500 {
                    operator.apply(&input, &mut threaded, &mut work);
                }
                assert_eq!(output, threaded, "{cells:?} {folded:?}");
            }
        }
    }

    #[test]
    fn the_symbol_multiplies_each_wave() {
        for folded in FOLDS {
            let layout = Layout { cells: [12, 16], ends: [Ends::Periodic; 2], folded };
            let period = [layout.period(0), layout.period(1)];
            for k in [[0, 0], [2, 3], [0, 5], [6, 0], [5, 4]] {
                let operator = SpectralOperator::new(layout, None, |k1, k2| (1 + k1 + 10 * k2) as f64);
                let wave = |axis: usize, n: usize| {
                    let shift = if folded[axis] { 0.5 } else { 0.0 };
                    (std::f64::consts::TAU * k[axis] as f64 * (n as f64 + shift) / period[axis] as f64).cos()
                };
                let waves: Vec<f64> = (0..192).map(|n| wave(0, n / 16) * wave(1, n % 16)).collect();
                let mut output = waves.clone();
                operator.apply_in_place(&mut output, &mut operator.workspace());
                for (value, wave) in output.iter().zip(&waves) {
                    assert!((value - (1 + k[0] + 10 * k[1]) as f64 * wave).abs() < 1e-11, "{folded:?} {k:?}");
                }
            }
        }
    }
}
