//! What a step takes on many cells, by one process with its threads, or by threads that play ranks: see `docs/scale.md`.
//!
//! `cargo bench -p viscocontact-benches --bench scale -- 4096 ranks 4`: cells along a side; without ranks one process has
//! all rows. With `quarter` the scene is computed on a quarter of the grid, by symmetry.

#[path = "support/many_cells.rs"]
mod many_cells;

use many_cells::run;
use viscocontact::parallel::Threads;

fn main() -> viscocontact::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let after =
        |word: &str| arguments.iter().position(|argument| argument == word).and_then(|at| arguments.get(at + 1));
    let quarter = arguments.iter().any(|argument| argument == "quarter");
    let number = |word: &String| word.parse::<usize>().ok();
    let cells = arguments.first().and_then(number).unwrap_or(512);
    let Some(ranks) = after("ranks").and_then(number) else {
        run(cells, quarter, None)?.print(cells, 1, 1);
        return Ok(());
    };
    if let Some(first) = Threads::run(ranks, |group| run(cells, quarter, Some(group)))?.into_iter().next() {
        first?.print(cells, ranks, ranks);
    }
    Ok(())
}
