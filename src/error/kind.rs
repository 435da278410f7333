//! What sort of failure an error is.

use crate::error::{Error, KernelError, MaterialError, StepError};

/// What sort of failure an [`Error`] is, for programs that map errors to others. The error itself tells field, value
/// and remedy.
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
            Error::File(_) | Error::Output(_) => ErrorKind::File,
            #[cfg(feature = "checkpoint")]
            Error::Checkpoint { .. } => ErrorKind::File,
            #[cfg(feature = "adhesion")]
            Error::Adhesion(error) => error.error_kind(),
            #[cfg(feature = "text")]
            Error::Text(_) => ErrorKind::File,
            #[cfg(feature = "surfaces")]
            Error::Map(error) => error.error_kind(),
            #[cfg(feature = "friction")]
            Error::Friction(error) => error.error_kind(),
            #[cfg(feature = "sliding")]
            Error::Sliding(error) => error.error_kind(),
            #[cfg(feature = "states")]
            Error::States(error) => error.error_kind(),
            Error::OutOfMemory { .. } => ErrorKind::Memory,
            Error::Cancelled { .. } | Error::Ranks(_) => ErrorKind::Cancelled,
            Error::Material(MaterialError::PoorFit { .. })
            | Error::Step(StepError::NotConverged { .. } | StepError::StepTooShort { .. }) => ErrorKind::Convergence,
            Error::NotCovered { .. }
            | Error::Kernel(KernelError::NoStress { .. })
            | Error::Material(MaterialError::ChangingPoisson { .. } | MaterialError::VerticalFactors { .. })
            | Error::Step(StepError::TiltOfPeriodic { .. }) => ErrorKind::Unsupported,
            _ => ErrorKind::Value,
        }
    }
}
