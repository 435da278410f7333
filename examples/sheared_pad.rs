//! A rough surface is pressed on rubber and then moved along it at several speeds, while the rubber creeps: the area that sticks over
//! the displacement, the force along the surface, and the tractions.
//!
//! Each patch of contact slips from its edge inwards until the whole pad slides. Slower pads have more time to creep: they stand on a
//! greater contact on softer rubber, so that the force over the displacement is nearly the same.
//!
//! `cargo run --release -p viscocontact --features plot,states,surfaces --example sheared_pad`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::geometry::{Rough, RoughSpec, Roughness};
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Style};
use viscocontact::prelude::*;

/// A rough pad that is pressed and sheared.
#[derive(Parser)]
struct Args {
    /// Side of the pad, which repeats [m].
    #[arg(long, default_value_t = 1.0e-3, value_parser = support::positive)]
    length: f64,
    /// Rms slope of the surface.
    #[arg(long, default_value_t = 0.05, value_parser = support::positive)]
    slope: f64,
    /// Mean pressure [Pa].
    #[arg(long, default_value_t = 20.0e3, value_parser = support::positive)]
    pressure: f64,
    /// Coefficient of friction.
    #[arg(long, default_value_t = 0.8, value_parser = support::positive)]
    friction: f64,
    /// How far the pad is moved [m].
    #[arg(long, default_value_t = 6.0e-6, value_parser = support::positive)]
    distance: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 128, value_parser = support::at_least_one)]
    cells: usize,
    /// A small grid, for a look.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/sheared_pad")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let cells = if args.quick { 64 } else { args.cells };
    let grid = Grid::square(cells, args.length)?;
    let spec = RoughSpec::new(0.5 * args.length, 8.0 * args.length / cells as f64, Roughness::RmsSlope(args.slope))
        .with_hurst(0.8)
        .with_seed(3);
    let surface = Rough::new(&grid, spec)?;
    let rubber =
        Material::incompressible(GeneralizedMaxwell::new(0.3e6, &[(0.3e6, 1.0e-2), (0.3e6, 1.0), (0.3e6, 1.0e2)])?);
    let nominal = args.length * args.length;
    let load = Load::force(args.pressure * nominal);
    let durations: [f64; 3] = [1.0e-2, 1.0, 1.0e2];
    let states = Sweep::new(grid.clone(), &surface)
        .kernel(InfluenceKernel::periodic(&grid)?)
        .keep_pressures()
        .run(Reach::Level(1.05 * args.pressure * nominal * rubber.contact_compliance(durations[2])))?;
    let quantity = Quantity::new("displacement", "m");
    let mut areas = Chart::new(
        "Contact area (dots) and stick area (lines) of a sheared pad",
        quantity.clone(),
        "area / nominal area",
        Legend::UpperRight,
    );
    let mut forces = Chart::new("Tangential force", quantity, "force / f P", Legend::LowerRight);
    let mut table = csv::Writer::from_path(args.output.join("areas.csv"))?;
    table.write_record(["duration [s]", "displacement [m]", "in contact", "sticks", "force over f P"])?;
    let (held, limit) = (StepLoad::new(load)?, args.friction * args.pressure * nominal);
    for (n, until) in durations.into_iter().enumerate() {
        let moved = Ramp::new(Load::approach(0.0), Load::approach(args.distance), until)?;
        let mut contact =
            StatesContact::new(&states, &rubber)?.with_estimated_friction(args.friction)?.sheared_by(moved)?;
        // first pressed, then sheared
        contact.step_sheared(0.0, load, Load::force(0.0))?;
        let (mut area, mut stick, mut force, mut half) = (Vec::new(), Vec::new(), Vec::new(), None);
        let mut slides = f64::NAN;
        let mut run =
            contact.follow(&held, Stepping::adaptive(1.0e-3), until).sample_at(Times::every(until / 100.0))?;
        while run.next_step()?.is_some() {
            for sample in run.samples() {
                let sample = sample?;
                if !sample.is_asked_for() {
                    continue;
                }
                let contact = sample.contact();
                let [at, carried] = [contact.lateral_displacement(), contact.lateral_force() / limit];
                let shares = [contact.contact_area(), contact.stick_area()].map(|area| area / nominal);
                area.push((at, shares[0]));
                stick.push((at, shares[1]));
                force.push((at, carried));
                table.serialize((until, at, shares[0], shares[1], carried))?;
                // where it begins to slide lies between the samples: what it has slid is not its own motion
                if slides.is_nan() && contact.slid() > 0.0 {
                    slides = at - contact.slid();
                }
                if half.is_none() && carried > 0.6 {
                    half = Some(contact.clone());
                }
            }
        }
        println!(
            "in {until:.0e} s: {:.3} of the surface in contact at first, {:.3} at the end; it slides after {:.2} µm",
            area[0].1,
            area[area.len() - 1].1,
            1e6 * slides
        );
        areas.add(format!("contact, sheared in {until} s"), COLORS[n], Style::Dots, area);
        areas.add(format!("stick, sheared in {until} s"), COLORS[n], Style::Line, stick);
        forces.add(format!("sheared in {until} s"), COLORS[n], Style::Line, force);
        if let Some(contact) = half.filter(|_| n == 1) {
            let pressure = contact.pressure()?;
            // blank outside the contact
            let inside = |values: Vec<f64>| -> Vec<f64> {
                values.into_iter().zip(&pressure).map(|(value, p)| if *p > 0.0 { value } else { f64::NAN }).collect()
            };
            let mut maps = [
                Map::new(&grid, inside(pressure.clone()), Quantity::new("pressure", "Pa"))?,
                Map::new(&grid, inside(contact.shear()?), Quantity::new("tangential traction", "Pa"))?,
            ];
            maps.iter_mut().for_each(|map| map.range[0] = 0.0);
            maps[0].title = "pressure, Q = 0.6 f P".into();
            maps[1].title = "traction, Q = 0.6 f P".into();
            Map::draw_row(&maps)?.save(args.output.join("tractions.png"))?;
        }
    }
    table.flush()?;
    areas.save(args.output.join("areas.png"))?;
    forces.save(args.output.join("forces.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
