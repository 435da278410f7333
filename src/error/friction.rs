use crate::error::ErrorKind;
use crate::rounded::{TIME, rounded};

/// Errors of contacts with friction in space.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrictionError {
    /// Bodies whose response along the surface is not known, or depends on the pressure.
    #[error(
        "friction in space covers half-spaces, periodic bodies and line contacts of a constant Poisson's ratio that do not \
        couple loads along the surface and normal to it: Poisson's ratio 1/2 on a rigid body, or two bodies of one material"
    )]
    OtherBodies,

    /// The tractions of a step were not found.
    #[error(
        "at t = {} s the tractions along the surface were not found: residual {residual:.1e} after {iterations} Newton \
        steps, where {tolerance:.1e} is allowed; take a shorter step, or a greater Settings::tolerance",
        rounded(*.time, TIME)
    )]
    NotConverged {
        /// End of the step \[s\].
        time: f64,
        /// Newton steps, of both starts.
        iterations: usize,
        /// The largest slip of a cell that sticks, over the largest displacement.
        residual: f64,
        /// What is allowed.
        tolerance: f64,
    },
}

impl FrictionError {
    pub(super) fn error_kind(&self) -> ErrorKind {
        match self {
            FrictionError::OtherBodies => ErrorKind::Unsupported,
            FrictionError::NotConverged { .. } => ErrorKind::Convergence,
        }
    }
}
