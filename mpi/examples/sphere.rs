//! A sphere pressed onto a creeping half-space by all processes of `mpirun`; rank 0 prints.
//!
//! `cargo build --release --example sphere && mpirun -n 4 target/release/examples/sphere 1024`

use std::time::Instant;

use viscocontact::parallel::Ranks;
use viscocontact::prelude::*;
use viscocontact_mpi::Mpi;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ranks = Mpi::start()?;
    let cells = std::env::args().nth(1).map_or(Ok(512), |cells| cells.parse())?;
    let mut contact = ViscoelasticContact::builder(Grid::square(cells, 4.0e-3)?)
        .ranks(ranks.clone())
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?)) // retarded by 1 s
        .settings(Settings::default().with_symmetry(false))
        .build()?;
    for step in 0..4 {
        let start = Instant::now();
        let report = contact.step(if step == 0 { 0.0 } else { 0.2 }, Load::force(1.0))?;
        if ranks.rank() == 0 {
            println!("{report} ({:.3} s on {} ranks)", start.elapsed().as_secs_f64(), ranks.size());
        }
    }
    Ok(())
}
