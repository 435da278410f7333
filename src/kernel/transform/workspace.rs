//! Buffers of an operator: one set for each thread, aligned to cache lines.

use num_complex::Complex64;

use super::column::ColumnWorkspace;
use super::{SpectralOperator, TILE};

use crate::kernel::Layout;

/// Buffers of a [`SpectralOperator`]: made once, used by every application.
#[derive(Clone)]
pub(crate) struct TransformWorkspace {
    /// The layout that it was made for.
    pub(crate) layout: Layout,
    /// Coefficients of the rows, in tiles: the coefficients of 8 rows side by side. A folded row holds the (real)
    /// coefficients of two.
    pub(super) tiles: Vec<Complex64>,
    /// Coefficients after the columns, 8 columns below each other; empty for a single thread, which works in place. A
    /// rank packs here the numbers that it exchanges.
    pub(super) result: Vec<Complex64>,
    pub(super) lanes: Vec<Lane>,
    /// Replaces all of these where the operator has a single column.
    pub(super) column: ColumnWorkspace,
}

/// Buffers of one thread.
#[derive(Clone)]
pub(super) struct Lane {
    pub(super) line: Buffer,
    pub(super) block: Buffer,
    pub(super) scratch: Buffer,
}

/// A buffer aligned to a cache line: a transform in buffers that are not takes up to twice as long.
#[derive(Clone)]
pub(super) struct Buffer {
    values: Vec<Complex64>,
    length: usize,
}

/// Bytes of a cache line.
pub(super) const CACHE_LINE: usize = 64;

impl Buffer {
    fn zeros(length: usize) -> Buffer {
        let slack = CACHE_LINE / size_of::<Complex64>();
        Buffer { values: vec![Complex64::default(); length + slack], length }
    }

    #[inline(always)]
    pub(super) fn get(&mut self) -> &mut [Complex64] {
        let before = self.values.as_ptr().align_offset(CACHE_LINE).min(self.values.len() - self.length);
        &mut self.values[before..before + self.length]
    }
}

impl SpectralOperator {
    /// Buffers for [`SpectralOperator::apply`], for as many threads as pay off for this size.
    pub(crate) fn workspace(&self) -> TransformWorkspace {
        self.buffers(self.layout.lanes(self.shares.as_ref()), self.tiles())
    }

    /// Buffers for [`SpectralOperator::apply_beside`] an operator of the same cells, which lends its tiles if they
    /// suffice. (On a rank the smaller operator may have more tiles.)
    pub(crate) fn workspace_sharing(&self, lender: &SpectralOperator) -> TransformWorkspace {
        let shares_tiles = self.column.is_none() && lender.column.is_none() && lender.tiles() >= self.tiles();
        self.buffers(self.layout.lanes(self.shares.as_ref()), if shares_tiles { 0 } else { self.tiles() })
    }

    /// Buffers for `lanes` threads, `tiles` values between the passes.
    pub(super) fn buffers(&self, lanes: usize, tiles: usize) -> TransformWorkspace {
        let layout = self.layout;
        if let Some(column) = &self.column {
            let mut column = column.workspace(&self.columns);
            if self.shares.is_some() {
                column.all = vec![0.0; layout.cells[0]];
            }
            return TransformWorkspace { layout, tiles: Vec::new(), result: Vec::new(), lanes: Vec::new(), column };
        }
        let zeros = |count| vec![Complex64::default(); count];
        let lane = Lane {
            line: Buffer::zeros(self.rows.len()),
            block: Buffer::zeros(TILE * self.stride()),
            scratch: Buffer::zeros(self.rows.scratch().max(self.columns.scratch())),
        };
        let result = zeros(if lanes > 1 || self.shares.is_some() { tiles } else { 0 });
        let column = ColumnWorkspace::default();
        TransformWorkspace { layout, tiles: zeros(tiles), result, lanes: vec![lane; lanes.max(1)], column }
    }
}

impl TransformWorkspace {
    /// Swaps the buffers between the passes.
    pub(in crate::kernel) fn swap_tiles(&mut self, other: &mut TransformWorkspace) {
        std::mem::swap(&mut self.tiles, &mut other.tiles);
        std::mem::swap(&mut self.result, &mut other.result);
    }
}

debug_by!(self: TransformWorkspace => layout: self.layout);
