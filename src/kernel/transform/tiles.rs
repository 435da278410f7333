//! Columns between tiles and the block in which they are transformed.

use num_complex::Complex64;

use super::{AREA, SpectralOperator};
use crate::parallel::TILE;

impl SpectralOperator {
    /// Copies the columns of a panel of tiles, which begin at `from`, one after the other into `block`. Columns of
    /// folded rows are real: two are the real and imaginary parts of a complex one.
    #[inline(always)]
    pub(super) fn gather(&self, tiles: &[Complex64], from: impl Fn(usize) -> usize, block: &mut [Complex64]) {
        let (cells, line, stride) = (self.layout.cells[0], &self.columns, self.stride());
        for tile in 0..self.down() {
            let rows = tiles[from(tile)..][..AREA].chunks_exact(TILE).enumerate();
            if self.rows.is_folded() {
                for (i, row) in rows {
                    let n = 2 * (tile * TILE + i);
                    for (column, pair) in block.chunks_exact_mut(stride).zip(row.chunks_exact(2)) {
                        if n < cells {
                            column[line.place(n)] = Complex64::new(pair[0].re, pair[1].re);
                        }
                        if n + 1 < cells {
                            column[line.place(n + 1)] = Complex64::new(pair[0].im, pair[1].im);
                        }
                    }
                }
            } else {
                for (i, row) in rows.take_while(|(i, _)| tile * TILE + i < cells) {
                    let place = line.place(tile * TILE + i);
                    for (c, value) in row.iter().enumerate() {
                        block[c * stride + place] = *value;
                    }
                }
            }
        }
    }

    /// The reverse of [`SpectralOperator::gather`].
    #[inline(always)]
    pub(super) fn scatter(&self, block: &[Complex64], tiles: &mut [Complex64], to: impl Fn(usize) -> usize) {
        let (cells, line, stride) = (self.layout.cells[0], &self.columns, self.stride());
        for tile in 0..self.down() {
            let rows = tiles[to(tile)..][..AREA].chunks_exact_mut(TILE).enumerate();
            if self.rows.is_folded() {
                for (i, row) in rows {
                    let n = 2 * (tile * TILE + i);
                    for (column, pair) in block.chunks_exact(stride).zip(row.chunks_exact_mut(2)) {
                        if n < cells {
                            let z = column[line.place(n)];
                            (pair[0].re, pair[1].re) = (z.re, z.im);
                        }
                        if n + 1 < cells {
                            let z = column[line.place(n + 1)];
                            (pair[0].im, pair[1].im) = (z.re, z.im);
                        }
                    }
                }
            } else {
                for (i, row) in rows.take_while(|(i, _)| tile * TILE + i < cells) {
                    let place = line.place(tile * TILE + i);
                    for (c, value) in row.iter_mut().enumerate() {
                        *value = block[c * stride + place];
                    }
                }
            }
        }
    }
}
