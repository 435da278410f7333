//! What sort of failure an error is.

use crate::error::{
    AdhesionError, Error, KernelError, MapError, MaterialError, RanksError, SlidingError, StatesError, StepError,
};

/// What sort of failure an [`Error`] is, for programs that map errors to others. The error itself tells field, value and cure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A value, table, load or function that was given is not allowed here.
    Value,
    /// A file cannot be read, understood or written.
    File,
    /// More memory is needed than is available or allowed.
    Memory,
    /// The caller, or another rank, ended the call.
    Cancelled,
    /// A search did not converge, or needs shorter steps than there are.
    Convergence,
    /// The combination is not covered: another way of computing is needed.
    Unsupported,
}

impl Error {
    /// What sort of failure this is.
    ///
    /// ```
    /// use viscocontact::{ErrorKind, prelude::*};
    ///
    /// assert_eq!(Sphere::new(-1.0).unwrap_err().kind(), ErrorKind::Value);
    /// assert_eq!(HeightMap::from_sdf(&b"no map"[..]).unwrap_err().kind(), ErrorKind::File);
    /// ```
    pub fn kind(&self) -> ErrorKind {
        match self {
            Error::OutOfRange { .. }
            | Error::CountOutOfRange { .. }
            | Error::WrongLength { .. }
            | Error::OutOfOrder { .. }
            | Error::Load(_)
            | Error::InvalidGap { .. }
            | Error::NothingToTouch { .. }
            | Error::Missing { .. }
            | Error::Table(_)
            | Error::OtherContact
            | Error::NoDomain { .. }
            | Error::User(_) => ErrorKind::Value,
            Error::File(_) | Error::Text(_) | Error::Output(_) => ErrorKind::File,
            #[cfg(feature = "checkpoint")]
            Error::Checkpoint { .. } => ErrorKind::File,
            Error::OutOfMemory { .. } => ErrorKind::Memory,
            Error::Cancelled { .. } => ErrorKind::Cancelled,
            Error::NotCovered { .. } => ErrorKind::Unsupported,
            Error::Kernel(error) => match error {
                KernelError::NoStress { .. } => ErrorKind::Unsupported,
                _ => ErrorKind::Value,
            },
            Error::Material(error) => match error {
                MaterialError::ChangingPoisson { .. } => ErrorKind::Unsupported,
                MaterialError::PoorFit { .. } => ErrorKind::Convergence,
                _ => ErrorKind::Value,
            },
            Error::Map(error) => match error {
                MapError::NotFinite { .. }
                | MapError::NothingKnown
                | MapError::TooFine { .. }
                | MapError::Incomplete { .. }
                | MapError::NotFilled { .. } => ErrorKind::Value,
                _ => ErrorKind::File,
            },
            Error::Ranks(error) => match error {
                RanksError::Left { .. } | RanksError::Failed { .. } | RanksError::Apart => ErrorKind::Cancelled,
            },
            Error::Adhesion(error) => match error {
                AdhesionError::NotConverged { .. } => ErrorKind::Convergence,
                _ => ErrorKind::Value,
            },
            Error::Sliding(error) => match error {
                SlidingError::NotPassive { .. } => ErrorKind::Value,
                SlidingError::NotConverged { .. } => ErrorKind::Convergence,
            },
            Error::States(error) => match error {
                StatesError::Beyond { .. } | StatesError::Below { .. } => ErrorKind::Value,
                StatesError::OutOfOrder { .. } => ErrorKind::Convergence,
                _ => ErrorKind::Unsupported,
            },
            Error::Step(error) => match error {
                StepError::TiltOfPeriodic { .. } => ErrorKind::Unsupported,
                StepError::HistoryFull { .. } => ErrorKind::Memory,
                StepError::NotConverged { .. } | StepError::StepTooShort { .. } | StepError::NotSteady { .. } => {
                    ErrorKind::Convergence
                }
                _ => ErrorKind::Value,
            },
        }
    }
}
