//! Observations of the state of a contact.
//!
//! | question | answer |
//! |---|---|
//! | How high is the pressure? | [`mean_pressure`](crate::fields::Fields::mean_pressure), [`max_pressure`](crate::fields::Fields::max_pressure), [`pressure_distribution`](crate::fields::Fields::pressure_distribution) |
//! | How wide is the gap outside the contact? | [`gap_distribution`](crate::fields::Fields::gap_distribution) |
//! | What are the values along a line? | [`profile`](crate::fields::Fields::profile) |
//! | How many patches touch, and how large are they? | [`patches`](crate::fields::Fields::patches) |
//! | Is the contact shifted to one side? | [`asymmetry`](crate::fields::Fields::asymmetry) |
//! | How high is the stress below the surface, and where? | [`stress`](crate::fields::Fields::stress) |
//!
//! Each is a pure function of grid, pressure and gap; the methods apply it to the fields of a contact and change
//! nothing. Each visits the cells once; observations that need displacement or gap cost as much as
//! [`displacement`](crate::fields::Fields::displacement). [`SubsurfaceStress`] states the cost of the stress.

mod asymmetry;
mod distribution;
pub(crate) mod grid_convergence;
mod mesh_error;
mod of_fields;
mod patches;
pub(crate) mod profile;
#[cfg(feature = "stress")]
mod stress;
#[cfg(test)]
mod tests;

pub use crate::fields::mesh_error::MeshError;
pub use asymmetry::Asymmetry;
pub use distribution::Distribution;
pub use patches::{Patch, Patches};
pub use profile::LineProfile;
#[cfg(feature = "stress")]
pub use stress::{Stress, StressPeak, StressSection, StressVolume, SubsurfaceStress};
