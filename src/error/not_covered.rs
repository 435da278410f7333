use std::fmt;

use super::Error;

/// What makes a scene special, so that it does not cover all that others do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Special {
    /// Surfaces attract each other ([`crate::adhesion`]).
    Attraction,
    /// The contact moves steadily ([`crate::sliding`]).
    SteadyMotion,
    /// Ranks share out the rows of the grid ([`crate::parallel`]).
    Ranks,
}

impl fmt::Display for Special {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Special::Attraction => "where surfaces attract each other",
            Special::SteadyMotion => "in steady motion",
            Special::Ranks => "on rows that ranks share out",
        })
    }
}

impl Error {
    pub(crate) fn not_covered(special: Special, what: &'static str, cure: &'static str) -> Error {
        Error::NotCovered { special, what, cure }
    }

    /// What one process can do, and ranks cannot.
    pub(crate) fn not_shared(what: &'static str) -> Error {
        Error::not_covered(Special::Ranks, what, "compute the contact in one process")
    }
}
