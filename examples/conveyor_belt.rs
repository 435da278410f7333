//! A conveyor belt runs over an idler roll: the rubber below its steel cords creeps, the steel does not, and what the rubber does not give back is the greater part of
//! what a long conveyor consumes. Resistance over the speed for covers of several thicknesses, each speed as one contact problem.
//!
//! In plane strain, on a layer whose base is rigid: steel is a thousand times as stiff.
//!
//! `cargo run --release -p viscocontact --features plot,sliding --example conveyor_belt`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Scale, Style};
use viscocontact::prelude::*;

/// A conveyor belt runs over an idler roll.
#[derive(Parser)]
struct Args {
    /// Radius of the roll [m].
    #[arg(long, default_value_t = 0.08, value_parser = support::positive)]
    radius: f64,
    /// Force on a metre of the roll [N/m].
    #[arg(long, default_value_t = 2.0e3, value_parser = support::positive)]
    load: f64,
    /// Cells along the belt.
    #[arg(long, default_value_t = 1024)]
    cells: usize,
    /// Fewer cells and speeds: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/conveyor_belt")]
    output: PathBuf,
}

/// Thicknesses of the rubber below the cords [m].
const COVERS: [f64; 4] = [2.0e-3, 4.0e-3, 8.0e-3, 16.0e-3];
/// Length of belt that is computed [m].
const LENGTH: f64 = 16.0e-3;

fn main() {
    support::finish(run(&Args::parse()));
}

/// A rubber of 3 MPa at rest and of 60 MPa at once, with a term in each decade.
fn rubber() -> viscocontact::Result<Material> {
    let terms = [3.0e7, 1.5e7, 7.0e6, 3.0e6, 1.5e6, 5.0e5].into_iter().zip([1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2]);
    Ok(Material::incompressible(GeneralizedMaxwell::new(3.0e6, &terms.collect::<Vec<_>>())?))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let (cells, parts) = if args.quick { (128, 1) } else { (args.cells, 4) };
    let grid = Grid::new([cells, 1], [LENGTH, 1.0])?;
    let mut friction = Chart::new(
        "Resistance of a belt over a roll",
        Quantity::new("speed", "m/s"),
        "lateral over normal force",
        Legend::UpperLeft,
    );
    friction.scale = Scale::LogX;
    let mut pressure = Chart::new(
        "Pressure at 5 m/s",
        Quantity::new("distance from the axis of the roll, ahead", "m"),
        Quantity::new("pressure", "Pa"),
        Legend::UpperLeft,
    );
    let mut table = csv::Writer::from_path(args.output.join("resistance.csv"))?;
    table.write_record(["cover_m", "speed_m_s", "friction", "width_m", "max_pressure_pa", "transforms"])?;
    for (k, cover) in COVERS.into_iter().enumerate() {
        let layer = viscocontact::Layer::bonded_to_rigid(cover, 0.5)?;
        let mut belt = ViscoelasticContact::builder(grid.clone())
            .geometry(&Cylinder::new(args.radius)?)
            .material(rubber()?)
            .kernel(InfluenceKernel::layer_line(&grid, layer, None)?)
            .build_sliding()?;
        let mut points = Vec::new();
        for step in (-3 * parts..=3 * parts).rev() {
            let speed = 10f64.powf(f64::from(step) / f64::from(parts));
            let report = belt.at([speed, 0.0], Load::force(args.load))?;
            let peak = belt.fields().max_pressure();
            table.serialize((cover, speed, report.friction(), report.contact_area, peak, report.transforms))?;
            points.push((speed, report.friction()));
        }
        let report = belt.at([5.0, 0.0], Load::force(args.load))?;
        println!("{:4} mm: {report}", 1e3 * cover);
        let name = format!("{} mm of rubber", 1e3 * cover);
        friction.add(&name, COLORS[k], Style::LineAndDots, points);
        let profile = (0..cells).map(|i| (grid.center(i, 0)[0], belt.fields().pressure()[i]));
        pressure.add(&name, COLORS[k], Style::Line, profile.filter(|(x, _)| x.abs() < 0.3 * LENGTH).collect());
    }
    table.flush()?;
    friction.save(args.output.join("friction.png"))?;
    pressure.save(args.output.join("pressure.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
