//! Loads of a history, checked, as runs ask for them.

use crate::error::{Error, Result};
use crate::load::{Load, LoadHistory};

impl dyn LoadHistory + '_ {
    /// The breakpoints after a time, as long as they ascend.
    pub(crate) fn breakpoints(&self, after: f64) -> impl Iterator<Item = f64> {
        std::iter::successors(Some(after), |&time| self.next_breakpoint(time).filter(|&next| next > time)).skip(1)
    }

    /// [`LoadHistory::at`], if it is a load that may act, or pull where surfaces attract each other.
    pub(crate) fn checked_at(&self, t: f64, attracts: bool) -> Result<Load> {
        self.checked(self.at(t), t, attracts)
    }

    /// [`LoadHistory::before`], if it is a load that may act.
    pub(crate) fn checked_before(&self, t: f64, attracts: bool) -> Result<Load> {
        self.checked(self.before(t), t, attracts)
    }

    fn checked(&self, load: Load, t: f64, attracts: bool) -> Result<Load> {
        load.validated_at(t, attracts).map_err(|error| self.failure().map_or(error, Error::User))
    }
}

impl Error {
    /// The same error of a load along the surface.
    pub(crate) fn along(self) -> Error {
        let of = |field| match field {
            "normal force" => "force along the surface",
            "approach" => "displacement along the surface",
            other => other,
        };
        match self {
            Error::OutOfRange { field, value, allowed } => Error::OutOfRange { field: of(field), value, allowed },
            Error::LoadOutOfRange { time, field, value, allowed } => {
                Error::LoadOutOfRange { time, field: of(field), value, allowed }
            }
            other => other,
        }
    }
}
