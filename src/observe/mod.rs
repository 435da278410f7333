//! What is asked of the state of a contact over time.
//!
//! | question | answer |
//! |---|---|
//! | how hard is it pressed? | [`mean_pressure`](crate::ViscoelasticContact::mean_pressure), [`greatest_pressure`](crate::ViscoelasticContact::greatest_pressure), [`pressure_distribution`](crate::ViscoelasticContact::pressure_distribution) |
//! | how far is the rest apart? | [`gap_distribution`](crate::ViscoelasticContact::gap_distribution) |
//! | what does a line across it look like? | [`profile`](crate::ViscoelasticContact::profile) |
//! | how many spots touch, how large? | [`patches`](crate::ViscoelasticContact::patches) |
//! | is it pressed to one side? | [`asymmetry`](crate::ViscoelasticContact::asymmetry) |
//!
//! All of them read the state and change nothing. Each goes through the cells once; those that need displacement or
//! gap cost what [`displacement`](crate::ViscoelasticContact::displacement) costs.

pub(crate) mod area;
mod asymmetry;
mod distribution;
pub(crate) mod mesh_error;
mod patches;
mod pressure;
mod profile;

pub use asymmetry::Asymmetry;
pub use distribution::Distribution;
pub use mesh_error::MeshError;
pub use patches::{Patch, Patches};
pub use profile::{Axis, LineProfile};

/// A sphere pressed on an elastic half-space: what most observables are checked on.
#[cfg(test)]
fn sphere(cells: [usize; 2], lengths: [f64; 2], center: [f64; 2], force: f64) -> crate::ViscoelasticContact {
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
