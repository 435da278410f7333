//! A program whose `main` returns the error of the crate: without an argument contact touches the edge of the grid, else the
//! history cannot be written to the path given.

use viscocontact::prelude::*;

fn main() -> viscocontact::Result<()> {
    let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Elastic::new(1.0e6)?))
        .build()?;
    if let Some(path) = std::env::args_os().nth(1) {
        use viscocontact::output::{CsvHistory, Earlier, Metadata};
        CsvHistory::create(path, &Metadata::new("Ball on rubber"), &contact, &[], Earlier::Refuse)?;
    }
    contact.step(0.0, Load::force(100.0)).map(drop)
}
