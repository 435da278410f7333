//! A surface from a file: read in two formats, prepared, and pressed onto a creeping rubber as the roughness of a ball.
//!
//! The map shipped with this example is synthetic, made by us: a random surface on a tilted and slightly
//! curved plane, with a scratch, and some points missing as an instrument leaves them. `--generate` writes it anew. Give your
//! own with `--map`.
//!
//! `cargo run --release -p viscocontact --features analytic,data,plot,surfaces --example measured_surface`

mod support;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use viscocontact::Result;
use viscocontact::analytic::Hertz;
use viscocontact::geometry::Form;
use viscocontact::geometry::Sum;
use viscocontact::output::{CsvHistory, Earlier, Metadata};
use viscocontact::plot::{COLORS, Chart, Color, Legend, Map, Quantity, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::library;

/// A measured surface pressed onto creeping rubber.
#[derive(Parser)]
struct Args {
    /// Measured map (.gsf, .sdf, or .x3p where the crate is built to read it); the shipped one, in two formats, if none
    /// is given.
    #[arg(long)]
    map: Option<PathBuf>,
    /// Writes the shipped map anew and ends.
    #[arg(long)]
    generate: bool,
    /// Folder of the shipped map.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data"))]
    data: PathBuf,
    /// Rows and columns of points cut off on every side.
    #[arg(long, default_value_t = 2)]
    margin: usize,
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 10.0e-3)]
    radius: f64,
    /// Force [N].
    #[arg(long, default_value_t = 0.5e-3)]
    load: f64,
    /// Last time [s].
    #[arg(long, default_value_t = 1.0e4)]
    to: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 256)]
    cells: usize,
    /// A small grid, for a look.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/measured_surface")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    if args.generate {
        return generate(&args.data);
    }
    fs::create_dir_all(&args.output)?;
    let raw = match &args.map {
        Some(path) => HeightMap::read(path)?,
        None => shipped(&args.data)?,
    };
    println!(
        "{} × {} points, {:.2} µm × {:.2} µm apart, {} missing",
        raw.cells()[0],
        raw.cells()[1],
        raw.spacing()[0] * 1e6,
        raw.spacing()[1] * 1e6,
        raw.missing()
    );
    let prepared = prepare(&raw, args.margin)?;
    let maps = [
        picture(&raw, "as measured")?,
        picture(&prepared.clone().flipped([true, false]), "prepared, seen from the same side")?,
    ];
    for (map, name) in maps.iter().zip(["measured.png", "prepared.png"]) {
        map.save(args.output.join(name))?;
    }
    Map::draw_row(&maps)?.save(args.output.join("surface.png"))?;
    press(args, &prepared)?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// Both files hold the same map, the one in single precision, the other with all its digits.
fn shipped(data: &Path) -> Result<HeightMap, Box<dyn Error>> {
    let single = HeightMap::read(data.join("surface.gsf"))?;
    let whole = HeightMap::read(data.join("surface.sdf"))?;
    let same = |(a, b): (&f64, &f64)| (a.is_nan() && b.is_nan()) || *a == f64::from(*b as f32);
    if single.cells() != whole.cells() || !single.heights().iter().zip(whole.heights()).all(same) {
        return Err("surface.gsf and surface.sdf hold different maps: write them anew with --generate".into());
    }
    println!("surface.gsf and surface.sdf agree to single precision");
    Ok(whole)
}

/// The roughness alone: without form, without gaps, and the way round in which it lies on the other body.
fn prepare(raw: &HeightMap, margin: usize) -> Result<HeightMap, Box<dyn Error>> {
    println!("{:28} {:>8} {:>12} {:>10} {:>8} {:>8}", "", "missing", "rms height", "rms slope", "skew", "kurtosis");
    let row = |name: &str, map: &HeightMap| -> Result<()> {
        let s = map.statistics()?;
        let (height, slope) = (s.rms_height * 1e6, s.rms_slope);
        println!("{name:28} {:8} {height:9.3} µm {slope:10.4} {:8.3} {:8.3}", map.missing(), s.skewness, s.kurtosis);
        Ok(())
    };
    row("as measured", raw)?;
    // the form first, from the known heights; holes are filled on the even surface
    let map = raw.clone().leveled(Form::Curvature)?;
    row("less a paraboloid", &map)?;
    let map = map.filled()?;
    row("missing points filled", &map)?;
    let [n1, n2] = map.cells();
    let rest = |n: usize| n.checked_sub(2 * margin).ok_or("the margin leaves nothing");
    let map = map.cropped([margin; 2], [rest(n1)?, rest(n2)?])?;
    row(&format!("{margin} points cut off all around"), &map)?;
    // measured from above, it is to lie face down
    Ok(map.flipped([true, false]))
}

/// Presses a ball with this roughness onto polyisobutylene and holds it.
fn press(args: &Args, roughness: &HeightMap) -> Result<(), Box<dyn Error>> {
    // a square within the map
    let side = roughness.lengths()[0].min(roughness.lengths()[1]);
    let cells = if args.quick { 96 } else { args.cells };
    println!("\nwhat a grid of {:.0} µm keeps of the map", side * 1e6);
    for n in [cells / 8, cells / 4, cells] {
        let kept = roughness.resampled(&Grid::square(n, side)?)?.statistics()?;
        println!(
            "{n:4}²: cells of {:5.2} µm, rms height {:.3} µm, rms slope {:.4}",
            side / n as f64 * 1e6,
            kept.rms_height * 1e6,
            kept.rms_slope
        );
    }
    let grid = Grid::square(cells, side)?;
    let rubber = library::find("polyisobutylene")?.material(0.5)?;
    let mut contact = ViscoelasticContact::builder(grid)
        .geometry(&Sum::new(Sphere::new(args.radius)?, roughness.clone()))
        .material(rubber.clone())
        .build()?;
    let table = args.output.join("history.csv");
    let scene = Metadata::new("Rough ball on rubber").note("radius", format!("{} m", args.radius));
    let mut history =
        CsvHistory::create(&table, &scene, &contact, &["patches", "smooth ball: contact area [m2]"], Earlier::Replace)?;

    println!("\npolyisobutylene under {} mN", args.load * 1e3);
    println!(
        "{:>7} {:>10} {:>11} {:>8} {:>9} {:>14} {:>14}",
        "t [s]", "area [mm²]", "smooth ball", "patches", "largest", "p max [kPa]", "smooth ball"
    );
    let shown: Vec<f64> = (0..).map(|k| 1e-2 * 10f64.powi(k)).take_while(|t| *t < 1.001 * args.to).collect();
    let (first, last) = (shown[0], shown[shown.len() - 1]);
    let mut chart =
        Chart::new("Rough ball on polyisobutylene: pressure along x1", "x1 [mm]", "pressure [kPa]", Legend::UpperRight);
    let (mut steps, mut work, mut maps) = (0, 0.0, Vec::new());
    let load = StepLoad::new(Load::force(args.load))?;
    let progress = support::progress(shown.len() as u64);
    let mut run = contact.follow(&load, Stepping::adaptive(1e-3), last).stop_at(&shown)?;
    while let Some(report) = run.next_step()? {
        let contact = run.contact();
        (steps, work) = (steps + 1, work + report.convolution_equivalents());
        let patches = contact.fields().patches()?;
        let smooth = Hertz::new(args.radius, 1.0 / rubber.contact_compliance(report.time), args.load)?;
        let hertz = std::f64::consts::PI * smooth.contact_radius.powi(2);
        history.record(contact, &report, &[patches.all.len() as f64, hertz])?;
        if !shown.contains(&report.time) {
            continue;
        }
        progress.suspend(|| {
            println!(
                "{:7} {:10.5} {:11.5} {:8} {:9.5} {:14.2} {:14.2}",
                report.time,
                contact.contact_area() * 1e6,
                hertz * 1e6,
                patches.all.len(),
                patches.largest().map_or(0.0, |patch| patch.area * 1e6),
                contact.fields().max_pressure() * 1e-3,
                smooth.max_pressure * 1e-3
            );
        });
        progress.inc(1);
        if report.time == first || report.time == last {
            let color = if report.time == first { 0 } else { 1 };
            let line = contact.fields().profile(Axis::X1, 0.0)?;
            let points = line.positions.iter().zip(&line.pressure).map(|(x, p)| (x * 1e3, p * 1e-3)).collect();
            chart.add(format!("{} s, rough", report.time), COLORS[color], Style::Line, points);
            let points = line.positions.iter().map(|&x| (x * 1e3, smooth.pressure(x.abs()) * 1e-3)).collect();
            chart.add(format!("{} s, smooth ball (Hertz)", report.time), COLORS[5 - color], Style::Line, points);
            maps.push(Map::of(contact, Field::Pressure)?);
        }
    }
    progress.finish_and_clear();
    println!("{steps} steps of {:.2} convolutions", work / f64::from(steps));
    chart.save(args.output.join("profile.png"))?;
    // one scale for all, on which the later pressures, which are smaller, are seen as well
    let most = 0.5 * maps.iter().map(|map| map.range[1]).fold(0.0, f64::max);
    maps.iter_mut().for_each(|map| map.range = [0.0, most]);
    Ok(Map::draw_row(&maps)?.save(args.output.join("pressure.png"))?)
}

/// A map of heights as a picture, from the lowest to the highest.
fn picture(map: &HeightMap, title: &str) -> Result<Map> {
    let grid = Grid::new(map.cells(), map.lengths())?;
    let mut picture = Map::new(&grid, map.heights().to_vec(), Quantity::new("height", "m"))?;
    picture.title = title.into();
    picture.blank = Color(190, 190, 190);
    Ok(picture)
}

/// Makes up the map that is shipped, and writes it in both formats.
fn generate(data: &Path) -> Result<(), Box<dyn Error>> {
    let spacing = 10.0e-6;
    let cells = [96, 64];
    let grid = Grid::new(cells, cells.map(|n| n as f64 * spacing))?;
    let spec = RoughSpec::new(0.3e-3, 4.0 * spacing, Roughness::RmsHeight(0.5e-6))
        .with_roll_off(0.15e-3)
        .with_anisotropy(Anisotropy::new(1.5, 0.3))
        .with_seed(8);
    // not periodic: a part of a larger surface
    let rough = Rough::windowed(&grid, spec, [160.0 * spacing, 120.0 * spacing])?;
    let mut noise = Noise(8);
    let mut heights = Vec::new();
    for k in 0..grid.len() {
        let [x1, x2] = grid.center(k / cells[1], k % cells[1]);
        let form = 6.0e-3 * x1 - 4.0e-3 * x2 - x1 * x1 / 0.2 - x2 * x2 / 0.12;
        // a scratch across a corner, with a ridge on either side of it
        let across = ((x1 - 0.15e-3) * 0.8 - (x2 + 0.05e-3) * 0.6) / 15.0e-6;
        let scratch = -2.5e-6 * (1.0 - 0.5 * across * across) * (-0.5 * across * across).exp();
        let roughness = -rough.initial_gap(x1, x2);
        let dropped = noise.next() < 0.006 || (x1 + 0.3e-3).hypot(x2 - 0.2e-3) < 35.0e-6;
        let measured = form + scratch + roughness + 20.0e-9 * (noise.next() - 0.5);
        // the steps of the instrument: 0.1 nm
        heights.push(if dropped { f64::NAN } else { (measured * 1e10).round() / 1e10 });
    }
    let map = HeightMap::new(cells, grid.lengths(), heights)?;
    fs::create_dir_all(data)?;
    map.write_gsf(fs::File::create(data.join("surface.gsf"))?)?;
    map.write_sdf(fs::File::create(data.join("surface.sdf"))?)?;
    println!("surface.gsf and surface.sdf are in {}", data.display());
    Ok(())
}

/// Random numbers in [0, 1), the same every time: the multiplier is Knuth's.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}
