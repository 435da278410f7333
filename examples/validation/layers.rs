//! Claims about layers of finite thickness.

use viscocontact::Result;
use viscocontact::prelude::*;

use crate::claim::{Checked, Outcome};

/// The reference: the integral equation of the axisymmetric contact, solved in `tests/validation/layers.rs`.
const REFERENCE: &str = "integral equation of Lebedev & Ufliand 1958";

/// Force under an approach on a layer bonded to a rigid base, over the modulus E*.
pub fn press(
    shape: &dyn Geometry,
    thickness: f64,
    nu: f64,
    (cells, length): (usize, f64),
    approach: f64,
) -> Result<f64> {
    let grid = Grid::square(cells, length)?;
    let material = Material::constant_poisson(Elastic::new(1.0e6)?, nu)?;
    let kernel = InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(thickness, nu)?)?;
    let mut contact =
        ViscoelasticContact::builder(grid).geometry(shape).material(material.clone()).kernel(kernel).build()?;
    contact.step(0.0, Load::approach(approach))?;
    Ok(contact.force() * material.contact_compliance(0.0))
}

/// A flat punch as wide as the layer is thick: P/(2E*aδ).
pub fn punch() -> Outcome {
    let a = 1.0e-3;
    let value = |nu: f64| -> Result<f64> {
        Ok(press(&FlatPunch::circular(a)?, a, nu, (256, 2.04 * a), 1.0e-6)? / (2.0 * a * 1.0e-6))
    };
    let rows = [
        ("force over the half-space's, ν = 0.5", value(0.5)?, 3.61874, 5e-3),
        ("force over the half-space's, ν = 0.3", value(0.3)?, 2.48352, 5e-3),
    ];
    Ok(Checked::new("flat punch on a bonded layer, a/h = 1, 256² cells", REFERENCE, &rows))
}

/// A ball on an incompressible layer as thick as the contact radius.
pub fn ball() -> Outcome {
    let (radius, h) = (10.0e-3, 0.2e-3);
    // √(Rδ)/h = 0.747941 at a = h
    let approach = (0.747941 * h) * (0.747941 * h) / radius;
    let force = press(&Sphere::new(radius)?, h, 0.5, (128, 2.3 * h), approach)?;
    let rows = [("3PR/(4E*a³)", 0.75 * force * radius / (h * h * h), 1.4105, 1e-3)];
    Ok(Checked::new("ball on a bonded incompressible layer, a/h = 1, 128² cells", REFERENCE, &rows))
}
