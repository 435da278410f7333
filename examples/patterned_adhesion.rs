//! A ball with a pattern is pulled off an elastic body: dimples, pillars and rings against a plain ball, by pull-off force and work.
//!
//! The edge of the contact has to pass each element of the pattern, and jumps from one to the next. Each jump loses energy, so that a pattern
//! which is pressed into full contact can take more work to separate than the plain ball (Guduru, J. Mech. Phys. Solids 55, 2007, for
//! rings); a pattern that stays open has less contact, and holds less.
//!
//! `cargo run --release -p viscocontact --features adhesion,plot --example patterned_adhesion`

mod support;

use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Style};
use viscocontact::prelude::*;

/// Patterned balls pulled off an elastic body.
#[derive(Parser)]
struct Args {
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 1.0e-3, value_parser = support::positive)]
    radius: f64,
    /// Contact modulus E* [Pa].
    #[arg(long, default_value_t = 1.0e5, value_parser = support::positive)]
    modulus: f64,
    /// Work of separation [J/m²].
    #[arg(long, default_value_t = 0.1, value_parser = support::positive)]
    work: f64,
    /// Range of the attraction [m].
    #[arg(long, default_value_t = 5.5e-6, value_parser = support::positive)]
    range: f64,
    /// Distance between the elements of a pattern [m].
    #[arg(long, default_value_t = 150.0e-6, value_parser = support::positive)]
    pitch: f64,
    /// Height of the elements [m].
    #[arg(long, default_value_t = 12.0e-6, value_parser = support::positive)]
    height: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 160)]
    cells: usize,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/patterned_adhesion")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

/// A ball with a pattern: how far the pattern raises the surface of the ball, over its height, at a place.
type Pattern = fn(f64, f64) -> f64;

/// A round element in each square of the pattern, 1 at its middle and 0 beyond 0.4 pitches from there.
fn element(x: f64, y: f64) -> f64 {
    let r = (x - x.round()).hypot(y - y.round()) / 0.4;
    if r < 1.0 { (1.0 - r * r).powi(2) } else { 0.0 }
}

const PATTERNS: [(&str, Pattern); 4] = [
    ("plain", |_, _| 0.0),
    ("dimples", |x, y| -element(x + 0.5, y + 0.5)),
    ("pillars", element),
    ("rings", |x, y| 0.5 * ((TAU * x.hypot(y)).cos() - 1.0)),
];

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let &Args { radius, modulus, work, range, .. } = args;
    let width = (radius * radius * work / modulus).cbrt();
    let depth = width * width / radius;
    let (cells, step) = if args.quick { (120, 0.08) } else { (args.cells, 0.025) };
    let grid = Grid::square(cells, 8.0 * width)?;
    println!(
        "{:.1} cells in the zone of the attraction, {:.0} cells a pitch",
        modulus * range.powi(2) / work / grid.spacing()[0],
        args.pitch / grid.spacing()[0]
    );
    let law = ExponentialAttraction::new(work, range)?;
    let mut forces = Chart::new(
        "Patterned balls pressed on an elastic body and pulled off",
        Quantity::new("approach from touch", "m"),
        Quantity::new("force", "N"),
        Legend::UpperLeft,
    );
    let mut table = csv::Writer::from_path(args.output.join("paths.csv"))?;
    table.write_record(["pattern", "approach_m", "force_n", "contact_area_m2"])?;
    // pressed by 3 units of depth, and back
    let turn = (3.0 / step) as usize;
    let progress = support::progress((PATTERNS.len() * 3 * turn) as u64);
    let mut maps = Vec::new();
    for (n, (name, pattern)) in PATTERNS.into_iter().enumerate() {
        let (pitch, height) = (args.pitch, args.height);
        let ball = FnGeometry::new(move |x: f64, y: f64| {
            (x * x + y * y) / (2.0 * radius) - height * pattern(x / pitch, y / pitch)
        });
        let mut contact = ViscoelasticContact::builder(grid.clone())
            .geometry(&ball)
            .material(Material::incompressible(Elastic::new(0.25 * modulus)?))
            .attraction(law)
            .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(true))
            .build()?;
        let touch = contact.approach();
        let mut path: Vec<[f64; 3]> = Vec::new();
        let mut strongest = contact.clone();
        for k in 0.. {
            let course = if k <= turn { k as f64 } else { 2.0 * turn as f64 - k as f64 };
            let approach = depth * step * course;
            let report = contact.step(1.0, Load::approach(touch + approach))?;
            let point = [approach, report.force, contact.contact_area()];
            table.serialize((name, point[0], point[1], point[2]))?;
            path.push(point);
            if report.force < strongest.force() {
                strongest.clone_from(&contact);
            }
            progress.inc(1);
            if k > turn && contact.is_separated() {
                break;
            }
        }
        let back = &path[turn..];
        let pulled: f64 = back
            .windows(2)
            .filter(|pair| pair[1][1] < 0.0)
            .map(|pair| 0.5 * (pair[0][1].min(0.0) + pair[1][1]) * (pair[1][0] - pair[0][0]))
            .sum();
        let lost: f64 = path.windows(2).map(|pair| 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0])).sum();
        progress.suspend(|| {
            println!(
                "{name}: pull-off {:.1} µN, work of separation {:.2} nJ, lost in the loop {:.2} nJ; {:.3} mm² in contact at most",
                -1e6 * strongest.force(),
                1e9 * pulled,
                1e9 * lost,
                1e6 * path[turn][2]
            );
        });
        forces.add(name, COLORS[n], Style::Line, path.iter().map(|point| (point[0], point[1])).collect());
        let mut map = Map::of(&strongest, Field::Traction)?;
        map.title = format!("{name}: maximum pull");
        map.range = [-work / range, work / range];
        maps.push(map);
    }
    progress.finish_and_clear();
    table.flush()?;
    forces.save(args.output.join("force.png"))?;
    Map::draw_row(&maps)?.save(args.output.join("traction.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
