//! Observations of the state of a contact.
//!
//! | question | answer |
//! |---|---|
//! | How high is the pressure? | [`mean_pressure`](crate::fields::Fields::mean_pressure), [`max_pressure`](crate::fields::Fields::max_pressure) |
//! | How wide is the gap outside the contact? | [`gap_into`](crate::fields::Fields::gap_into) |
//! | What are the values along a line? | [`profile`](crate::fields::Fields::profile) |
//! | How many patches touch, and how large are they? | [`patches`](crate::fields::Fields::patches) |
//! | Is the contact shifted to one side? | [`moment`](crate::fields::Fields::moment) over [`force`](crate::fields::Fields::force), the centre of pressure |
//! | How high is the stress below the surface, and where? | [`stress`](crate::fields::Fields::stress) |
//!
//! Each is a pure function of grid, pressure and gap; the methods apply it to the fields of a contact and change
//! nothing. Each visits the cells once; observations that need displacement or gap cost as much as
//! [`displacement`](crate::fields::Fields::displacement). [`SubsurfaceStress`] states the cost of the stress.

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
pub use patches::{Patch, Patches};
pub use profile::LineProfile;
#[cfg(feature = "stress")]
pub use stress::{Stress, StressPeak, StressSection, StressVolume, SubsurfaceStress};
