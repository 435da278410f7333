//! A rough surface approaches a creeping body that it sticks to, and is drawn back: the hysteresis of the mean stress, and the patches.
//!
//! Patches of contact snap in and separate one after the other, each at a loss of energy. So an elastic body has a hysteresis too. A creeping
//! body loses more: it relaxes while the surfaces are in contact, and is stiffer at once when they are drawn apart.
//!
//! `cargo run --release -p viscocontact --features adhesion,plot,surfaces --example rough_adhesion`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Style};
use viscocontact::prelude::*;

/// A rough surface that sticks to a creeping body, in approach and retraction.
#[derive(Parser)]
struct Args {
    /// Relaxed contact modulus E* [Pa].
    #[arg(long, default_value_t = 2.0e5, value_parser = support::positive)]
    modulus: f64,
    /// Contact modulus at once over the relaxed one.
    #[arg(long, default_value_t = 3.0, value_parser = support::positive)]
    ratio: f64,
    /// Relaxation time [s].
    #[arg(long, default_value_t = 1.0, value_parser = support::positive)]
    tau: f64,
    /// Work of separation [J/m²].
    #[arg(long, default_value_t = 0.05, value_parser = support::positive)]
    work: f64,
    /// Range of the attraction [m].
    #[arg(long, default_value_t = 0.9e-6, value_parser = support::positive)]
    range: f64,
    /// Side of the surface, which repeats [m].
    #[arg(long, default_value_t = 100.0e-6, value_parser = support::positive)]
    length: f64,
    /// Root mean square of the height [m].
    #[arg(long, default_value_t = 2.5e-6, value_parser = support::positive)]
    height: f64,
    /// Which random surface.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/rough_adhesion")]
    output: PathBuf,
}

/// Approach of the mean planes from the first touch at which the surface turns, and at which the run begins, over the height.
const TURN: f64 = 2.0;
const START: f64 = -0.6;

fn main() {
    support::finish(run(&Args::parse()));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let (cells, steps) = if args.quick { (96, 16) } else { (args.cells, 180) };
    let grid = Grid::square(cells, args.length)?;
    let spec = RoughSpec::new(args.length, 0.25 * args.length, Roughness::RmsHeight(args.height)).with_seed(args.seed);
    let surface = Rough::new(&grid, spec)?;
    let law = ExponentialAttraction::new(args.work, args.range)?;
    let zone = args.modulus * args.range.powi(2) / args.work / grid.spacing()[0];
    println!("{zone:.1} cells in the zone of the attraction on the relaxed body");
    let kernel = std::sync::Arc::new(InfluenceKernel::periodic(&grid)?);
    let relaxed = Elastic::new(0.25 * args.modulus)?;
    let creeping =
        GeneralizedMaxwell::new(0.25 * args.modulus, &[(0.25 * args.modulus * (args.ratio - 1.0), args.tau)])?;
    let rheologies: [(&str, f64, Box<dyn Rheology>); 3] = [
        ("elastic", 1.0, Box::new(relaxed)),
        ("creeping, 100 τ each way", 100.0, Box::new(creeping.clone())),
        ("creeping, 10 τ each way", 10.0, Box::new(creeping)),
    ];

    let mut loops = Chart::new(
        "A rough surface approaches and is drawn back",
        Quantity::new("approach of the mean planes", "m"),
        Quantity::new("mean stress", "Pa"),
        Legend::UpperLeft,
    );
    let mut table = csv::Writer::from_path(args.output.join("loops.csv"))?;
    table.write_record(["body", "time_s", "approach_m", "mean_stress_pa", "area_share", "patches"])?;
    let progress = support::progress(3 * 2 * steps as u64);
    let mut maps = Vec::new();
    for (n, (name, duration, rheology)) in rheologies.into_iter().enumerate() {
        let mut contact = ViscoelasticContact::builder(grid.clone())
            .geometry(&surface)
            .material(Material::incompressible(rheology))
            .kernel(std::sync::Arc::clone(&kernel))
            .attraction(law)
            .build()?;
        let touch = contact.approach();
        let nominal = args.length.powi(2);
        let mut path: Vec<[f64; 3]> = Vec::new();
        for k in 0..=2 * steps {
            let course = 1.0 - (k as f64 / steps as f64 - 1.0).abs();
            let approach = touch + args.height * (START + (TURN - START) * course);
            let dt = if k == 0 { 0.0 } else { 1.0 };
            let report = contact.step((dt / steps as f64 * duration * args.tau).max(1e-6), Load::approach(approach))?;
            let (stress, share) = (report.force / nominal, contact.contact_area() / nominal);
            table.serialize((name, report.time, approach, stress, share, contact.fields().patches()?.all.len()))?;
            path.push([approach - touch, stress, share]);
            // approach, the turn, and twice on the way back
            if n == 1 && [6 * steps / 10, steps, 14 * steps / 10, 15 * steps / 10].contains(&k) {
                let mut map = Map::of(&contact, Field::Traction)?;
                let way = if k <= steps { "approaching" } else { "drawn back" };
                map.title = format!("{way}: {:+.1} µm, {:.0} % in contact", 1e6 * (approach - touch), 100.0 * share);
                map.range = [-args.work / args.range, 1.5 * args.work / args.range];
                maps.push(map);
            }
            progress.inc(1);
        }
        let lost: f64 = path.windows(2).map(|pair| 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0])).sum();
        let pull = path.iter().map(|point| -point[1]).fold(0.0, f64::max);
        progress.suspend(|| {
            println!(
                "{name}: maximum mean pull {:.2} kPa, lost in the loop {:.2} mJ/m² ({:.2} w)",
                1e-3 * pull,
                1e3 * lost,
                lost / args.work
            );
        });
        loops.add(name, COLORS[n], Style::Line, path.iter().map(|point| (point[0], point[1])).collect());
    }
    progress.finish_and_clear();
    table.flush()?;
    loops.save(args.output.join("loops.png"))?;
    Map::draw_row(&maps)?.save(args.output.join("maps.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
