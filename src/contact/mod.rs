//! The stepper: a contact that is advanced in time, step by step or along a load history.
//!
//! A contact has five owners. The scene never changes. The indenter is replaced as a whole when it moves. The state
//! is changed by accepted steps. The window, which follows from the other three, computes on the region of the state.
//! The trial holds the step being computed. State, window and trial form a computation.
//!
//! | question | folder |
//! |---|---|
//! | how is a contact made from its parts? | `builder` |
//! | what is the gap before deformation, and where may loads act? | `equilibrium::indenter` |
//! | what does a step change, and what was it before, or within, the last one? | `state` |
//! | which part of the grid is computed? | `equilibrium::window` |
//! | what is one step? | `step` |
//! | what if the indenter moves? | `moving` |
//! | what does a user read? | `read` |
//! | how does a run go on after an interruption? | `checkpoint` |

// the documentation lists methods in the order of these modules: methods that drive a contact, then its results
mod builder;

pub(crate) mod step;

#[cfg(feature = "motion")]
pub(crate) mod moving;

mod read;

mod state;

#[cfg(feature = "checkpoint")]
pub(crate) mod checkpoint;
mod computation;
mod scene;
mod stepper;

pub use crate::error::StepError;
pub use crate::fields::BodyState;
pub use crate::fields::report::{Estimated, StepReport};
pub use builder::Builder;

pub use builder::memory::Memory;
#[cfg(feature = "motion")]
pub use moving::along_path::TravelReport;
#[cfg(feature = "energies")]
pub use read::energies::{Energies, EnergyBalance};
pub(crate) use read::limits::Limits;
pub use state::snapshot::Snapshot;
#[cfg(feature = "adhesion")]
pub use step::attraction::PassReport;
pub use stepper::ViscoelasticContact;

pub use crate::equilibrium::{Edge, Figures, Frame, Settings, TimeRule, Warnings};
pub(crate) use computation::Computation;
pub(crate) use scene::Scene;
pub(crate) use state::{Clock, State};
pub(crate) use step::planned::Step;
