//! Rectangles of cells.

/// The cells from `low` to `high` of a grid, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Extent {
    pub(crate) low: [usize; 2],
    pub(crate) high: [usize; 2],
}

impl Extent {
    pub(crate) fn of(cell: [usize; 2]) -> Extent {
        Extent { low: cell, high: cell }
    }

    /// The least extent that contains both.
    pub(crate) fn with(self, other: Extent) -> Extent {
        let low = [0, 1].map(|axis| self.low[axis].min(other.low[axis]));
        let high = [0, 1].map(|axis| self.high[axis].max(other.high[axis]));
        Extent { low, high }
    }

    /// The least extent that contains all of them; `None` of no extents.
    pub(crate) fn hull(extents: impl Iterator<Item = Extent>) -> Option<Extent> {
        extents.reduce(Extent::with)
    }
}
