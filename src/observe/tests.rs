//! A contact for the tests of most observations.

use crate::prelude::*;

/// A sphere pressed on an elastic half-space.
pub(super) fn sphere(cells: [usize; 2], lengths: [f64; 2], center: [f64; 2], force: f64) -> ViscoelasticContact {
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
pub(super) fn hertz(force: f64) -> [f64; 2] {
    let radius = (0.75 * force * 10.0e-3 / 4.0e6_f64).cbrt();
    [radius, 2.0 * radius * 4.0e6 / (std::f64::consts::PI * 10.0e-3)]
}
