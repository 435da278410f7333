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

    /// No height is known: nothing was measured, or the grid lies beside the map.
    #[error("no height is known: nothing was measured there")]
    NothingKnown,

    /// Heights are missing where all are needed: fill them
    /// ([`HeightMap::filled`](crate::geometry::HeightMap::filled)) or crop the map.
    #[error("{missing} heights of the map are missing: fill them with HeightMap::filled, or crop the map")]
    Missing {
        /// How many.
        missing: usize,
    },

    /// The heights between the known ones were not found to the accuracy of the numbers; those known are too far
    /// apart in height, or too few.
    #[error("the missing heights were not found in {iterations} iterations: the residual is {residual:e} m")]
    NotFilled {
        /// Iterations done.
        iterations: usize,
        /// Greatest distance of a height from the mean of its neighbours \[m\].
        residual: f64,
    },
}
