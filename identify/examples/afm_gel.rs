//! A force curve of an atomic force microscope: a pyramid on a soft cantilever is pressed into a gel layer on glass, held, and
//! retracted. The curve is noisy, its contact point and force offset are unknown. Four models of the material are fitted and ranked.
//!
//! The gel is a fractional solid. Its curve is computed by fine steps on elastic states of the pyramid on the layer; a fit of
//! each model then uses the same states.
//!
//! `cargo run --release -p viscocontact-identify --features plot,serde --example afm_gel`

mod support;

use std::error::Error;
use std::fs::{self, File};
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Scale, Style};
use viscocontact::prelude::*;
use viscocontact_identify::{
    Curve, Experiment, Identification, Model, Noise, Nuisance, Protocol, Recording, Summary, ranked,
};

/// A pyramid on a gel layer.
#[derive(Parser)]
struct Args {
    /// Thickness of the gel [m].
    #[arg(long, default_value_t = 3.0e-6)]
    thickness: f64,
    /// Stiffness of the cantilever [N/m].
    #[arg(long, default_value_t = 0.06)]
    stiffness: f64,
    /// Standard deviation of the noise of the force [N].
    #[arg(long, default_value_t = 20.0e-12)]
    noise: f64,
    /// Cells along each side of the grid of the sweep.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Seed of the noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Also compute the best fit by the stepper in space: minutes.
    #[arg(long)]
    verify: bool,
    /// Fewer cells and points: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/afm_gel")]
    output: PathBuf,
}

/// Half of the angle between opposite faces of the pyramid.
const HALF_ANGLE: f64 = 35.0_f64.to_radians();
/// Position of the base above the surface and at the end of the ramp [m].
const RAMP: [f64; 2] = [0.5e-6, 1.5e-6];
/// The travel of the base, which no depth exceeds wherever the contact point is.
const DEEPEST: f64 = RAMP[0] + RAMP[1];
/// Speed of the base [m/s], and time of the hold [s].
const SPEED: f64 = 5.0e-6;
const HOLD: f64 = 4.0;
/// Contact moduli [Pa], time [s] and exponent of the gel.
const GLASSY: f64 = 6.0e3;
const EQUILIBRIUM: f64 = 1.0e3;
const TIME: f64 = 0.3;
const EXPONENT: f64 = 0.6;
/// Error of the instrument: position of the surface [m], and force without contact [N].
const SURFACE: f64 = 0.12e-6;
const OFFSET: f64 = 0.1e-9;

fn main() {
    let mut args = Args::parse();
    if args.quick {
        args.cells = 48;
    }
    support::finish(run(&args));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let (grid, shape, kernel) = scene(args)?;
    let sweep = Sweep::new(grid.clone(), &shape).kernel(kernel.clone()).accuracy(1.0e-3);
    let tip = sweep.run(Reach::Approach(DEEPEST))?;
    println!("{} elastic states of the pyramid on the layer", tip.states().len());

    // the experiment, and a file as an instrument writes it
    let interval = if args.quick { 0.01 } else { 0.005 };
    let protocol = Protocol::ramp_hold_retract(SPEED, RAMP, HOLD, interval)?;
    let experiment = Experiment::new(protocol.clone(), tip.clone()).with_spring(args.stiffness)?;
    // an incompressible body of shear modulus G has the contact modulus 4 G
    let gel = Material::incompressible(FractionalZener::relaxing(0.25 * GLASSY, 0.25 * EQUILIBRIUM, TIME, EXPONENT)?)
        .fitted(1.0e-4..=1.0e3, 1.0e-6)?;
    let force = support::simulated(&experiment, &gel, 4)?;
    let noise = support::noise(force.len(), args.noise, 0.5, args.seed);
    let file = args.output.join("curve.csv");
    let mut table = csv::Writer::from_path(&file)?;
    table.write_record(["Time [s]", "z [nm]", "Force [nN]"])?;
    for (k, (&time, &drive)) in protocol.times().iter().zip(protocol.drive()).enumerate() {
        table.serialize((time, 1e9 * (drive + SURFACE), 1e9 * (force[k] + noise[k] + OFFSET)))?;
    }
    table.flush()?;

    // from here on, only the file, the tip and the cantilever are known
    let curve: Curve = Recording::from_csv(&file, Default::default())?.spring_curve(&tip, args.stiffness)?;
    let candidates = [Model::Elastic, Model::Zener, Model::PowerLaw { cutoff: 1.0e-4 }, Model::FractionalZener];
    let bar = support::progress(candidates.len() as u64);
    let mut fits = Vec::new();
    for model in candidates {
        let identification = Identification::new(model)
            .contact_point(Nuisance::Fitted)
            .offset(Nuisance::Fitted)
            .noise(Noise::Autoregressive);
        fits.push(identification.fit(std::slice::from_ref(&curve)));
        bar.inc(1);
    }
    bar.finish_and_clear();

    let ranked = ranked(fits)?;
    println!("{:<18} {:>9} {:>7} {:>8}", "model", "ΔAICc", "weight", "p(white)");
    for (fit, difference, weight) in &ranked {
        let (name, p) = (fit.model(), fit.probability());
        println!("{name:<18} {difference:>9.1} {weight:>7.3} {p:>8.1e}");
        fit.warnings().iter().for_each(|warning| println!("  {warning}"));
    }
    let best = &ranked[0].0;
    let truth = [
        ("E0", GLASSY),
        ("Einf", EQUILIBRIUM),
        ("tau", TIME),
        ("alpha", EXPONENT),
        ("contact point", SURFACE),
        ("offset", OFFSET),
    ];
    println!("best model: {}", best.model());
    for estimate in best.estimates() {
        let exact = truth.iter().find(|(name, _)| *name == estimate.name).map_or(f64::NAN, |(_, value)| *value);
        let [low, high] = estimate.interval;
        println!("  {:<13} {:>10.3e}, 95 %: {low:.3e} to {high:.3e}; true {exact:.3e}", estimate.name, estimate.value);
    }
    if args.verify {
        let scene = ViscoelasticContact::builder(grid).geometry(&shape).kernel(kernel);
        let difference = best.verify(0, &scene)?.difference;
        println!("the stepper in space differs by {:.2} % of the maximum force", 100.0 * difference);
    }
    let summaries: Vec<Summary> = ranked.iter().map(|(fit, ..)| fit.summary()).collect();
    Summary::write_csv(&summaries, File::create(args.output.join("results.csv"))?)?;
    Summary::write_json(&summaries, File::create(args.output.join("results.json"))?)?;
    best.picture(0)?.save(args.output.join("best.png"))?;
    ranked[ranked.len() - 1].0.picture(0)?.save(args.output.join("worst.png"))?;

    let mut chart =
        Chart::new("Contact modulus of four models", "time [s]", Quantity::new("E*", "Pa"), Legend::LowerLeft);
    chart.scale = Scale::LogX;
    let times: Vec<f64> = (0..=100).map(|k| 1.0e-3 * 1.0e4_f64.powf(f64::from(k) / 100.0)).collect();
    for ((fit, ..), color) in ranked.iter().zip(COLORS) {
        let line = times.iter().map(|&time| (time, fit.modulus(time))).collect();
        chart.add(fit.model().to_string(), color, Style::Line, line);
    }
    let exact = gel.contact_spectrum()?.ok_or("no exact modulus")?.relaxation();
    let truth = times.iter().step_by(5).map(|&time| (time, exact.modulus(time))).collect();
    chart.add("gel", COLORS[ranked.len()], Style::Dots, truth);
    chart.save(args.output.join("moduli.png"))?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// The grid, the pyramid and the bonded gel. The contact of a square pyramid is narrower than its cross section.
fn scene(args: &Args) -> Result<(Grid, impl Geometry, InfluenceKernel), Box<dyn Error>> {
    let grid = Grid::square(args.cells, 2.0 * DEEPEST * HALF_ANGLE.tan())?;
    let shape = FnGeometry::new(|x1: f64, x2: f64| x1.abs().max(x2.abs()) / HALF_ANGLE.tan());
    let kernel = InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(args.thickness, 0.5)?)?;
    Ok((grid, shape, kernel))
}
