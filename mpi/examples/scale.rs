//! What a step takes on many cells, over processes of MPI: see `docs/scale.md`.
//!
//! `cargo build --release --example scale && mpirun -n 2 target/release/examples/scale 4096`: cells along a side. With `quarter`
//! behind them the scene is computed on a quarter of the grid, by symmetry.

#[path = "../../benches/support/many_cells.rs"]
mod many_cells;

use viscocontact::parallel::Ranks;
use viscocontact_mpi::Mpi;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ranks = Mpi::start()?;
    let cells = std::env::args().nth(1).map_or(Ok(1024), |cells| cells.parse())?;
    let quarter = std::env::args().any(|argument| argument == "quarter");
    let seen = many_cells::run(cells, quarter, Some(ranks.clone()))?;
    if ranks.rank() == 0 {
        seen.print(cells, ranks.size(), 1);
    }
    Ok(())
}
