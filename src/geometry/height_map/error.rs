/// What is wrong with a map of heights, or a file of one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// A height is infinite.
    #[error("height {entry} of the map is {value}: heights must be finite, or NaN where nothing was measured")]
    NotFinite {
        /// Index of the height.
        entry: usize,
        /// The value.
        value: f64,
    },
}
