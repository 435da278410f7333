//! Friction of random rough surfaces on a standard solid over speed: many small contacts, one for each speed and seed, shared
//! out over the threads of this machine by rayon. A run that was stopped resumes where it ended. `mpi/examples/ensemble.rs`
//! is the same over processes of MPI.
//!
//! `cargo run --release -p viscocontact --features motion,plot,states,surfaces --example ensemble`

mod support;
#[path = "support/ensemble.rs"]
mod sweep;

use std::fs;
use std::path::PathBuf;

use clap::Parser;
use rayon::prelude::*;
use sweep::{Failure, Row, cases, print, table};
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};

/// Friction of random rough surfaces over speed.
#[derive(Parser)]
struct Args {
    /// Speeds between 1 mm/s and 1 m/s.
    #[arg(long, default_value_t = 13)]
    speeds: usize,
    /// Surfaces at each speed.
    #[arg(long, default_value_t = 8, value_parser = support::at_least_one)]
    seeds: usize,
    /// Cells along a period.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Few and coarse: 3 speeds, 2 seeds, 64 cells.
    #[arg(long)]
    quick: bool,
    /// Folder for the results of the cases, and the picture.
    #[arg(long, default_value = "out/ensemble")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()).map_err(|failure| failure as Box<dyn std::error::Error>));
}

fn run(args: &Args) -> Result<(), Failure> {
    let (speeds, seeds, cells) = if args.quick { (3, 2, 64) } else { (args.speeds, args.seeds, args.cells) };
    fs::create_dir_all(&args.output)?;
    let cases = cases(speeds, seeds);
    let progress = support::progress(cases.len() as u64);
    let friction = cases.par_iter().map(|case| {
        let friction = case.friction_kept_in(&args.output, cells);
        progress.inc(1);
        friction
    });
    let friction = friction.collect::<Result<Vec<f64>, Failure>>()?;
    progress.finish_and_clear();
    let rows = table(&cases, seeds, &friction);
    print(&rows);
    draw(&rows, args)
}

/// Mean friction over speed, and a standard deviation to both sides.
fn draw(rows: &[Row], args: &Args) -> Result<(), Failure> {
    let title = "Random surfaces sliding on a standard solid";
    let mut chart = Chart::new(title, "speed [m/s]", "friction coefficient", Legend::UpperRight);
    chart.scale = Scale::LogX;
    for (k, row) in rows.iter().enumerate() {
        let bar = [-1.0, 1.0].map(|side| (row.speed, row.mean + side * row.spread)).to_vec();
        chart.add(if k == 0 { "± a standard deviation" } else { "" }, COLORS[1], Style::Line, bar);
    }
    let means = rows.iter().map(|row| (row.speed, row.mean)).collect();
    chart.add("mean over surfaces", COLORS[0], Style::LineAndDots, means);
    let picture = args.output.join("friction.png");
    chart.save(&picture)?;
    println!("friction of each case and picture are in {}", args.output.display());
    Ok(())
}
