//! A sphere of 10 mm on a half-space, which many tests press.

use viscocontact::prelude::*;

pub const RADIUS: f64 = 10.0e-3;

pub fn sphere() -> Sphere {
    Sphere::new(RADIUS).unwrap()
}

pub fn builder_on(grid: Grid, material: Material) -> Builder {
    ViscoelasticContact::builder(grid).geometry(&sphere()).material(material)
}

pub fn sphere_on(grid: Grid, material: Material, settings: Settings) -> ViscoelasticContact {
    builder_on(grid, material).settings(settings).build().unwrap()
}
