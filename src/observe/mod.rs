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

pub use crate::fields::mesh_error::MeshError;
pub use patches::{Patch, Patches};
pub use profile::LineProfile;
#[cfg(feature = "stress")]
pub use stress::{Stress, StressPeak, StressSection, StressVolume, SubsurfaceStress};

/// A sphere pressed on an elastic half-space, for the tests of most observations.
#[cfg(test)]
pub(crate) fn sphere(cells: [usize; 2], lengths: [f64; 2], center: [f64; 2], force: f64) -> crate::ViscoelasticContact {
    use crate::prelude::*;

    let shape = Shifted::new(Sphere::new(10.0e-3).unwrap(), center).unwrap();
    let mut contact = ViscoelasticContact::builder(Grid::new(cells, lengths).unwrap())
        .geometry(&shape)
        .material(Material::incompressible(Elastic::new(1.0e6).unwrap()))
        .build()
        .unwrap();
    contact.step(0.0, Load::force(force)).unwrap();
    contact
}

/// Radius and maximum pressure of its contact under a force (Hertz): a³ = 3WR/4E*, p0 = 2aE*/πR.
#[cfg(test)]
pub(crate) fn hertz(force: f64) -> [f64; 2] {
    let radius = (0.75 * force * 10.0e-3 / 4.0e6_f64).cbrt();
    [radius, 2.0 * radius * 4.0e6 / (std::f64::consts::PI * 10.0e-3)]
}
