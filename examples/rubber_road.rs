//! A rubber slides over a road, at speeds over eight decades and three temperatures: friction and contact area, each speed as one contact problem.
//!
//! To step there would take as many steps as the longest relaxation time takes: 10 s at 1 m/s are ten kilometres of road.
//!
//! `cargo run --release --features plot --example rubber_road`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::TimeTemperature;

/// A rubber slides over a road, at speeds over eight decades.
#[derive(Parser)]
struct Args {
    /// Mean pressure [Pa].
    #[arg(long, default_value_t = 1.0e5, value_parser = support::positive)]
    pressure: f64,
    /// Side of the road, which repeats [m].
    #[arg(long, default_value_t = 1.0e-3, value_parser = support::positive)]
    length: f64,
    /// Root mean square of the slope of the road.
    #[arg(long, default_value_t = 0.2, value_parser = support::positive)]
    slope: f64,
    /// Which random road.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 256)]
    cells: usize,
    /// Fewer cells and speeds: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/rubber_road")]
    output: PathBuf,
}

/// Temperatures [°C]; the spectrum is that at the first of them.
const TEMPERATURES: [f64; 3] = [20.0, 0.0, 60.0];
/// 0 °C in K.
const ZERO: f64 = 273.15;
/// Speeds [m/s], as powers of ten.
const DECADES: [i32; 2] = [-6, 2];

fn main() {
    support::finish(run(&Args::parse()));
}

/// A rubber of 1 MPa at rest and of 100 MPa at once: a term in each half decade from 1e-7 to 10 s, less the slower it is.
fn rubber() -> viscocontact::Result<GeneralizedMaxwell> {
    let times = (0..17).map(|k| 10f64.powf(-7.0 + 0.5 * f64::from(k)));
    let share = |time: f64| time.powf(-0.25);
    let all: f64 = times.clone().map(share).sum();
    let terms: Vec<(f64, f64)> = times.map(|time| (99.0e6 * share(time) / all, time)).collect();
    GeneralizedMaxwell::new(1.0e6, &terms)
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let (cells, every) = if args.quick { (64, 2.0) } else { (args.cells, 0.5) };
    let grid = Grid::square(cells, args.length)?;
    let spec =
        RoughSpec::new(0.5 * args.length, args.length / 32.0, Roughness::RmsSlope(args.slope)).with_seed(args.seed);
    let road = Rough::new(&grid, spec)?;
    let mut sliding = ViscoelasticContact::builder(grid.clone())
        .geometry(&road)
        .material(Material::incompressible(rubber()?))
        .kernel(InfluenceKernel::periodic(&grid)?)
        .build_sliding()?;
    let load = Load::force(args.pressure * args.length.powi(2));
    // of a rubber with its glass transition at −40 °C
    let law = TimeTemperature::wlf(17.44, 51.6, ZERO - 40.0)?;
    let count = (f64::from(DECADES[1] - DECADES[0]) / every).round() as i32;
    let speeds: Vec<f64> = (0..=count).map(|k| 10f64.powf(f64::from(DECADES[1]) - every * f64::from(k))).collect();

    let mut friction = Chart::new(
        "Friction of a rubber on a road",
        Quantity::new("speed", "m/s"),
        "coefficient of friction",
        Legend::UpperLeft,
    );
    let mut area = Chart::new(
        "Contact of a rubber on a road",
        Quantity::new("speed", "m/s"),
        "part of the road in contact",
        Legend::UpperRight,
    );
    (friction.scale, area.scale) = (Scale::LogX, Scale::LogX);
    let mut table = csv::Writer::from_path(args.output.join("friction.csv"))?;
    table.write_record(["temperature_c", "speed_m_s", "friction", "area_share", "approach_m", "transforms"])?;
    let mut maps = Vec::new();
    for (n, temperature) in TEMPERATURES.into_iter().enumerate() {
        let shift = law.shift_factor(ZERO + temperature)? / law.shift_factor(ZERO + TEMPERATURES[0])?;
        let (began, mut transforms) = (Instant::now(), 0);
        let mut points = [Vec::new(), Vec::new()];
        for &speed in &speeds {
            let report = sliding.at([speed * shift, 0.0], load)?;
            let share = report.contact_area / args.length.powi(2);
            table.serialize((temperature, speed, report.friction(), share, report.approach, report.transforms))?;
            points[0].push((speed, report.friction()));
            points[1].push((speed, share));
            transforms += report.transforms;
            if n == 0 && [1e2, 1e-2, 1e-6].iter().any(|map: &f64| (speed / map - 1.0).abs() < 1e-9) {
                let mut map = Map::pressure(sliding.contact())?;
                map.title = format!("{speed:.0e} m/s: {:.1} % in contact", 100.0 * share);
                maps.push(map);
            }
        }
        println!(
            "{temperature} °C: {} speeds, {transforms} pairs of transforms, {:.2} s",
            speeds.len(),
            began.elapsed().as_secs_f64()
        );
        let [of_friction, of_area] = points;
        let name = format!("{temperature} °C");
        friction.add(&name, COLORS[n], Style::LineAndDots, of_friction);
        area.add(&name, COLORS[n], Style::LineAndDots, of_area);
    }
    table.flush()?;
    friction.save(args.output.join("friction.png"))?;
    area.save(args.output.join("area.png"))?;
    Map::save_row(&maps, args.output.join("pressure.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
