//! From a measured creep test to a contact: a CSV table with 2 % noise is fitted, and a sphere is pressed onto the
//! material that it gives. The table was made from a known material, so that the error of the whole way can be
//! told.
//!
//! `cargo run --release -p viscocontact --features data,plot --example measured_creep`

#[path = "support/scenes/noise.rs"]
mod noise;
mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use noise::noise;
use viscocontact::Result;
use viscocontact::TextFormat;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSeries, Experiment, Units};

/// A sphere on a material known by a table of its creep.
#[derive(Parser)]
struct Args {
    /// Table of time [s] and creep compliance [1/Pa].
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/creep.csv"))]
    table: PathBuf,
    /// Make the table anew, from the known material with this seed of the noise.
    #[arg(long)]
    seed: Option<u64>,
    /// Force [N].
    #[arg(long, default_value_t = 1.0)]
    load: f64,
    /// Radius of the sphere [m].
    #[arg(long, default_value_t = 10.0e-3)]
    radius: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 256)]
    cells: usize,
    /// Steps a decade of time.
    #[arg(long, default_value_t = 20)]
    steps: u32,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/measured_creep")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (64, 5);
    }
    support::finish(run(&args));
}

/// The body that the table was made from: glassy 1 GPa, relaxed 1 MPa.
fn truth() -> Result<FractionalZener> {
    FractionalZener::new(1.0e9, 1.0e6, 10.0, 0.45)
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    if let Some(seed) = args.seed {
        measure(args, seed)?;
    }
    // the material as its user gets it
    let body = Measurements::from_csv(Experiment::Creep, &args.table, Units::SI, TextFormat::default())?.fit()?;
    println!("{}", body.report());
    for (compliance, time) in body.spectrum().terms() {
        println!("  retardation time {time:9.2e} s, compliance {compliance:9.2e} 1/Pa");
    }
    plot_fit(args, &body)?;

    // the contact: from the first time of the data to the last
    let truth = truth()?;
    let [first, last] = body.report().range().ok_or("the table is empty")?;
    let exact = |t: f64| (3.0 / 16.0 * args.radius * args.load * truth.creep_compliance(t)).cbrt();
    let widest = (3.0 / 16.0 * args.radius * args.load * body.creep_compliance(last)).cbrt();
    let mut contact = ViscoelasticContact::builder(Grid::square(args.cells, 2.3 * widest)?)
        .geometry(&Sphere::new(args.radius)?)
        .material(Material::incompressible(body))
        .build()?;
    contact.step(0.0, Load::force(args.load))?;
    let count = ((last / first).log10() * f64::from(args.steps)).round() as u32;
    let mut table = csv::Writer::from_path(args.output.join("history.csv"))?;
    table.write_record(["time_s", "approach_m", "contact_radius_m", "exact_contact_radius_m", "convolutions"])?;
    let (mut computed, mut curve, mut worst, mut squares) = (Vec::new(), Vec::new(), 0.0_f64, 0.0);
    let progress = support::progress(u64::from(count));
    for k in 0..=count {
        let time = if k == count { last } else { first * (last / first).powf(f64::from(k) / f64::from(count)) };
        let report = contact.step(time - contact.time(), Load::force(args.load))?;
        // the approach gives the radius to a fraction of a cell: ω = a²/R
        let radius = (report.approach * args.radius).sqrt();
        table.serialize((time, report.approach, radius, exact(time), report.convolution_equivalents()))?;
        let error = radius / exact(time) - 1.0;
        worst = worst.max(error.abs());
        squares += error * error;
        computed.push((time, radius * 1e3));
        curve.push((time, exact(time) * 1e3));
        progress.inc(1);
    }
    progress.finish_and_clear();
    table.flush()?;
    let rms = (squares / f64::from(count + 1)).sqrt();
    println!("contact radius against the exact material: {:.2} % rms, {:.2} % at most", 100.0 * rms, 100.0 * worst);

    let title = "Contact radius under a step load";
    let mut chart = Chart::new(title, "time [s]", "contact radius [mm]", Legend::UpperLeft);
    chart.scale = Scale::LogX;
    chart.add("the material behind the data, exactly", COLORS[0], Style::Line, curve);
    chart.add("computed from the table", COLORS[1], Style::Dots, computed.into_iter().step_by(4).collect());
    chart.save(args.output.join("contact_radius.png"))?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// Writes the table: ten decades of time, twelve values a decade, 2 % noise.
fn measure(args: &Args, seed: u64) -> Result<(), Box<dyn Error>> {
    let truth = truth()?;
    let mut text = String::from(
        "# Creep of a fractional Zener body (G = 1 GPa, G_K = 1 MPa, 10 s, order 0.45) with 2 % noise,\n\
         # made by: cargo run --release -p viscocontact --features data,plot --example measured_creep -- --seed 1\n\
         time [s],creep compliance [1/Pa]\n",
    );
    let mut noise = noise(seed);
    for k in 0..=120 {
        let time = 10f64.powf(-6.0 + f64::from(k) / 12.0);
        text += &format!("{time:.6e},{:.4e}\n", truth.creep_compliance(time) * (1.0 + 0.02 * noise()));
    }
    fs::write(&args.table, text)?;
    println!("{} is new", args.table.display());
    Ok(())
}

fn plot_fit(args: &Args, body: &CreepSeries) -> Result<(), Box<dyn Error>> {
    let truth = truth()?;
    let samples = body.report().samples();
    let mut chart = Chart::new("Creep compliance", "time [s]", "J [1/Pa]", Legend::UpperLeft);
    chart.scale = Scale::LogLog;
    chart.add("data, 2 % noise", COLORS[5], Style::Dots, samples.iter().map(|s| (s.x, s.given)).collect());
    let fit = format!("fit, {} retardation times", body.report().terms());
    chart.add(fit, COLORS[1], Style::Line, samples.iter().map(|s| (s.x, s.fitted)).collect());
    chart.save(args.output.join("creep.png"))?;

    let mut chart = Chart::new("Relative misfit", "time [s]", "misfit [%]", Legend::UpperRight);
    chart.scale = Scale::LogX;
    let percent = |of: f64, to: f64| 100.0 * (of / to - 1.0);
    chart.add(
        "data / fit",
        COLORS[5],
        Style::Dots,
        samples.iter().map(|s| (s.x, percent(s.given, s.fitted))).collect(),
    );
    let error = samples.iter().map(|s| (s.x, percent(truth.creep_compliance(s.x), s.fitted))).collect();
    chart.add("the material behind the data / fit", COLORS[0], Style::Line, error);
    chart.save(args.output.join("misfit.png"))?;
    Ok(())
}
