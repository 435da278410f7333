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

    /// A force along the surface in a run is more than friction carries.
    #[error(
        "at t = {} s the load along the surface is {} times what friction carries: the body slides along \
        {direction:?}; give less, or prescribe its motion", rounded(*.time, TIME), rounded(*.over_limit, 5))]
    Slides {
        /// End of the step \[s\].
        time: f64,
        /// Shifts and twist of the sliding motion, of the largest component 1.
        direction: [f64; 3],
        /// The forces over what is carried in their ratio.
        over_limit: f64,
    },

    /// A load along the surface that is neither a force nor a displacement.
    #[error(
        "a load along the surface is a force (Load::force) or a displacement (Load::approach) without tilt, not {0}"
    )]
    OtherLoad(String),
}

impl FrictionError {
    pub(super) fn error_kind(&self) -> ErrorKind {
        match self {
            FrictionError::OtherBodies => ErrorKind::Unsupported,
            FrictionError::NotConverged { .. } => ErrorKind::Convergence,
            FrictionError::Slides { .. } => ErrorKind::Value,
            FrictionError::OtherLoad(_) => ErrorKind::Value,
        }
    }
}
