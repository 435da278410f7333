//! Memory of operators and their buffers, known before they are made.

use num_complex::Complex64;

use super::workspace::CACHE_LINE;
use super::{AREA, Shares, TILE};
use crate::kernel::Layout;
use crate::parallel::{lanes, rows_in_a_tile};

const REAL: u128 = size_of::<f64>() as u128;
const COMPLEX: u128 = size_of::<Complex64>() as u128;

impl Layout {
    /// Bytes of an operator: its spectrum, of which ranks that share it out have some columns, and the tables of its
    /// transforms.
    pub(crate) fn operator_bytes(&self, shares: Option<&Shares>) -> u128 {
        let columns = shares.map_or(self.independent(1), |shares| shares.columns(self).len());
        let spectrum = REAL * self.independent(0) as u128 * columns as u128;
        let tables = [0, 1].map(|axis| {
            // forward and inverse: about one complex number each per number of the line
            let twist = if self.folded[axis] { self.line(axis) as u128 / 2 + 1 } else { 0 };
            COMPLEX * (2 * self.line(axis) as u128 + twist)
        });
        // the real transforms of a single column have half the length each
        let column = if self.is_single_column() && !self.folded[0] { tables[0] / 2 } else { 0 };
        spectrum + tables[0] + tables[1] + column
    }

    /// Bytes of the buffers of an operator, for as many threads as pay off for this size, or for the one of a rank.
    pub(crate) fn workspace_bytes(&self, shares: Option<&Shares>) -> u128 {
        let [lines, columns] = [self.line(1) as u128, self.line(0) as u128];
        if self.is_single_column() {
            let (real, scratch) = if self.folded[0] { (0, columns) } else { (columns, columns / 2) };
            let all = if shares.is_some() { self.cells[0] as u128 } else { 0 };
            return REAL * (real + all) + COMPLEX * (self.waves() as u128 + scratch);
        }
        let slack = (CACHE_LINE / size_of::<Complex64>()) as u128;
        let stride = columns.next_multiple_of(TILE as u128) + TILE as u128;
        let lane = lines + TILE as u128 * stride + lines.max(columns) + 3 * slack;
        COMPLEX * (self.between(shares) + self.lanes(shares) as u128 * lane)
    }

    /// Bytes of the buffers that an operator of another layout, on the same cells, lends to one of this layout.
    pub(crate) fn shared_bytes(&self, shares: Option<&Shares>, (lender, lending): (&Layout, Option<&Shares>)) -> u128 {
        let is_shared =
            !self.is_single_column() && !lender.is_single_column() && lender.tiles(lending) >= self.tiles(shares);
        if is_shared { COMPLEX * self.between(shares) } else { 0 }
    }

    /// As many threads as pay off for this size; one for each rank, if ranks share it.
    pub(super) fn lanes(&self, shares: Option<&Shares>) -> usize {
        if shares.is_some() { 1 } else { lanes(self.cells[0].saturating_mul(self.cells[1])) }
    }

    /// Number of complex values that the buffers hold between the passes.
    fn between(&self, shares: Option<&Shares>) -> u128 {
        self.tiles(shares) * if shares.is_some() || self.lanes(shares) > 1 { 2 } else { 1 }
    }

    /// Number of values that the buffers hold between the passes: it differs between workspaces of different sizes.
    pub(crate) fn numbers(&self) -> usize {
        let numbers = match self.is_single_column() {
            true => 2 * self.waves() as u128 + if self.folded[0] { 0 } else { self.line(0) as u128 },
            false => 2 * self.tiles(None),
        };
        usize::try_from(numbers).unwrap_or(usize::MAX)
    }

    /// Whether there are no rows to transform, as in a line contact.
    pub(super) fn is_single_column(&self) -> bool {
        self.cells[1] == 1 && self.line(1) == 1 && !self.folded[1]
    }

    /// Number of complex values in the transform of a single column.
    fn waves(&self) -> usize {
        if self.folded[0] { self.line(0) } else { self.independent(0) }
    }

    /// Number of complex values in all tiles, or the most that a rank has of them at a time.
    pub(super) fn tiles(&self, shares: Option<&Shares>) -> u128 {
        let high = rows_in_a_tile(self.folded);
        let all = || self.independent(1).div_ceil(TILE) as u128 * AREA as u128 * self.cells[0].div_ceil(high) as u128;
        shares.map_or_else(all, |shares| shares.most() as u128)
    }
}
