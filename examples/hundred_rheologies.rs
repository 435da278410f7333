//! A hundred rheologies on one rough surface, over nine decades of time. The surface is solved once, by a sweep of its
//! elastic states; after that a material costs a millisecond. Each body creeps as a power of time, with an exponent of
//! its own, and to the same compliance in the end: all areas meet there. At the end half of the load is taken off.
//!
//! One of them is stepped in space, too, for comparison.
//!
//! `cargo run --release -p viscocontact --features plot,states,surfaces --example hundred_rheologies`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::states::{Reach, StatesContact, Sweep};

/// The contact area of a hundred rheologies on one rough surface.
#[derive(Parser)]
struct Args {
    /// Number of rheologies.
    #[arg(long, default_value_t = 100, value_parser = support::at_least_one)]
    rheologies: usize,
    /// Cells along each side of the surface.
    #[arg(long, default_value_t = 256)]
    cells: usize,
    /// A small grid, for a look.
    #[arg(long)]
    quick: bool,
    /// Folder for the picture.
    #[arg(long, default_value = "out/hundred_rheologies")]
    output: PathBuf,
}

/// First and last time [s], and the time of a whole run.
const TIMES: [f64; 3] = [1.0e-3, 1.0e6, 1.0e7];
/// Force [N], compliance at the last time [1/Pa], side of the surface [m].
const FORCE: f64 = 1.0;
const COMPLIANCE: f64 = 3.0e-8;
const LENGTH: f64 = 1.0e-3;

fn main() {
    support::finish(run(&Args::parse()));
}

/// C ∝ t^n by two relaxation times a decade, with C = `COMPLIANCE` at the last time.
fn body(exponent: f64) -> viscocontact::Result<Material> {
    let scaled = |scale: f64| {
        let times = (-1..=19).map(|k| TIMES[0] * 10f64.powf(0.5 * f64::from(k)));
        let terms: Vec<(f64, f64)> = times.map(|time| (scale * (time / TIMES[0]).powf(exponent), time)).collect();
        GeneralizedKelvin::new(scale, 0.0, &terms).map(Material::incompressible)
    };
    let unit = scaled(1.0)?.contact_compliance(TIMES[1]);
    scaled(COMPLIANCE / unit)
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let cells = if args.quick { 64 } else { args.cells };
    let grid = Grid::square(cells, LENGTH)?;
    let shortest = 8.0 * LENGTH / cells as f64;
    let surface = Rough::new(&grid, RoughSpec::new(0.5 * LENGTH, shortest, Roughness::RmsSlope(0.05)))?;
    let kernel = InfluenceKernel::periodic(&grid)?;

    let began = Instant::now();
    let sweep = Sweep::new(grid.clone(), &surface).kernel(kernel.clone()).accuracy(1e-4);
    let states = sweep.run(Reach::Level(1.2 * FORCE * COMPLIANCE))?;
    let swept = began.elapsed();
    println!("{cells}² cells: {} elastic states in {:.2} s", states.states().len(), swept.as_secs_f64());

    let history = PiecewiseConstant { switch: TIMES[1] };
    let share = |area: f64| area / (LENGTH * LENGTH);
    let mut chart = Chart::new(
        "A hundred rheologies on one rough surface",
        "time [s]",
        "contact area / nominal area",
        Legend::UpperLeft,
    );
    chart.scale = Scale::LogX;
    let (began, mut steps) = (Instant::now(), 0);
    let exponents: Vec<f64> =
        (0..args.rheologies).map(|k| 0.05 + 0.55 * k as f64 / args.rheologies.max(2) as f64).collect();
    let mut curves = Vec::new();
    for &exponent in &exponents {
        let mut contact = StatesContact::new(&states, &body(exponent)?)?;
        // between long steps too, so that lines are smooth and begin and end where they should
        let drawn = (0..=200).map(|k| TIMES[0] * (TIMES[2] / TIMES[0]).powf(f64::from(k) / 200.0));
        let drawn = drawn.map(|time| time.min(TIMES[2])).collect::<Vec<_>>();
        let mut run = contact.follow(&history, Stepping::adaptive(1e-4), TIMES[2]).sample_at(drawn)?;
        let mut points = Vec::new();
        while run.next_step()?.is_some() {
            steps += 1;
            for sample in run.samples() {
                let sample = sample?;
                if sample.report().time >= TIMES[0] {
                    points.push((sample.report().time, share(sample.contact().contact_area())));
                }
            }
        }
        curves.push((exponent, points));
    }
    chart.add_family("exponent of the creep", Style::Line, curves);
    let run = began.elapsed();
    println!(
        "{} rheologies, {steps} steps: {:.3} s, {:.1} µs a step with its trials, 21 relaxation times",
        args.rheologies,
        run.as_secs_f64(),
        run.as_secs_f64() * 1e6 / f64::from(steps)
    );

    // one of them cell by cell
    let exponent = exponents[exponents.len() / 2];
    let builder = ViscoelasticContact::builder(grid).geometry(&surface).material(body(exponent)?).kernel(kernel);
    let mut contact = builder.build()?;
    let (began, mut steps) = (Instant::now(), 0);
    let mut follow = contact.follow(&history, Stepping::adaptive(1e-4), TIMES[2]);
    let mut points = Vec::new();
    while let Some(report) = follow.next_step()? {
        steps += 1;
        if report.time >= TIMES[0] {
            points.push((report.time, share(follow.contact().contact_area())));
        }
    }
    let points = points.into_iter().step_by(4).collect();
    println!("one of them in space: {steps} steps in {:.2} s", began.elapsed().as_secs_f64());
    chart.add(format!("exponent {exponent:.3}, stepped in space"), COLORS[1], Style::Dots, points);
    chart.save(args.output.join("areas.png"))?;
    println!("the picture is in {}", args.output.display());
    Ok(())
}

/// The whole force, then half of it.
#[derive(Debug)]
struct PiecewiseConstant {
    switch: f64,
}

impl LoadHistory for PiecewiseConstant {
    fn at(&self, time: f64) -> Load {
        Load::force(if time < self.switch { FORCE } else { 0.5 * FORCE })
    }

    fn before(&self, time: f64) -> Load {
        Load::force(if time <= self.switch { FORCE } else { 0.5 * FORCE })
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        (after < self.switch).then_some(self.switch)
    }
}
