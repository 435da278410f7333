use crate::rounded::rounded;

/// Errors of a steady motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SlidingError {
    /// At a frequency that the motion meets, the bodies do not resist: their complex compliance has no positive real part.
    #[error("at {} rad/s the complex compliance is {} + {} i 1/Pa: its real part must be positive; check signs, units and frequencies of the moduli", rounded(*.omega, 5),
        rounded(.compliance[0], 5), rounded(.compliance[1], 5))]
    NotPassive {
        /// Frequency \[rad/s\].
        omega: f64,
        /// Real and imaginary part of the compliance, of the conjugate for waves that go with the motion \[1/Pa\].
        compliance: [f64; 2],
    },

    /// Rounding of the displacement exceeds the tolerance: bodies whose compliance at rest and in motion differ by many orders of magnitude
    /// are pressed so hard by the stiff waves that the soft ones are rounding.
    #[error("at a velocity of ({}, {}) m/s the rounding of the displacement is {rounding:.1e} of the gap that the contact closes, where {tolerance:.1e} is allowed: take a lower velocity, bodies that creep less, or a greater Settings::tolerance",
        rounded(.velocity[0], 5), rounded(.velocity[1], 5))]
    Rounding {
        /// Velocity \[m/s\].
        velocity: [f64; 2],
        /// Rounding of the displacement over the range of the gap that the contact closes.
        rounding: f64,
        /// The residual allowed.
        tolerance: f64,
    },

    /// The contact at a velocity was not found.
    #[error("at a velocity of ({}, {}) m/s {sets} sets of cells left a residual of {residual:.1e}, where {tolerance:.1e} is allowed: come from a velocity nearby, or allow a greater Settings::tolerance",
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
