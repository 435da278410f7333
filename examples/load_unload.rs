//! A sphere under a triangular load, up, down to nothing, and up again, on a Zener half-space: the
//! force–approach loop and the contact radius against the one-dimensional foundation (method of
//! dimensionality reduction).
//!
//! `cargo run --release -p viscocontact --features plot,states --example load_unload`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Style};
use viscocontact::prelude::*;

/// A sphere loaded, unloaded and loaded again on a Zener half-space.
#[derive(Parser)]
struct Args {
    /// Glassy shear modulus [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    modulus: f64,
    /// Shear modulus of the Kelvin-Voigt element [Pa].
    #[arg(long, default_value_t = 0.5e6)]
    kelvin_modulus: f64,
    /// Retardation time [s].
    #[arg(long, default_value_t = 1.0)]
    tau: f64,
    /// Poisson's ratio.
    #[arg(long, default_value_t = 0.3)]
    poisson: f64,
    /// Greatest force [N].
    #[arg(long, default_value_t = 1.0)]
    load: f64,
    /// Radius of the sphere [m].
    #[arg(long, default_value_t = 10.0e-3)]
    radius: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 256)]
    cells: usize,
    /// Steps a retardation time.
    #[arg(long, default_value_t = 25)]
    steps: usize,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/load_unload")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (64, 10);
    }
    support::finish(run(&args));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let body = Zener::with_time(args.modulus, args.kelvin_modulus, args.tau)?;
    let material = Material::constant_poisson(body, args.poisson)?;
    let corners = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.5, 0.0), (3.5, 1.0)];
    let history = PiecewiseLinear::new(&corners.map(|(time, load)| (time * args.tau, Load::force(load * args.load))))?;
    let until = 3.5 * args.tau;

    // the softest answer bounds the contact: relaxed compliance, greatest force
    let widest = (0.75 * args.radius * args.load * material.contact_compliance(1e3 * args.tau)).cbrt();
    let mut contact = ViscoelasticContact::builder(Grid::square(args.cells, 2.1 * widest)?)
        .geometry(&Sphere::new(args.radius)?)
        .material(material.clone())
        .build()?;
    let mut reference = StatesContact::new(&ElasticStates::sphere(args.radius)?, &material)?;

    let mut table = csv::Writer::from_path(args.output.join("history.csv"))?;
    table.write_record([
        "time_s",
        "force_n",
        "approach_m",
        "reference_approach_m",
        "contact_radius_m",
        "reference_contact_radius_m",
        "convolutions",
    ])?;
    let (mut loop_points, mut radii) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    let (mut worst, mut work, mut count) = ([0.0_f64; 2], 0.0, 0_u32);
    let step = args.tau / args.steps as f64;
    let progress = support::progress((until / step).round() as u64);
    let mut run = contact.follow(&history, Stepping::fixed(step), until);
    while let Some(report) = run.next_step()? {
        // the reference takes sixteen steps for each of ours
        let start = reference.time();
        for k in 1..=16 {
            let t = start + (report.time - start) * f64::from(k) / 16.0;
            reference.step(t - reference.time(), history.at(t))?;
        }
        let radius_of = |area: f64| (area / std::f64::consts::PI).sqrt();
        let radius = radius_of(run.contact().contact_area());
        let exact = [reference.approach(), radius_of(reference.contact_area())];
        table.serialize((
            report.time,
            report.force,
            report.approach,
            exact[0],
            radius,
            exact[1],
            report.convolution_equivalents(),
        ))?;
        if radius > 0.25 * widest {
            worst[0] = worst[0].max((report.approach / exact[0] - 1.0).abs());
            worst[1] = worst[1].max((radius / exact[1] - 1.0).abs());
        }
        loop_points[0].push((report.approach * 1e6, report.force));
        loop_points[1].push((exact[0] * 1e6, report.force));
        radii[0].push((report.time / args.tau, radius * 1e3));
        radii[1].push((report.time / args.tau, exact[1] * 1e3));
        work += report.convolution_equivalents();
        count += 1;
        progress.inc(1);
    }
    progress.finish_and_clear();
    table.flush()?;
    println!("{}² cells, {count} steps, {:.2} convolution equivalents a step", args.cells, work / f64::from(count));
    println!("maximum error of the approach {:.1e}, of the contact radius {:.1e}", worst[0], worst[1]);

    let [computed, exact] = loop_points;
    let mut chart =
        Chart::new("Force over approach: load, unload, wait, load", "approach [µm]", "force [N]", Legend::UpperLeft);
    chart.add("one-dimensional foundation", COLORS[0], Style::Line, exact);
    chart.add("computed", COLORS[1], Style::Dots, computed.into_iter().step_by(2).collect());
    chart.save(args.output.join("loop.png"))?;
    let [computed, exact] = radii;
    let mut chart = Chart::new("Contact radius", "t / τ", "contact radius [mm]", Legend::LowerLeft);
    chart.add("one-dimensional foundation", COLORS[0], Style::Line, exact);
    chart.add("computed", COLORS[1], Style::Dots, computed.into_iter().step_by(2).collect());
    chart.save(args.output.join("contact_radius.png"))?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}
