//! A column of rough grains settles: one sweep of elastic states is the contact law of every pair, at 1 kHz.
//!
//! Rigid-body engines and codes for grains want a law: force of approach and history, in microseconds. Here two rough
//! rubber balls are pressed onto each other once (`Sweep`), and each contact of the column is a `StatesContact` on the
//! states of that sweep. Positions give the approaches, the contacts step there, and their forces act in the next step:
//! a leapfrog, of second order. At rest each contact carries the weight above it, which is checked. The measured time of
//! a step is printed.
//!
//! `cargo run --release -p viscocontact-coupling --bin grains`

#[path = "../support/mod.rs"]
mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use viscocontact::geometry::Sum;
use viscocontact::output::{CsvHistory, Earlier, Metadata};
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Style};
use viscocontact::prelude::*;

/// A column of rough grains settles.
#[derive(Parser)]
struct Args {
    /// Number of grains.
    #[arg(long, default_value_t = 20)]
    grains: usize,
    /// Radius of a grain [m].
    #[arg(long, default_value_t = 10.0e-3)]
    radius: f64,
    /// Mass of a grain [kg].
    #[arg(long, default_value_t = 0.02)]
    mass: f64,
    /// Root mean square height of the roughness of a contact [m].
    #[arg(long, default_value_t = 2.0e-6)]
    roughness: f64,
    /// Glassy shear modulus of the grains [Pa]; they relax to a third of it.
    #[arg(long, default_value_t = 1.0e6)]
    modulus: f64,
    /// Their relaxation time [s].
    #[arg(long, default_value_t = 0.02)]
    tau: f64,
    /// Time step [s].
    #[arg(long, default_value_t = 1.0e-3)]
    dt: f64,
    /// Steps.
    #[arg(long, default_value_t = 3000)]
    steps: usize,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Coarse and fast: 48 cells.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/grains")]
    output: PathBuf,
}

const GRAVITY: f64 = 9.81;

fn main() {
    let mut args = Args::parse();
    if args.quick {
        args.cells = 48;
    }
    support::finish(run(&args));
}

/// The law of a contact of two equal grains; the lowest one lies on a grain that is held.
fn law(args: &Args, greatest: f64) -> Result<StatesContact, Box<dyn Error>> {
    // two equal incompressible bodies yield twice as much as one
    let material = Material::incompressible(Zener::relaxing(0.5 * args.modulus, args.modulus / 6.0, args.tau)?);
    let compliance = material.contact_compliance(1e3 * args.tau);
    // two spheres of radius R touch as one of R/2
    let ball = 0.5 * args.radius;
    let widest = (0.75 * ball * greatest * compliance).cbrt();
    let grid = Grid::square(args.cells, 2.4 * widest)?;
    let waves = RoughSpec::new(0.5 * widest, 6.0 * grid.spacing()[0], Roughness::RmsHeight(args.roughness));
    let shape = Sum::new(Sphere::new(ball)?, Rough::new(&grid, waves)?);
    let start = Instant::now();
    let states = Sweep::new(grid, &shape).accuracy(1e-3).run(Reach::Level(greatest * compliance))?;
    println!("{} elastic states swept in {:.2} s", states.states().len(), start.elapsed().as_secs_f64());
    Ok(StatesContact::new(&states, &material)?)
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let weight = args.mass * GRAVITY;
    let law = law(args, 3.0 * weight * args.grains as f64)?;
    // contact k lies below grain k, counted from the floor; the grains touch, without load
    let mut contacts = vec![law; args.grains];
    let touch = contacts[0].approach();
    let (mut positions, mut velocities) = (vec![0.0; args.grains], vec![0.0; args.grains]);
    let mut forces = vec![0.0; args.grains + 1];
    let (mut spent, mut longest) = (0.0, 0.0_f64);
    let mut table = CsvHistory::create(
        args.output.join("lowest.csv"),
        &Metadata::new("The lowest contact of a column of grains"),
        &contacts[0],
        &[],
        Earlier::Replace,
    )?;
    let mut curves = vec![Vec::new(); args.grains];
    let progress = support::progress(args.steps as u64);
    for step in 1..=args.steps {
        for k in 0..args.grains {
            velocities[k] += args.dt * ((forces[k] - forces[k + 1]) / args.mass - GRAVITY);
        }
        positions.iter_mut().zip(&velocities).for_each(|(position, velocity)| *position += args.dt * velocity);
        let start = Instant::now();
        let mut lowest = None;
        for (k, contact) in contacts.iter_mut().enumerate() {
            let below = if k == 0 { 0.0 } else { positions[k - 1] };
            let report = contact.step(args.dt, Load::approach(touch + below - positions[k]))?;
            forces[k] = report.force;
            lowest.get_or_insert(report);
        }
        let took = start.elapsed().as_secs_f64();
        (spent, longest) = (spent + took, longest.max(took));
        if let Some(report) = lowest.filter(|_| step % 10 == 0) {
            table.record(&contacts[0], &report, &[])?;
        }
        for (curve, force) in curves.iter_mut().zip(&forces) {
            curve.push((step as f64 * args.dt, *force));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let each = spent / (args.steps * args.grains) as f64;
    println!(
        "{} contacts, {} steps of {} ms: {:.2} µs per contact and step, {:.2} ms the longest step of the column",
        args.grains,
        args.steps,
        args.dt * 1e3,
        each * 1e6,
        longest * 1e3
    );
    println!("groups of levels in the lowest contact at the end: {}", contacts[0].groups());

    let mut chart = Chart::new(
        "A column of rough grains settles",
        Quantity::new("time", "s"),
        Quantity::new("force of a contact", "N"),
        Legend::UpperRight,
    );
    for (color, k) in COLORS.into_iter().zip([0, args.grains / 2, args.grains - 1]) {
        let settling = curves[k].iter().copied().take_while(|(time, _)| *time <= 0.6).collect();
        chart.add(format!("below grain {}", k + 1), color, Style::Line, settling);
    }
    chart.save(args.output.join("force.png"))?;
    let error = (0..args.grains).map(|k| (forces[k] / (weight * (args.grains - k) as f64) - 1.0).abs());
    let worst = error.fold(0.0, f64::max);
    println!("at rest each contact carries the weight above it within {worst:.1e}");
    println!("tables and pictures are in {}", args.output.display());
    if worst > 1e-2 {
        return Err(format!("forces at rest err by {worst:.1e}: take more steps").into());
    }
    Ok(())
}
