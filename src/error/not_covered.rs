use std::fmt;

use super::{Error, Result};

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

/// Whether something is the case, what is then not covered, and the cure.
pub(crate) type Refusal = (bool, &'static str, &'static str);

impl Special {
    /// Fails by the first of these that is the case.
    pub(crate) fn refuses<const N: usize>(self, cases: [Refusal; N]) -> Result<()> {
        let refuse = |(_, what, cure)| Err(Error::not_covered(self, what, cure));
        cases.into_iter().find(|(is, ..)| *is).map_or(Ok(()), refuse)
    }
}

/// The cure of what one process can do, and ranks cannot.
pub(crate) const ONE_PROCESS: &str = "compute the contact in one process";

impl Error {
    pub(crate) fn not_covered(special: Special, what: &'static str, cure: &'static str) -> Error {
        Error::NotCovered { special, what, cure }
    }

    /// What one process can do, and ranks cannot.
    pub(crate) fn not_shared(what: &'static str) -> Error {
        Error::not_covered(Special::Ranks, what, ONE_PROCESS)
    }
}
