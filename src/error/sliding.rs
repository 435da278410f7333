use crate::rounded::rounded;

/// Errors of a steady motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SlidingError {
    /// The scene has no steady state, or none that is computed here.
    #[error("{what} has no steady motion here: {cure}")]
    NotCovered {
        /// What the scene has.
        what: &'static str,
        /// What to do.
        cure: &'static str,
    },

    /// The contact at a velocity was not found.
    #[error("at a velocity of ({:e}, {:e}) m/s {sets} sets of cells left a residual of {residual:.1e}, where {tolerance:.1e} is allowed: come from a velocity nearby, or allow a greater Settings::tolerance",
        rounded(.velocity[0], 5), rounded(.velocity[1], 5))]
    NotConverged {
        /// Velocity \[m/s\].
        velocity: [f64; 2],
        /// Sets of cells tried.
        sets: usize,
        /// Root mean square of the gap in contact over the range of the gap that the contact closes.
        residual: f64,
        /// The residual allowed.
        tolerance: f64,
    },
}
