//! Memory of operators and their buffers, known before they are made.

use num_complex::Complex64;

use super::workspace::CACHE_LINE;
use super::{AREA, Shares, TILE};
use crate::kernel::layout::Layout;
use crate::parallel::lanes;

const REAL: u128 = size_of::<f64>() as u128;
const COMPLEX: u128 = size_of::<Complex64>() as u128;

impl Layout {
    /// Bytes of an operator: its spectrum, and the tables of its transforms.
    pub(crate) fn operator_bytes(&self) -> u128 {
        self.operator_bytes_of(self.independent(1))
    }

    /// Bytes of an operator with so many columns of the spectrum.
    fn operator_bytes_of(&self, columns: usize) -> u128 {
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

    /// Bytes of the buffers of an operator, for as many threads as pay off for this size.
    pub(crate) fn workspace_bytes(&self) -> u128 {
        let lanes = lanes(self.cells[0].saturating_mul(self.cells[1])) as u128;
        self.workspace_bytes_of(lanes, self.tiles() * if lanes > 1 { 2 } else { 1 })
    }

    /// Bytes of the buffers of so many threads, with so many values between the passes.
    fn workspace_bytes_of(&self, lanes: u128, tiles: u128) -> u128 {
        let [lines, columns] = [self.line(1) as u128, self.line(0) as u128];
        if self.is_single_column() {
            let (real, scratch) = if self.folded[0] { (0, columns) } else { (REAL * columns, columns / 2) };
            return real + COMPLEX * (self.waves() as u128 + scratch);
        }
        let slack = (CACHE_LINE / size_of::<Complex64>()) as u128;
        let stride = columns.next_multiple_of(TILE as u128) + TILE as u128;
        let lane = lines + TILE as u128 * stride + lines.max(columns) + 3 * slack;
        COMPLEX * (tiles + lanes * lane)
    }

    /// Bytes of the buffers of an operator beside one of this layout.
    pub(crate) fn workspace_bytes_beside(&self, lender: &Layout) -> u128 {
        let lanes = lanes(self.cells[0].saturating_mul(self.cells[1]));
        let lent = COMPLEX * self.tiles() * if lanes > 1 { 2 } else { 1 };
        self.workspace_bytes() - if lender.lends_to(self) { lent } else { 0 }
    }

    /// Whether the buffers of an operator of this layout suffice for one of another, on the same cells.
    pub(super) fn lends_to(&self, other: &Layout) -> bool {
        !self.is_single_column() && !other.is_single_column() && self.tiles() >= other.tiles()
    }

    /// Number of values that the buffers hold between the passes: it differs between workspaces of different sizes.
    pub(crate) fn numbers(&self) -> usize {
        let numbers = match self.is_single_column() {
            true => 2 * self.waves() as u128 + if self.folded[0] { 0 } else { self.line(0) as u128 },
            false => 2 * self.tiles(),
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

    /// Number of complex values in all tiles.
    fn tiles(&self) -> u128 {
        let high = if self.folded[1] { 2 * TILE } else { TILE };
        self.independent(1).div_ceil(TILE) as u128 * AREA as u128 * self.cells[0].div_ceil(high) as u128
    }
}

impl Shares {
    /// Bytes of an operator that ranks share out: of own columns.
    pub(crate) fn operator_bytes(&self, layout: &Layout) -> u128 {
        layout.operator_bytes_of(self.columns(layout).len())
    }

    /// Bytes of its buffers: buffers of one thread, and of sent and received numbers.
    pub(crate) fn workspace_bytes(&self, layout: &Layout) -> u128 {
        let whole = if layout.is_single_column() { REAL * layout.cells[0] as u128 } else { 0 };
        whole + layout.workspace_bytes_of(1, 2 * self.most() as u128)
    }

    /// Bytes of buffers beside another operator, whose buffers are borrowed where they suffice.
    pub(crate) fn workspace_bytes_beside(&self, layout: &Layout, lender: &Shares) -> u128 {
        let lends = !layout.is_single_column() && lender.most() >= self.most();
        self.workspace_bytes(layout) - if lends { COMPLEX * 2 * self.most() as u128 } else { 0 }
    }
}
