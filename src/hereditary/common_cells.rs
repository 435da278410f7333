//! Cells that two fields have in common.

/// Cells that a field has in common with another: where they begin in each, and how many they are.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CommonCells {
    pub(crate) here: usize,
    pub(crate) there: usize,
    pub(crate) count: usize,
}

impl CommonCells {
    /// Copies them from `there`; nothing where one of the fields is not kept.
    pub(crate) fn copy<V: Copy>(self, there: &[V], here: &mut [V]) {
        if !there.is_empty() && !here.is_empty() {
            here[self.here..self.here + self.count].copy_from_slice(&there[self.there..self.there + self.count]);
        }
    }
}
