//! A nanoindentation of a glassy polymer: a sphere on a machine of finite stiffness is driven in, held, and drawn back. Three
//! usual formulas read the curve, one of them with three corrections for the ramp, and a fit of the whole curve. The error of each
//! is known, since the curve is computed.
//!
//! `cargo run --release -p viscocontact-identify --features plot --example nanoindentation_hold`

mod support;

use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Style};
use viscocontact::prelude::*;
use viscocontact_identify::usual::{RampCorrection, hold_relaxation, loading_modulus, oliver_pharr};
use viscocontact_identify::{Curve, Experiment, Identification, Model, Nuisance, Protocol};

/// A hold of a nanoindenter, read by usual formulas and by a fit.
#[derive(Parser)]
struct Args {
    /// Radius of the sphere [m].
    #[arg(long, default_value_t = 10.0e-6)]
    radius: f64,
    /// Stiffness of the machine [N/m].
    #[arg(long, default_value_t = 2.0e6)]
    stiffness: f64,
    /// Time of the ramp up, and of the ramp down [s].
    #[arg(long, default_value_t = 5.0)]
    ramp: f64,
    /// Time of the hold [s].
    #[arg(long, default_value_t = 40.0)]
    hold: f64,
    /// Standard deviation of the noise over the greatest force.
    #[arg(long, default_value_t = 0.005)]
    noise: f64,
    /// Seed of the noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Fewer points.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/nanoindentation_hold")]
    output: PathBuf,
}

/// Contact moduli [Pa] and relaxation time [s] of the polymer.
const GLASSY: f64 = 5.0e9;
const EQUILIBRIUM: f64 = 2.5e9;
const TIME: f64 = 4.0;
/// Position of the base at the end of the ramp [m].
const DRIVE: f64 = 400.0e-9;

fn main() {
    support::finish(run(&Args::parse()));
}

/// What a formula reads: glassy and equilibrium modulus [Pa] and relaxation time [s], NaN where it reads none.
struct Reading {
    name: &'static str,
    values: [f64; 3],
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let tip = ElasticStates::sphere(args.radius)?;
    let interval = if args.quick { 0.1 } else { 0.02 };
    let protocol = Protocol::trapezoid(DRIVE, [args.ramp, args.hold, args.ramp], interval)?;
    let experiment = Experiment::new(protocol, tip).with_spring(args.stiffness)?;
    // an incompressible body of shear modulus G has the contact modulus 4 G
    let polymer = Material::incompressible(Zener::relaxing(0.25 * GLASSY, 0.25 * EQUILIBRIUM, TIME)?);
    let mut force = support::simulated(&experiment, &polymer, 2)?;
    let greatest = force.iter().copied().fold(0.0, f64::max);
    let noise = support::noise(force.len(), args.noise * greatest, 0.0, args.seed);
    force.iter_mut().zip(noise).for_each(|(force, noise)| *force += noise);
    let curve = Curve::new(experiment, force)?;
    curve.check()?;

    let none = f64::NAN;
    let loading = loading_modulus(&curve, Some(0.0))?.modulus;
    let unloading = oliver_pharr(&curve, 0.0, |depth| 2.0 * PI * args.radius * depth)?.modulus;
    let mut readings = vec![
        Reading { name: "Hertz, loading", values: [loading, none, none] },
        Reading { name: "Oliver & Pharr", values: [unloading, none, none] },
    ];
    for (name, correction) in [
        ("hold as a step", RampCorrection::Step),
        ("hold, half of the ramp", RampCorrection::HalfRamp),
        ("hold, ramp factor", RampCorrection::Factor),
    ] {
        let read = hold_relaxation(&curve, 0.0, correction)?;
        readings.push(Reading { name, values: [read.glassy, read.equilibrium, read.time] });
    }
    let fit = Identification::new(Model::Zener).contact_point(Nuisance::Fitted).fit(&[curve])?;
    let estimate = |name: &str| fit.estimate(name).ok_or("a parameter of the model");
    let found = [estimate("E0")?, estimate("Einf")?, estimate("tau")?];
    readings.push(Reading { name: "fit of the whole curve", values: found.map(|estimate| estimate.value) });

    let exact = [GLASSY, EQUILIBRIUM, TIME];
    println!("{:<24} {:>9} {:>9} {:>9}   errors in %", "", "E0", "Einf", "tau");
    let mut table = csv::Writer::from_path(args.output.join("errors.csv"))?;
    table.write_record([
        "formula",
        "E0 [Pa]",
        "Einf [Pa]",
        "tau [s]",
        "error of E0",
        "error of Einf",
        "error of tau",
    ])?;
    for Reading { name, values } in &readings {
        let errors = [0, 1, 2].map(|k| values[k] / exact[k] - 1.0);
        let shown = errors.map(|error| if error.is_nan() { "-".to_owned() } else { format!("{:+.1}", 100.0 * error) });
        println!("{name:<24} {:>9} {:>9} {:>9}", shown[0], shown[1], shown[2]);
        table.serialize((name, values, errors))?;
    }
    table.flush()?;
    let deviations = found.map(|estimate| format!("{:.1}", 100.0 * estimate.deviation));
    println!("{:<24} {:>9} {:>9} {:>9}", "  its standard deviation", deviations[0], deviations[1], deviations[2]);
    for warning in fit.warnings() {
        println!("warning: {warning}");
    }
    fit.picture(0)?.save(args.output.join("fit.png"))?;

    let [time, modulus] = [Quantity::new("time", "s"), Quantity::new("contact modulus E*", "Pa")];
    let mut chart = Chart::new("What each formula reads", time, modulus, Legend::UpperRight);
    let times: Vec<f64> = (0..=200).map(|k| 0.1 * f64::from(k)).collect();
    let line = |[glassy, equilibrium, relaxation]: [f64; 3]| -> Vec<(f64, f64)> {
        let at = |time: f64| equilibrium + (glassy - equilibrium) * (-time / relaxation).exp();
        times.iter().map(|&time| (time, if relaxation.is_nan() { glassy } else { at(time) })).collect()
    };
    for (Reading { name, values }, color) in readings.iter().zip(COLORS) {
        chart.add(*name, color, Style::Line, line(*values));
    }
    let truth = line(exact).into_iter().step_by(8).collect();
    chart.add("polymer", COLORS[6], Style::Dots, truth);
    chart.save(args.output.join("moduli.png"))?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}
