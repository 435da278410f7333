//! The first program of the README: a sphere pressed onto a creeping body by a force that is held. `step_loaded_sphere` computes the
//! same scene beside its closed form, with tables and pictures.
//!
//! `cargo run --release -p viscocontact --example quickstart`

use viscocontact::prelude::*;

fn main() -> viscocontact::Result<()> {
    let grid = Grid::square(256, 4.0e-3)?; // 256 × 256 cells on 4 mm × 4 mm
    let mut contact = ViscoelasticContact::builder(grid)
        .geometry(&Sphere::new(10.0e-3)?) // any `Geometry`
        .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?)) // G = 1 MPa, τ = 1 s
        .build()?;
    contact.step(0.0, Load::force(1.0))?; // Δ = 0: a jump of the load
    for _ in 0..100 {
        let report = contact.step(0.02, Load::force(1.0))?; // hold it
        println!("{report}"); // time, force, approach, cost, error in time, warnings
    }
    println!("{:.3} mm²", contact.contact_area() * 1e6);
    Ok(())
}
