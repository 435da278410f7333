//! The equilibrium of rigid bodies on an elastic body: what a contact of any kind solves for a load.

pub(crate) mod constraints;
pub(crate) mod extrapolation;
mod figures;
mod gap;
pub(crate) mod ground;
pub(crate) mod guess;
pub(crate) mod held;
pub(crate) mod indenter;
pub(crate) mod pressed;
pub(crate) mod request;
pub(crate) mod resolution;
mod settings;
pub(crate) mod spring;
mod warnings;
pub(crate) mod window;

pub(crate) use constraints::depth_of_power;
pub use figures::Figures;
pub(crate) use figures::{DEEP, modulus_of_no_solid};
pub(crate) use gap::RigidBodies;
pub(crate) use ground::{Ground, windowed};
pub(crate) use held::{Equilibrium, Held};
pub(crate) use indenter::Indenter;
pub(crate) use indenter::hull::Hull;
pub(crate) use indenter::slope::STEEP;
pub(crate) use request::{Request, Trial};
pub(crate) use settings::DEFAULT_TOLERANCE;
pub use settings::{Edge, Frame, Settings, TimeRule};
pub use warnings::Warnings;
pub(crate) use window::Window;
pub(crate) use window::region::Region;
