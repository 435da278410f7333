//! The stepper: a contact that is advanced in time, step by step or along a load history.
//!
//! A contact has five owners: the scene never changes; the indenter is replaced whole when it moves; the state is what a
//! step changes; the window computes on the region of the state, and follows from the three above; the trial is the step
//! being tried. State, window and trial form a
//! computation.

// the documentation shows methods in the order of these: what drives a contact, then what it tells
mod builder;

mod step;

mod run;

mod moving;

mod accessors;

mod observations;

mod within_step;

mod snapshot;

mod brought;
mod build;
#[cfg(feature = "checkpoint")]
mod checkpoint;
mod computation;
mod extrapolation;
mod footprint;
mod hull;
mod indenter;
mod own_rows;
mod report;
mod request;
mod scene;
mod set_geometry;
mod settings;
mod shared_area;
mod shared_gap;
mod state;
mod time_rule;
mod times;
mod trial;
mod view;
mod viscoelastic;
mod warning;
mod window;

#[cfg(feature = "checkpoint")]
pub use crate::error::CheckpointError;
#[cfg(any(feature = "npy", feature = "vtk"))]
pub(crate) use brought::Brought;
pub use builder::Builder;
pub use footprint::Memory;
pub use moving::along_path::TravelReport;
pub use moving::steady::{SteadyMotion, TowardSteady};
pub use report::{BodyState, StepReport};
pub use run::error_budget::ErrorBudget;
pub use run::follow::Follow;
pub use run::stepping::Stepping;
pub use settings::{Edge, Frame, Settings, Solver, TimeRule};
pub use snapshot::Snapshot;
pub use viscoelastic::ViscoelasticContact;
pub use warning::{Warning, Warnings};
pub(crate) use window::extent::Extent;
