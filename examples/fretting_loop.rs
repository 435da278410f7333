//! Fretting: a ball pressed on rubber is moved to and fro along the surface, at several frequencies: loops of force over
//! displacement, and what a cycle dissipates by slip in the contact and by creep in the rubber.
//!
//! The contact sticks in its middle and slips in a ring. The rubber is softer to slow motions, so that less of the
//! contact slips; it creeps most where it relaxes in about a cycle. On elastic states a cycle takes milliseconds.
//!
//! `cargo run --release -p viscocontact --features plot,states --example fretting_loop`

mod support;

use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Scale, Style, measure};
use viscocontact::prelude::*;
use viscocontact::states::LateralWork;

/// A ball on rubber, sheared to and fro.
#[derive(Parser)]
struct Args {
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 10.0e-3, value_parser = support::positive)]
    radius: f64,
    /// Force that presses it [N].
    #[arg(long, default_value_t = 1.0, value_parser = support::positive)]
    force: f64,
    /// Coefficient of friction.
    #[arg(long, default_value_t = 0.6, value_parser = support::positive)]
    friction: f64,
    /// Amplitude of the motion along the surface [m].
    #[arg(long, default_value_t = 60.0e-6, value_parser = support::positive)]
    amplitude: f64,
    /// Shear modulus of the relaxed rubber [Pa]; at once it is four times as stiff.
    #[arg(long, default_value_t = 0.5e6, value_parser = support::positive)]
    modulus: f64,
    /// Tolerance of the steps.
    #[arg(long, default_value_t = 1.0e-3, value_parser = support::positive)]
    tolerance: f64,
    /// Fewer frequencies.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/fretting_loop")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

/// Displacement and force of the third cycle, what it takes, and the share of the contact that sticks at its end.
struct Cycle {
    path: Vec<(f64, f64)>,
    work: LateralWork,
    stick: f64,
    steps: u64,
}

fn cycle(args: &Args, rubber: &Material, frequency: f64) -> viscocontact::Result<Cycle> {
    let amplitude = args.amplitude;
    let motion = FnHistory::new(move |t| Load::approach(amplitude * (TAU * frequency * t).sin()));
    let mut contact = StatesContact::new(&ElasticStates::sphere(args.radius)?, rubber)?
        .with_estimated_friction(args.friction)?
        .sheared_by(motion)?;
    // pressed for long before
    contact.step_sheared(0.0, Load::force(args.force), Load::force(0.0))?;
    contact.step_sheared(100.0, Load::force(args.force), Load::force(0.0))?;
    let (start, period) = (contact.time(), 1.0 / frequency);
    let mut moved = contact.clone();
    let held = StepLoad::new(Load::force(args.force))?;
    let (first, end) = ((start / period).ceil() * period, 3.0 * period);
    let end = first + end;
    let mut run = moved.follow(&held, Stepping::adaptive(args.tolerance), end);
    run = run.sample_at((0..=240).map(|k| end - period * (1.0 - f64::from(k) / 240.0)).collect::<Vec<_>>())?;
    let (mut path, mut before) = (Vec::new(), LateralWork::default());
    while run.next_step()?.is_some() {
        for sample in run.samples() {
            let sample = sample?;
            if sample.is_asked_for() {
                if path.is_empty() {
                    before = sample.contact().lateral_work();
                }
                path.push((sample.contact().lateral_displacement(), sample.contact().lateral_force()));
            }
        }
    }
    let steps = run.progress().steps;
    let mut work = moved.lateral_work();
    work.slip -= before.slip;
    work.creep -= before.creep;
    work.work -= before.work;
    Ok(Cycle { path, work, stick: moved.stick_area() / moved.contact_area(), steps })
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let tau = 1.0;
    let rubber = Material::incompressible(GeneralizedMaxwell::new(args.modulus, &[(3.0 * args.modulus, tau)])?);
    let parts = if args.quick { 1 } else { 4 };
    let frequencies = (-3 * parts..=2 * parts).map(|k| 10f64.powf(f64::from(k) / f64::from(parts)));
    let mut loops = Chart::new(
        "A ball on rubber, moved to and fro at four frequencies",
        Quantity::new("displacement", "m"),
        Quantity::new("tangential force", "N"),
        Legend::UpperLeft,
    );
    let mut table = csv::Writer::from_path(args.output.join("cycles.csv"))?;
    table.write_record(["frequency [Hz]", "work [J]", "by slip [J]", "by creep [J]", "stick area share", "steps"])?;
    let (mut slips, mut creeps, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    println!("{:>12} {:>12} {:>12} {:>12} {:>7} {:>6}", "frequency", "work [µJ]", "slip", "creep", "sticks", "steps");
    for frequency in frequencies {
        let Cycle { path, work, stick, steps } = cycle(args, &rubber, frequency)?;
        println!(
            "{frequency:9.4} Hz {:12.4} {:12.4} {:12.4} {stick:7.3} {steps:6}",
            1e6 * work.work,
            1e6 * work.slip,
            1e6 * work.creep
        );
        table.serialize((frequency, work.work, work.slip, work.creep, stick, steps))?;
        slips.push((frequency, work.slip));
        creeps.push((frequency, work.creep));
        let decade = frequency.log10();
        if [-3.0, -1.0, 0.0, 2.0].iter().any(|chosen| (decade - chosen).abs() < 1e-9) {
            curves.push((frequency, path));
        }
    }
    table.flush()?;
    for ((frequency, path), color) in curves.into_iter().zip(COLORS) {
        loops.add(measure(frequency, "Hz"), color, Style::Line, path);
    }
    loops.save(args.output.join("loops.png"))?;
    let mut losses = Chart::new(
        "Energy dissipated in a cycle",
        Quantity::new("frequency", "Hz"),
        Quantity::new("energy", "J"),
        Legend::UpperRight,
    );
    losses.scale = Scale::LogX;
    losses.add("slip in the contact", COLORS[0], Style::LineAndDots, slips);
    losses.add("creep of the rubber", COLORS[1], Style::LineAndDots, creeps);
    losses.save(args.output.join("losses.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
