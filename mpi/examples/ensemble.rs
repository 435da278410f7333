//! The sweep of `examples/ensemble.rs` over processes of MPI: each takes every n-th case, and rank 0 prints the table.
//!
//! `cargo build --release --example ensemble && mpirun -n 4 target/release/examples/ensemble out/ensemble`

#[path = "../../examples/support/ensemble.rs"]
mod sweep;

use std::path::PathBuf;

use sweep::{cases, print, table};
use viscocontact::parallel::Ranks;
use viscocontact_mpi::Mpi;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ranks = Mpi::start()?;
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or("out/ensemble".into()));
    std::fs::create_dir_all(&folder)?;
    let (speeds, seeds, cells) = (13, 8, 128);
    let cases = cases(speeds, seeds);
    let of = |rank: usize| (rank..cases.len()).step_by(ranks.size());
    let own = of(ranks.rank()).map(|case| cases[case].friction_kept_in(&folder, cells));
    let own = own.collect::<Result<Vec<_>, _>>().map_err(|failure| failure as Box<dyn std::error::Error>)?;
    let counts: Vec<usize> = (0..ranks.size()).map(|rank| of(rank).len()).collect();
    let mut gathered = vec![0.0; cases.len()];
    ranks.gather(&own, &counts, &mut gathered)?;
    // rank by rank, which is not their order
    let mut friction = vec![0.0; cases.len()];
    (0..ranks.size()).flat_map(of).zip(gathered).for_each(|(case, value)| friction[case] = value);
    if ranks.rank() == 0 {
        print(&table(&cases, seeds, &friction));
    }
    Ok(())
}
