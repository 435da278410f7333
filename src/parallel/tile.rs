//! Tiles of a transform, the smallest pieces of a field that threads and ranks share out.

/// Side of a tile: 8 complex numbers fill two cache lines.
pub(crate) const TILE: usize = 8;

/// Rows of cells that a tile holds: two for each row of the tile where rows are folded.
pub(crate) fn rows_in_a_tile(folded: [bool; 2]) -> usize {
    if folded[1] { 2 * TILE } else { TILE }
}
