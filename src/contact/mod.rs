//! The stepper: a contact that is advanced in time, step by step or along a load history.

mod access;
mod adaptive;
mod area;
mod between;
mod builder;
mod change;
#[cfg(feature = "checkpoint")]
mod checkpoint;
mod doubts;
mod extent;
mod follow;
mod frame;
mod guess;
mod hull;
mod jump;
mod lateral;
mod loads;
mod memory;
mod region;
mod report;
mod reside;
mod settings;
mod snapshot;
mod spatial;
mod state;
mod steady;
mod stepper;
mod stiffness;
mod travel;
mod viscoelastic;
mod warning;

#[cfg(feature = "checkpoint")]
pub use crate::error::CheckpointError;
pub use between::Between;
pub use builder::Builder;
pub use follow::{ErrorBudget, Follow, Stepping};
pub use memory::Memory;
pub use report::{BodyState, StepReport};
pub use settings::{Edge, Frame, Settings, Solver, TimeRule};
pub use snapshot::Snapshot;
pub(crate) use spatial::AREA_ORDER;
pub use spatial::SpatialError;
pub use steady::{SteadyMotion, TowardSteady};
pub use travel::TravelReport;
pub use viscoelastic::ViscoelasticContact;
pub use warning::{IntoIter as WarningsIter, Warning, Warnings};
