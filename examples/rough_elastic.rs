//! A measured rough surface on an elastic body: contact area, mean gap and pressures over the load, beside Persson's theory.
//!
//! Persson's theory of contact (J. Chem. Phys. 115, 3840, 2001) follows the pressure from the whole surface to the finest wave of
//! the roughness: of an even pressure p on a body of modulus E*, a share erf(√2 p/(E* h')) of the surface comes into contact, with
//! h' the rms slope (in the form of Manners & Greenwood, Wear 261, 2006). The map is that of `measured_surface`, made
//! periodic. Its scratch holds much of the slope and hardly touches, which no theory of Gaussian surfaces knows: the contact is
//! twice as large as Persson's at small loads, and never full.
//!
//! `cargo run --release -p viscocontact --features plot,surfaces --example rough_elastic`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::geometry::Form;
use viscocontact::plot::{COLORS, Chart, Legend, Map, Scale, Style};
use viscocontact::prelude::*;

/// A measured surface pressed onto an elastic body.
#[derive(Parser)]
struct Args {
    /// Measured map.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/surface.sdf"))]
    map: PathBuf,
    /// Contact modulus E* [Pa].
    #[arg(long, default_value_t = 1.0e6, value_parser = support::positive)]
    modulus: f64,
    /// Loads, from the least to the greatest.
    #[arg(long, default_value_t = 24, value_parser = support::at_least_one)]
    loads: usize,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 512, value_parser = support::at_least_one)]
    cells: usize,
    /// A small grid, for a look.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and pictures.
    #[arg(long, default_value = "out/rough_elastic")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let map = HeightMap::read(&args.map)?.leveled(Form::Curvature)?.filled()?;
    let side = map.lengths()[0].min(map.lengths()[1]);
    let grid = Grid::square(if args.quick { 128 } else { args.cells }, side)?;
    let map = periodic(&map.resampled(&grid)?)?;
    let slope = map.statistics()?.rms_slope;
    println!("{:.0} µm along each side, rms slope {slope:.3}, E* = {:e} Pa", side * 1e6, args.modulus);

    let mut contact = ElasticContact::builder(grid.clone())
        .geometry(&map)
        .kernel(InfluenceKernel::periodic(&grid)?)
        .modulus(args.modulus)
        .build()?;
    let nominal = side * side;
    // mean pressures over E* h', on which the share in contact depends
    let reduced = |k: usize| 1e-3 * 2e3_f64.powf(k as f64 / (args.loads.max(2) - 1) as f64);
    println!(
        "{:>11} {:>10} {:>8} {:>12} {:>12} {:>8}",
        "p [kPa]", "in contact", "Persson", "mean gap", "max [kPa]", "patches"
    );
    let mut rows = Vec::new();
    let progress = support::progress(args.loads as u64);
    for pressure in (0..args.loads).map(|k| reduced(k) * args.modulus * slope) {
        let report = contact.solve(Load::force(pressure * nominal))?;
        let fields = contact.fields();
        let mut gap = vec![0.0; grid.len()];
        fields.gap_into(&mut gap)?;
        let row = [
            pressure,
            fields.contact_area() / nominal,
            libm::erf(2f64.sqrt() * pressure / (args.modulus * slope)),
            gap.iter().sum::<f64>() / gap.len() as f64,
            fields.max_pressure(),
            report.convolution_equivalents(),
        ];
        progress.suspend(|| {
            let [p, area, theory, gap, peak, _] = row;
            let patches = fields.patches().map_or(0, |patches| patches.all.len());
            println!(
                "{:11.3} {area:10.4} {theory:8.4} {:9.4} µm {:12.2} {patches:8}",
                p * 1e-3,
                gap * 1e6,
                peak * 1e-3
            );
        });
        progress.inc(1);
        rows.push(row);
        // half of the greatest share
        if rows.len() == args.loads / 2 {
            Map::draw_row(&[Map::of(&contact, Field::Pressure)?, Map::of(&contact, Field::Gap)?])?
                .save(args.output.join("half_way.png"))?;
        }
    }
    progress.finish_and_clear();
    let work = rows.iter().map(|row| row[5]).sum::<f64>() / rows.len() as f64;
    println!("{work:.1} convolutions a load");
    save(args, &rows)
}

/// The map continued by its mirror images would have twice its sides: here the outermost tenth of the heights goes to their mean.
fn periodic(map: &HeightMap) -> Result<HeightMap, Box<dyn Error>> {
    let [n1, n2] = map.cells();
    let mean = map.heights().iter().sum::<f64>() / map.heights().len() as f64;
    let taper = |i: usize, n: usize| {
        let rim = 10.0 * (i.min(n - 1 - i) as f64 + 0.5) / n as f64;
        if rim < 1.0 { 0.5 - 0.5 * (std::f64::consts::PI * rim).cos() } else { 1.0 }
    };
    let height = |(k, h): (usize, &f64)| mean + (h - mean) * taper(k / n2, n1) * taper(k % n2, n2);
    let heights = map.heights().iter().enumerate().map(height).collect();
    Ok(HeightMap::new(map.cells(), map.lengths(), heights)?.periodic())
}

/// A table, and the curves over the pressure.
fn save(args: &Args, rows: &[[f64; 6]]) -> Result<(), Box<dyn Error>> {
    let mut table = csv::Writer::from_path(args.output.join("loads.csv"))?;
    table.write_record([
        "mean pressure [Pa]",
        "share in contact",
        "Persson",
        "mean gap [m]",
        "max pressure [Pa]",
        "convolutions",
    ])?;
    rows.iter().try_for_each(|row| table.serialize(row))?;
    table.flush()?;
    let curve =
        |column: usize, unit: f64| rows.iter().map(|row| (row[0] * 1e-3, row[column] * unit)).collect::<Vec<_>>();
    let mut area = Chart::new(
        "A measured surface on an elastic body",
        "mean pressure [kPa]",
        "share in contact",
        Legend::UpperLeft,
    );
    area.scale = Scale::LogLog;
    area.add("contact problems", COLORS[0], Style::LineAndDots, curve(1, 1.0));
    area.add("Persson's theory", COLORS[1], Style::Line, curve(2, 1.0));
    area.save(args.output.join("area.png"))?;
    let mut gap = Chart::new("Mean gap", "mean pressure [kPa]", "mean gap [µm]", Legend::UpperRight);
    gap.scale = Scale::LogX;
    gap.add("contact problems", COLORS[0], Style::LineAndDots, curve(3, 1e6));
    gap.save(args.output.join("gap.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
