//! Cost of a step: the paper's scene on several meshes, computed in every way there is, in units of one convolution
//! on the whole grid. Writes a table (CSV) and a picture.
//!
//! `RAYON_NUM_THREADS=1 cargo run --release -p viscocontact --features data,plot --example performance`
//! (about a minute), or with `-- --cells 64` (a second)

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use viscocontact::InfluenceKernel;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;

/// Measures what a step costs.
#[derive(Parser)]
struct Args {
    /// Cells along each axis.
    #[arg(long, value_delimiter = ',', default_value = "32,64,128,256,512")]
    cells: Vec<usize>,
    /// Steps to twice the relaxation time.
    #[arg(long, default_value_t = 100)]
    steps: usize,
    /// Tolerance of the solver.
    #[arg(long, default_value_t = 1e-6)]
    tolerance: f64,
    /// Grids up to so many cells along each axis are computed by the paper's algorithm, too.
    #[arg(long, default_value_t = 256)]
    paper_up_to: usize,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the picture.
    #[arg(long, default_value = "out/performance")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (vec![32, 64], 20);
    }
    support::finish(run(&args));
}

const RADIUS: f64 = 10.0e-3;
const FORCE: f64 = 1.0;

/// Measurements of one way to compute one scene.
struct Cost {
    milliseconds: f64,
    equivalents: f64,
}

/// Ways to compute the scene, and the side of the grid over the side of the tightest grid.
fn ways(tolerance: f64) -> Vec<(&'static str, Settings, f64)> {
    let settings = Settings::default().with_tolerance(tolerance);
    let whole = settings.with_symmetry(false).with_window(false);
    // a grid that the final contact, π a², fills a sixteenth of
    let wide = 4.0 * std::f64::consts::PI.sqrt() / 2.25;
    vec![
        ("default", settings, 1.0),
        ("whole grid", whole, 1.0),
        ("contact on 1/16, window", settings.with_symmetry(false), wide),
        ("contact on 1/16, whole grid", whole, wide),
    ]
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let ways = ways(args.tolerance);
    let mut table = csv::Writer::from_path(args.output.join("performance.csv"))?;
    table.write_record([
        "cells",
        "way",
        "step [ms]",
        "equivalents",
        "convolution [ms]",
        "step/convolution",
        "ns/(N² log2 N²)",
    ])?;
    let mut series = vec![Vec::new(); ways.len()];
    let mut rows = vec![String::new(); ways.len()];
    let progress = support::progress((args.cells.len() * ways.len()) as u64);
    for &cells in &args.cells {
        let convolution = time_of_a_convolution(cells)?;
        for ((way, points), row) in ways.iter().zip(&mut series).zip(&mut rows) {
            progress.inc(1);
            let cost = cost(cells, args.steps, way.1, way.2)?;
            let all = (cells * cells) as f64;
            progress.suspend(|| {
                println!(
                    "{cells:4}², {:28} {:9.3} ms a step = {:6.2} convolutions on the whole grid; {:5.2} equivalents",
                    way.0,
                    cost.milliseconds,
                    cost.milliseconds / convolution,
                    cost.equivalents,
                );
            });
            table.write_record([
                cells.to_string(),
                way.0.to_string(),
                format!("{:.4}", cost.milliseconds),
                format!("{:.2}", cost.equivalents),
                format!("{convolution:.4}"),
                format!("{:.2}", cost.milliseconds / convolution),
                format!("{:.3}", 1e6 * cost.milliseconds / (all * all.log2())),
            ])?;
            points.push((cells as f64, cost.milliseconds));
            *row += &format!(" {:.3} ({:.1}) |", cost.milliseconds, cost.milliseconds / convolution);
        }
    }
    progress.finish_and_clear();
    table.flush()?;
    if args.cells.len() == 5 {
        let heads: String = args.cells.iter().map(|cells| format!(" {cells}² |")).collect();
        let rows =
            ways.iter().zip(&rows).map(|(way, row)| format!("| {} |{row}", way.0)).collect::<Vec<_>>().join("\n");
        support::figures::timed("step by method", &format!("| |{heads}\n|---|---|---|---|---|---|\n{rows}"))?;
    }

    let (x, y) = ("cells along each axis", "milliseconds");
    let mut chart = Chart::new("Time of a step", x, y, Legend::UpperLeft);
    chart.scale = Scale::LogLog;
    for ((way, points), color) in ways.iter().zip(series).zip(COLORS.iter().cycle()) {
        chart.add(way.0, *color, Style::LineAndDots, points);
    }
    chart.save(args.output.join("performance.png"))?;
    println!("{} holds performance.csv and performance.png", args.output.display());
    Ok(())
}

/// The median of three runs: mean time of a step \[ms\].
fn cost(cells: usize, steps: usize, settings: Settings, wide: f64) -> Result<Cost, Box<dyn Error>> {
    let material = || Ok::<_, viscocontact::Error>(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?));
    // to t = 2τ the compliance grows to three times that at first
    let radius = (0.75 * RADIUS * FORCE * material()?.contact_compliance(2.0)).cbrt();
    let mut costs = Vec::new();
    for _ in 0..3 {
        let mut contact = ViscoelasticContact::builder(Grid::square(cells, 2.25 * radius * wide)?)
            .geometry(&Sphere::new(RADIUS)?)
            .material(material()?)
            .settings(settings)
            .build()?;
        contact.step(0.0, Load::force(FORCE))?;
        let (start, mut equivalents) = (Instant::now(), 0.0);
        for _ in 0..steps {
            equivalents += contact.step(2.0 / steps as f64, Load::force(FORCE))?.convolution_equivalents();
        }
        let milliseconds = 1e3 * start.elapsed().as_secs_f64() / steps as f64;
        costs.push(Cost { milliseconds, equivalents: equivalents / steps as f64 });
    }
    costs.sort_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
    Ok(costs.swap_remove(1))
}

/// On the whole grid \[ms\], the median of nine.
fn time_of_a_convolution(cells: usize) -> Result<f64, Box<dyn Error>> {
    let kernel = InfluenceKernel::half_space(&Grid::square(cells, 1.0)?)?;
    let mut work = kernel.workspace()?;
    let (pressure, mut out) = (vec![1.0; cells * cells], vec![0.0; cells * cells]);
    let repeat = 1 + (1 << 18) / (cells * cells);
    let mut times = Vec::new();
    for _ in 0..9 {
        let start = Instant::now();
        for _ in 0..repeat {
            kernel.convolve(&pressure, &mut out, &mut work)?;
        }
        times.push(1e3 * start.elapsed().as_secs_f64() / repeat as f64);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[4])
}
