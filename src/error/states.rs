use super::ErrorKind;
use crate::rounded::{TIME, rounded};

/// What the elastic states of a contact cannot answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatesError {
    /// The pressure of an elastic contact falls somewhere while its load grows, so that its states are no family of
    /// contacts that only grow. [`ViscoelasticContact`](crate::ViscoelasticContact) computes such a scene.
    #[error(
        "between the levels {} and {} m² the pressure of the elastic contact falls by {} of the maximum pressure \
        somewhere, where at most {} is rounding: its elastic states do not superpose; step it with \
        ViscoelasticContact",
        rounded(.levels[0], 3), rounded(.levels[1], 3), rounded(*.fall, 3), rounded(*.allowed, 3)
    )]
    Shrinks {
        /// Levels between which the pressure falls \[m²\].
        levels: [f64; 2],
        /// Maximum fall of the pressure of a cell over the maximum pressure.
        fall: f64,
        /// Maximum fall that is taken for rounding.
        allowed: f64,
    },

    /// The contact needs a state beyond the last one of the sweep.
    #[error("at t = {} s the contact needs {needed}, beyond the last elastic state at {}: sweep further \
        (states::Reach)", rounded(*.time, TIME), rounded(*.last, TIME))]
    Beyond {
        /// End of the step \[s\].
        time: f64,
        /// What is needed: a level, or an approach.
        needed: String,
        /// The level of the last state \[m²\], or its approach \[m\].
        last: f64,
    },

    /// The contact needs a level below the first from which the elastic contact only grows.
    #[error("at t = {} s the contact needs the level {level:.3e} m², below {first:.3e} m², from which the \
        pressure of the elastic contact falls nowhere: step it with ViscoelasticContact", rounded(*.time, TIME))]
    Below {
        /// End of the step \[s\].
        time: f64,
        /// The level needed \[m²\].
        level: f64,
        /// The first level \[m²\].
        first: f64,
    },

    /// The tilts of a load are not those of the sweep: a load point that moves and tilts that change are not covered.
    /// [`ViscoelasticContact`](crate::ViscoelasticContact) computes them.
    #[error(
        "the states were swept for {swept}, and {given} was given: a load point or a prescribed tilt that changes \
        is no superposition of elastic states; step it with ViscoelasticContact"
    )]
    OtherTilt {
        /// The tilts of the sweep, in words.
        swept: String,
        /// The load given, in words.
        given: String,
    },

    /// The pressures of the states were not kept.
    #[error("the states hold no pressures: call Sweep::keep_pressures before the sweep")]
    NoPressures,

    /// The states were read from a file or given as a table: no contact can be solved between them.
    #[error("the states hold no surface to solve a contact on: fields need the states of a Sweep of this process")]
    NoScene,

    /// A group of levels left 0 ≤ W ≤ 1, or pulls: the levels are not in order, and the superposition is not proved.
    #[error("at t = {} s the elastic states do not superpose: a share that must be in [0, 1] is {}; take a \
        shorter step, or step the scene with ViscoelasticContact", rounded(*.time, TIME), rounded(*.displacement, 5))]
    OutOfOrder {
        /// End of the step \[s\].
        time: f64,
        /// Displacement of the group, 1 in contact.
        displacement: f64,
    },

    /// Bodies that do not respond alike to normal and to tangential loads: their friction is no superposition of
    /// elastic states.
    #[error(
        "these bodies respond to loads along the surface in another way than to normal ones: friction on elastic \
        states is exact in line contact and at Poisson's ratio 0, where ν = ½ or two bodies are of one material; \
        with_estimated_friction takes half-spaces of any constant Poisson's ratio"
    )]
    OtherKernel,

    /// A load along the surface of a contact without friction.
    #[error("the contact has no friction that could carry a load along its surface: call with_friction first")]
    NoFriction,

    /// A force along the surface is more than friction carries.
    #[error(
        "at t = {} s the force along the surface is {} times what friction carries, f P: the body slides away; \
        give less, or prescribe its motion or a spring", rounded(*.time, TIME), rounded(*.over_limit, 5))]
    Slides {
        /// End of the step \[s\].
        time: f64,
        /// The force over f P.
        over_limit: f64,
    },

    /// A part of the contact inside the one that slips cannot stick.
    #[error(
        "at t = {} s a part of the contact would have to carry {} times what friction carries, inside the part \
        that slips: the elastic states do not superpose; take a shorter step",
        rounded(*.time, TIME), rounded(*.share, 5))]
    BeyondFriction {
        /// End of the step \[s\].
        time: f64,
        /// θ over f w.
        share: f64,
    },
}

impl StatesError {
    pub(super) fn error_kind(&self) -> ErrorKind {
        match self {
            StatesError::OutOfOrder { .. } => ErrorKind::Convergence,
            StatesError::Beyond { .. } | StatesError::Below { .. } => ErrorKind::Value,
            _ => ErrorKind::Unsupported,
        }
    }
}
