//! One rigid body of a contact.

/// The state of one rigid body, see [`Fields::body`](crate::fields::Fields::body).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BodyState {
    /// Approach ω at the origin of the grid \[m\]: the body lowers the surface by ω + α1 x1 + α2 x2.
    pub approach: f64,
    /// Tilt (α1, α2) \[rad\].
    pub tilt: [f64; 2],
    /// Normal force \[N\].
    pub force: f64,
    /// Moments of the pressure about the origin, \[∬ p x1, ∬ p x2\] \[N·m\].
    pub moment: [f64; 2],
    /// Cells in contact.
    pub contact_cells: usize,
}
