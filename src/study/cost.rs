//! What a run takes.

/// What a run to an accuracy is expected to take, from what a study measured.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Cost {
    /// Cells along x1 and x2.
    pub cells: [usize; 2],
    /// Steps.
    pub steps: usize,
    /// Convolution equivalents, each times the cells.
    pub work: f64,
    /// Bytes of the contact.
    pub bytes: u64,
}
