//! The axes in the plane of contact.

use std::fmt;

/// One of the two axes in the plane of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[expect(clippy::exhaustive_enums, reason = "a plane has two axes")]
pub enum Axis {
    /// Along x1.
    X1,
    /// Along x2.
    X2,
}

impl Axis {
    /// x1 and x2, in order.
    pub const BOTH: [Axis; 2] = [Axis::X1, Axis::X2];

    /// Its index in arrays of both axes, such as [`Grid::lengths`](crate::Grid::lengths): 0 or 1.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The indices of this axis and of the other one.
    pub(crate) fn and_other(self) -> (usize, usize) {
        (self.index(), 1 - self.index())
    }
}

impl fmt::Display for Axis {
    /// x1 or x2.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(["x1", "x2"][self.index()])
    }
}
