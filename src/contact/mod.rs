//! The stepper: a contact that is advanced in time, step by step or along a load history.

mod access;
mod builder;
mod follow;
mod guess;
mod hull;
mod report;
mod settings;
mod stepper;

pub use builder::Builder;
pub use follow::{Follow, Stepping};
pub use report::{BodyState, StepReport};
pub use settings::{Edge, Settings, Solver, TimeRule};
pub use stepper::ViscoelasticContact;
