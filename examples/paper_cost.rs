//! The cost that the source paper states in its section 4, measured: O(N_t² N₁N₂ log(N₁N₂)) for its algorithm taken literally
//! (`paper/`), beside the default of this crate; and the ratio of their times, cause by cause. Writes a table (CSV) and pictures.
//!
//! Times are processor times where the system measures them (Linux), so that a busy machine disturbs them little.
//!
//! `RAYON_NUM_THREADS=1 cargo run --release -p viscocontact --features analytic,plot --example paper_cost`
//! (ten minutes), or with `-- --quick` (seconds)

#[path = "support/scenes/step_loaded_sphere.rs"]
mod step_loaded_sphere;
mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use step_loaded_sphere::StepLoadedSphere;
use viscocontact::Result;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;

/// Measures the cost that the source paper states.
#[derive(Parser)]
struct Args {
    /// Numbers of steps to twice the relaxation time.
    #[arg(long, value_delimiter = ',', default_value = "25,50,100,200,400")]
    steps: Vec<usize>,
    /// Cells along each side of the grid while the number of steps changes.
    #[arg(long, default_value_t = 64)]
    cells_of_steps: usize,
    /// Cells along each side of the grid, in --steps-of-cells steps.
    #[arg(long, value_delimiter = ',', default_value = "32,64,128,256")]
    cells: Vec<usize>,
    /// Steps while the number of cells changes.
    #[arg(long, default_value_t = 100)]
    steps_of_cells: usize,
    /// Small grids and few steps: no times to rely on.
    #[arg(long)]
    quick: bool,
    /// Folder for table and pictures.
    #[arg(long, default_value = "out/paper_cost")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.steps, args.cells_of_steps) = (vec![10, 20, 40], 16);
        (args.cells, args.steps_of_cells) = (vec![16, 32], 20);
    }
    support::finish(run(&args));
}

/// Processor time of all threads so far, else the time of day \[s\].
fn seconds_so_far(start: Instant) -> f64 {
    let times = fs::read_dir("/proc/self/task").map(|tasks| {
        let own = |task: std::io::Result<fs::DirEntry>| -> Option<f64> {
            let text = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
            Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
        };
        tasks.filter_map(own).sum::<f64>()
    });
    times.ok().filter(|&seconds| seconds > 0.0).unwrap_or_else(|| start.elapsed().as_secs_f64())
}

/// A way to compute the scene; the paper's without settings.
type Way = (&'static str, Option<Settings>);

const LITERALLY: Way = ("the source paper's algorithm, literally", None);

/// Cost of a run.
#[derive(Clone, Copy)]
struct Cost {
    /// Convolution equivalents: an application of the preconditioner counts a quarter.
    convolutions: f64,
    seconds: f64,
}

/// The least of three runs, or one where it takes longer than a second.
fn cost(cells: usize, steps: usize, (_, settings): Way) -> Result<Cost> {
    let scene = StepLoadedSphere::maxwell();
    let mut least: Option<Cost> = None;
    for _ in 0..3 {
        let clock = Instant::now();
        let start = seconds_so_far(clock);
        let convolutions = match settings {
            Some(settings) => scene.run(cells, steps, settings)?.1 * steps as f64,
            None => scene.literally(cells, steps)?.1.iter().sum::<usize>() as f64,
        };
        let seconds = seconds_so_far(clock) - start;
        least = least.filter(|least| least.seconds < seconds).or(Some(Cost { convolutions, seconds }));
        if seconds > 1.0 {
            break;
        }
    }
    Ok(least.unwrap_or(Cost { convolutions: 0.0, seconds: 0.0 }))
}

/// The slope of a straight line through the logarithms of the points, by least squares.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let [covariance, variance] = [mean(&|p| (p.0 - x) * (p.1 - y)), mean(&|p| (p.0 - x).powi(2))];
    covariance / variance
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let mut table = csv::Writer::from_path(args.output.join("paper_cost.csv"))?;
    table.write_record(["way", "cells", "steps", "convolutions", "seconds"])?;
    let over_steps: Vec<_> = args.steps.iter().map(|&steps| (steps as f64, args.cells_of_steps, steps)).collect();
    let over_cells: Vec<_> = args.cells.iter().map(|&n| ((n * n) as f64, n, args.steps_of_cells)).collect();
    let steps = sweep(&mut table, [&format!("{}² cells", args.cells_of_steps), "time steps N_t"], &over_steps)?;
    let cells = sweep(&mut table, [&format!("{} steps", args.steps_of_cells), "cells N1 N2"], &over_cells)?;
    table.flush()?;
    steps.save(args.output.join("paper_cost_steps.png"))?;
    cells.save(args.output.join("paper_cost_cells.png"))?;
    causes(args)?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}

/// Both ways over the abscissa of `runs`, with their cells and steps.
fn sweep(
    table: &mut csv::Writer<fs::File>,
    [of, symbol]: [&str; 2],
    runs: &[(f64, usize, usize)],
) -> Result<Chart, Box<dyn Error>> {
    let mut chart = Chart::new(format!("Time of a run, {of}"), symbol, "processor time [s]", Legend::UpperLeft);
    chart.scale = Scale::LogLog;
    println!("\n{of}\n| way | {symbol} | convolutions | seconds |\n|---|---|---|---|");
    let ways: [Way; 2] = [LITERALLY, ("this crate's defaults", Some(Settings::default()))];
    for (way, color) in ways.into_iter().zip(COLORS) {
        let (mut counts, mut times) = (Vec::new(), Vec::new());
        for &(x, cells, steps) in runs {
            let Cost { convolutions, seconds } = cost(cells, steps, way)?;
            println!("| {} | {x} | {convolutions:.0} | {seconds:.3} |", way.0);
            table.serialize((way.0, cells, steps, convolutions, seconds))?;
            counts.push((x, convolutions));
            times.push((x, seconds));
        }
        println!("exponents of {symbol}: {:.2} of convolutions, {:.2} of time", exponent(&counts), exponent(&times));
        chart.add(way.0, color, Style::LineAndDots, times);
    }
    Ok(chart)
}

/// From the paper's algorithm to the default, one cause after the other.
fn causes(args: &Args) -> Result<(), Box<dyn Error>> {
    let (cells, steps) = (if args.quick { 32 } else { 256 }, args.steps_of_cells);
    let whole = Settings::default().with_symmetry(false).with_window(false);
    let chain: [Way; 4] = [
        LITERALLY,
        ("time rule and solver of this crate", Some(whole)),
        ("symmetry", Some(whole.with_symmetry(true))),
        ("window (default)", Some(Settings::default())),
    ];
    let head = "| | ms per step | convolution equivalents per step | factor |\n|---|---|---|---|";
    let (mut rows, mut seconds): (Vec<String>, Vec<f64>) = (vec![head.to_owned()], Vec::new());
    let mut speed = "| | ms per step | convolution equivalents per step |\n|---|---|---|".to_owned();
    for (k, way) in chain.into_iter().enumerate() {
        let cost = cost(cells, steps, way)?;
        let factor = seconds.last().map_or(String::new(), |last| format!("{:.2}", last / cost.seconds));
        let [ms, each] = [1e3 * cost.seconds, cost.convolutions].map(|value| value / steps as f64);
        rows.push(format!("| {} | {ms:.2} | {each:.1} | {factor} |", way.0));
        seconds.push(cost.seconds);
        if k == 0 || k + 1 == chain.len() {
            let name = if k == 0 { LITERALLY.0 } else { "this crate's defaults" };
            speed += &format!("\n| {name} | {ms:.1} | {each:.1} |");
        }
    }
    rows.push(format!("| all together | | | {:.0} |", seconds[0] / seconds[seconds.len() - 1]));
    let rows = rows.join("\n");
    println!("\n{cells}² cells, {steps} steps\n{rows}");
    if !args.quick {
        support::figures::timed("where the factor comes from", &rows)?;
        support::figures::timed("speed", &speed)?;
    }
    Ok(())
}
