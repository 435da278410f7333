//! Bodies that many tests press.

use viscocontact::prelude::*;

/// Shear modulus of the elastic body, and of the others at first \[Pa\].
pub const G: f64 = 1.0e6;
/// E* of the elastic body, which is incompressible \[Pa\].
pub const E_STAR: f64 = 4.0 * G;

pub fn elastic() -> Material {
    Material::incompressible(Elastic::new(G).unwrap())
}

/// A relaxation time of 1 s.
pub fn maxwell() -> Material {
    Material::incompressible(Maxwell::new(G, 1.0e6).unwrap())
}

/// G again in the end, after a retardation time of 1 s: twice the compliance.
pub fn zener() -> Material {
    Material::incompressible(Zener::new(G, 1.0e6, 1.0e6).unwrap())
}

pub fn three_times() -> Material {
    let terms = [(1.0e6, 0.03), (0.5e6, 0.3), (0.5e6, 3.0)];
    Material::incompressible(GeneralizedMaxwell::new(0.1e6, &terms).unwrap())
}

/// A body without an exact series: one is fitted over the times of [`Builder::times`].
pub fn power_law() -> Material {
    Material::constant_poisson(PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap(), 0.3).unwrap()
}
