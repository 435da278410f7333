//! Contacts that many tests build: of one shape, most often a sphere of 10 mm.

use viscocontact::prelude::*;

pub const RADIUS: f64 = 10.0e-3;

pub fn sphere() -> Sphere {
    Sphere::new(RADIUS).unwrap()
}

/// A contact of one shape, before its kernel and its settings are given.
pub fn builder_of(shape: &dyn Geometry, grid: Grid, material: Material) -> Builder {
    ViscoelasticContact::builder(grid).geometry(shape).material(material)
}

pub fn contact_of(shape: &dyn Geometry, grid: Grid, material: Material, settings: Settings) -> ViscoelasticContact {
    builder_of(shape, grid, material).settings(settings).build().unwrap()
}

pub fn builder_on(grid: Grid, material: Material) -> Builder {
    builder_of(&sphere(), grid, material)
}

pub fn sphere_on(grid: Grid, material: Material, settings: Settings) -> ViscoelasticContact {
    contact_of(&sphere(), grid, material, settings)
}
