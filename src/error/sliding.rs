use super::ErrorKind;
use crate::rounded::rounded;

/// Errors of a steady motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SlidingError {
    /// At a frequency that the motion meets, the bodies do not resist: their complex modulus E′ + i
    /// E″ has no positive real part, or a negative imaginary one, as in the other convention, E′ −
    /// i E″.
    #[error(
        "at {} rad/s the complex modulus is {} + {} i Pa: in the convention E' + i E'' bodies have E' > 0 and E'' >= 0; \
        check signs, units and frequencies of the moduli",
        rounded(*.omega, 5), rounded(modulus(*.compliance)[0], 5), rounded(modulus(*.compliance)[1], 5)
    )]
    NotPassive {
        /// Frequency \[rad/s\].
        omega: f64,
        /// Real and imaginary part of the compliance, of the conjugate for waves that go with the motion \[1/Pa\].
        compliance: [f64; 2],
    },

    /// Rounding of the displacement exceeds the tolerance: bodies whose compliance at rest and in motion differ by
    /// many orders of magnitude are pressed so hard by the stiff waves that the soft ones are rounding.
    #[error("at a velocity of ({}, {}) m/s the rounding of the displacement is {rounding:.1e} of the gap that the \
        contact closes, where {tolerance:.1e} is allowed: take a lower velocity, bodies that creep less, or a \
        greater Settings::tolerance",
        rounded(.velocity[0], 5), rounded(.velocity[1], 5))]
    Rounding {
        /// Velocity \[m/s\].
        velocity: [f64; 2],
        /// Rounding of the displacement over the range of the gap that the contact closes.
        rounding: f64,
        /// The residual allowed.
        tolerance: f64,
    },

    /// The bodies would drive the motion, which bodies that dissipate cannot.
    #[error(
        "at a velocity of ({}, {}) m/s the bodies would drive the motion, by {} of the sum of what their waves resist and drive \
        with: cells longer than a layer is thick do not resolve its losses: refine the mesh",
        rounded(.velocity[0], 5), rounded(.velocity[1], 5), rounded(*.part, 3)
    )]
    Drives {
        /// Velocity \[m/s\].
        velocity: [f64; 2],
        /// The power over the sum of its parts without signs.
        part: f64,
    },

    /// A layer on a base of its own creep is too thin for the grid.
    #[error(
        "the grid is {} m long, {} times the thickness of a layer on a base that creeps otherwise, of which 64 are covered: \
        shorten the grid to {} m, or take a body that is periodic along both axes",
        rounded(*.length, 4), rounded(.length / .thickness, 3), rounded(*.longest, 4)
    )]
    ThinLayer {
        /// Length of the grid along an axis on which the bodies end \[m\].
        length: f64,
        /// Thickness of the layer \[m\].
        thickness: f64,
        /// The longest grid that is covered \[m\].
        longest: f64,
    },

    /// The contact at a velocity was not found.
    #[error("at a velocity of ({}, {}) m/s {sets} sets of cells left a residual of {residual:.1e}, where \
        {tolerance:.1e} is allowed: come from a velocity nearby, or allow a greater Settings::tolerance",
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

impl SlidingError {
    pub(super) fn error_kind(&self) -> ErrorKind {
        match self {
            SlidingError::NotConverged { .. } | SlidingError::Rounding { .. } | SlidingError::Drives { .. } => {
                ErrorKind::Convergence
            }
            SlidingError::ThinLayer { .. } => ErrorKind::Unsupported,
            SlidingError::NotPassive { .. } => ErrorKind::Value,
        }
    }
}

/// The modulus E′ + i E″ of the conjugate of a compliance.
fn modulus([re, im]: [f64; 2]) -> [f64; 2] {
    let square = re * re + im * im;
    [re / square, im / square]
}
