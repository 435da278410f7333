//! The three passes of an operator, each a task that threads share.

use num_complex::Complex64;

use super::{AREA, Lane, SpectralOperator};
use crate::kernel::transform::line::{separate, unite};
use crate::parallel::TILE;
use crate::parallel::Task;

/// Transforms rows of `input` into tiles.
pub(super) struct RowsForward<'a> {
    pub(super) operator: &'a SpectralOperator,
    pub(super) input: &'a [f64],
}

impl Task for RowsForward<'_> {
    type Lane = Lane;
    type Item = Complex64;

    #[inline(always)]
    fn run(&self, start: usize, lane: &mut Lane, tiles: &mut [Complex64]) {
        let (cells, line) = (self.operator.layout.cells[1], &self.operator.rows);
        let (run, high) = (self.operator.across() * AREA, self.operator.rows_in_a_tile());
        let (buffer, scratch) = (lane.line.get(), lane.scratch.get());
        for (block, tiles) in tiles.chunks_exact_mut(run).enumerate() {
            let first = (start / run + block) * high * cells;
            let rows = &self.input[first..self.input.len().min(first + high * cells)];
            for (i, pair) in rows.chunks(2 * cells).enumerate() {
                let (first, second) = pair.split_at(cells);
                line.pad(buffer, cells);
                if second.is_empty() {
                    line.fill(buffer, first.iter().map(|&a| Complex64::from(a)));
                } else {
                    let both = first.iter().zip(second);
                    line.fill(buffer, both.map(|(&a, &b)| Complex64::new(a, b)));
                }
                line.forward(buffer, scratch);
                if line.is_folded() {
                    if second.is_empty() {
                        buffer.iter_mut().for_each(|z| z.im = 0.0);
                    }
                    for (tile, piece) in tiles.chunks_exact_mut(AREA).zip(buffer.chunks(TILE)) {
                        let place = &mut tile[i * TILE..][..TILE];
                        place[..piece.len()].copy_from_slice(piece);
                        // beyond the last coefficient: the second half of a complex column, if the number of
                        // coefficients is odd
                        place[piece.len()..].fill(Complex64::default());
                    }
                } else {
                    for (panel, tile) in tiles.chunks_exact_mut(AREA).enumerate() {
                        let (a, b) = tile[2 * i * TILE..][..2 * TILE].split_at_mut(TILE);
                        separate(buffer, panel * TILE..line.independent(), a, b);
                        if second.is_empty() {
                            b.fill(Complex64::default());
                        }
                    }
                }
            }
        }
    }
}

/// Convolves the columns of tiles that are stored row by row.
pub(super) struct ColumnsInPlace<'a> {
    pub(super) operator: &'a SpectralOperator,
    /// Number of tiles side by side.
    pub(super) across: usize,
}

impl Task for ColumnsInPlace<'_> {
    type Lane = Lane;
    type Item = Complex64;

    #[inline(always)]
    fn run(&self, _: usize, lane: &mut Lane, tiles: &mut [Complex64]) {
        let across = self.across;
        for panel in 0..across {
            let at = |tile: usize| (tile * across + panel) * AREA;
            self.operator.gather(tiles, at, lane.block.get());
            self.operator.convolve_panel(panel, lane);
            self.operator.scatter(lane.block.get(), tiles, at);
        }
    }
}

/// Convolves the columns of `tiles`; the tiles of the result are stored column by column.
pub(super) struct Columns<'a> {
    pub(super) operator: &'a SpectralOperator,
    pub(super) tiles: &'a [Complex64],
}

impl Task for Columns<'_> {
    type Lane = Lane;
    type Item = Complex64;

    #[inline(always)]
    fn run(&self, start: usize, lane: &mut Lane, result: &mut [Complex64]) {
        let (across, down) = (self.operator.across(), self.operator.down());
        for (panel, result) in result.chunks_exact_mut(down * AREA).enumerate() {
            let panel = start / (down * AREA) + panel;
            self.operator.gather(self.tiles, |tile| (tile * across + panel) * AREA, lane.block.get());
            self.operator.convolve_panel(panel, lane);
            self.operator.scatter(lane.block.get(), result, |tile| tile * AREA);
        }
    }
}

/// Transforms tiles back into rows of the output.
pub(super) struct RowsInverse<'a> {
    pub(super) operator: &'a SpectralOperator,
    pub(super) tiles: &'a [Complex64],
    pub(super) in_place: bool,
}

impl Task for RowsInverse<'_> {
    type Lane = Lane;
    type Item = f64;

    #[inline(always)]
    fn run(&self, start: usize, lane: &mut Lane, output: &mut [f64]) {
        let (cells, line) = (self.operator.layout.cells[1], &self.operator.rows);
        let (across, down, high) = (self.operator.across(), self.operator.down(), self.operator.rows_in_a_tile());
        let (buffer, scratch) = (lane.line.get(), lane.scratch.get());
        for (block, rows) in output.chunks_mut(high * cells).enumerate() {
            let tile = start / (high * cells) + block;
            let at = |panel: usize| if self.in_place { tile * across + panel } else { panel * down + tile };
            for (i, pair) in rows.chunks_mut(2 * cells).enumerate() {
                let (first, second) = pair.split_at_mut(cells);
                if line.is_folded() {
                    for (panel, piece) in buffer.chunks_mut(TILE).enumerate() {
                        piece.copy_from_slice(&self.tiles[at(panel) * AREA + i * TILE..][..piece.len()]);
                    }
                } else {
                    for panel in 0..across {
                        let (a, b) = self.tiles[at(panel) * AREA + 2 * i * TILE..][..2 * TILE].split_at(TILE);
                        unite(a, b, panel * TILE..line.independent(), buffer);
                    }
                }
                line.inverse(buffer, scratch);
                line.read(buffer, first, |z| z.re);
                line.read(buffer, second, |z| z.im);
            }
        }
    }
}

/// Multiplies the transforms of two real columns, the real and imaginary parts of the complex `column`, by a real even
/// spectrum each.
#[inline(always)]
pub(super) fn multiply_apart(column: &mut [Complex64], first: &[f64], second: &[f64]) {
    let multiply = |z: Complex64, mirror: Complex64, k: usize| {
        z * (0.5 * (first[k] + second[k])) + mirror.conj() * (0.5 * (first[k] - second[k]))
    };
    let length = column.len();
    column[0] = multiply(column[0], column[0], 0);
    for k in 1..=length / 2 {
        let (z, mirror) = (column[k], column[length - k]);
        column[k] = multiply(z, mirror, k);
        if k != length - k {
            column[length - k] = multiply(mirror, z, k);
        }
    }
}
