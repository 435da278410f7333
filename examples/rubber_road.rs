//! A rubber slides over a road, at speeds over eight decades and three temperatures: friction and contact area, each speed as one contact problem, and the
//! estimate of Persson's theory beside it.
//!
//! To step there would take as many steps as the longest relaxation time takes: 10 s at 1 m/s are ten kilometres of road.
//!
//! `cargo run --release -p viscocontact --features analytic,data,plot,sliding,surfaces --example rubber_road`

mod support;

use std::error::Error;
use std::fs;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use viscocontact::analytic::PerssonFriction;
use viscocontact::contact::Warnings;
use viscocontact::plot::{COLORS, Chart, Color, Legend, Map, Quantity, Scale, Style, measure};
use viscocontact::prelude::*;
use viscocontact::rheology::{TimeTemperature, library};
use viscocontact::sliding::{SlidingReport, SlidingSweep, SlidingTable, SweptState};

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

/// Temperatures [K]; the spectrum was measured at the first of them.
const TEMPERATURES: [f64; 3] = [298.15, 273.15, 333.15];
/// Speeds [m/s], as powers of ten.
const DECADES: [i32; 2] = [-6, 2];

fn main() {
    support::finish(run(&Args::parse()));
}

/// Polyisobutylene as measured at 25 °C over 17 decades (Catsiff & Tobolsky, 1955), as a rubber: crosslinks keep the terms slower than this time [s], by which
/// the polymer flows.
const CROSSLINKED: f64 = 1.0;

fn rubber() -> viscocontact::Result<GeneralizedMaxwell> {
    // a third of the modulus in tension
    let polymer = library::find("polyisobutylene")?.terms();
    let terms: Vec<(f64, f64)> = polymer.iter().map(|&(modulus, time)| (modulus / 3.0, time)).collect();
    let (held, terms): (Vec<_>, Vec<_>) = terms.into_iter().partition(|(_, time)| *time > CROSSLINKED);
    GeneralizedMaxwell::new(held.iter().map(|(modulus, _)| modulus).sum(), &terms)
}

/// WLF of polyisobutylene about 298 K (J. D. Ferry, Viscoelastic Properties of Polymers, 1980, table 11-II).
fn law() -> viscocontact::Result<TimeTemperature> {
    TimeTemperature::wlf(8.61, 200.4, TEMPERATURES[0])
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let (cells, every) = if args.quick { (64, 2.0) } else { (args.cells, 0.5) };
    let grid = Grid::square(cells, args.length)?;
    let spec =
        RoughSpec::new(0.5 * args.length, args.length / 32.0, Roughness::RmsSlope(args.slope)).with_seed(args.seed);
    let road = Rough::new(&grid, spec)?;
    let builder = || -> viscocontact::Result<_> {
        Ok(ViscoelasticContact::builder(grid.clone())
            .geometry(&road)
            .material(Material::incompressible(rubber()?))
            .kernel(InfluenceKernel::periodic(&grid)?))
    };
    let mut sliding = builder()?.build_sliding()?;
    let load = Load::force(args.pressure * args.length.powi(2));
    let count = (f64::from(DECADES[1] - DECADES[0]) / every).round() as i32;
    let speeds = || (0..=count).map(|k| 10f64.powf(f64::from(DECADES[1]) - every * f64::from(k)));
    let sweep = SlidingSweep::new(speeds().map(|speed| [speed, 0.0]), [load]).at_temperatures(law()?, TEMPERATURES);
    let (began, bar) = (Instant::now(), support::progress(3 * (count as u64 + 1)));
    let table = sliding.sweep_with(&sweep, |_, _| {
        bar.inc(1);
        ControlFlow::Continue(())
    })?;
    bar.finish_and_clear();
    let transforms: usize = table.states().iter().map(|state| state.report.transforms).sum();
    let states = table.states().len();
    println!("{states} states, {transforms} pairs of transforms, {:.2} s", began.elapsed().as_secs_f64());
    table.write_csv(args.output.join("sweep.csv"))?;
    table.chart("coefficient of friction", SlidingReport::friction).save(args.output.join("sweep.png"))?;
    draw(args, &grid, &road, &table)?;

    let mut maps = Vec::new();
    for speed in [1e2, 1e-2, 1e-6] {
        let report = sliding.at([speed, 0.0], load)?;
        let mut map = Map::of(sliding.fields(), Field::Pressure)?;
        map.title =
            format!("{}: {:.1} % in contact", measure(speed, "m/s"), 100.0 * report.contact_area / args.length.powi(2));
        maps.push(map);
    }
    Map::draw_row(&maps)?.save(args.output.join("pressure.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}

/// Friction and area over the speed: dots are contact problems, lines of the same colour Persson's theory.
fn draw(args: &Args, grid: &Grid, road: &Rough, table: &SlidingTable) -> Result<(), Box<dyn Error>> {
    let spectrum = Material::incompressible(rubber()?).contact_spectrum()?.ok_or("the rubber has no series")?;
    let (law, modulus) = (law()?, |omega: f64| spectrum.complex_modulus(omega));
    let chart = |title: &str, quantity: &str, legend| {
        let mut chart = Chart::new(title, Quantity::new("speed", "m/s"), quantity, legend);
        chart.scale = Scale::LogX;
        chart
    };
    let mut charts = [
        chart("Friction of a rubber on a road", "coefficient of friction", Legend::UpperLeft),
        chart("Contact of a rubber on a road", "part of the road in contact", Legend::UpperRight),
    ];
    let area = args.length.powi(2);
    let mut isotherms: Vec<_> =
        TEMPERATURES.into_iter().zip(table.states().chunk_by(|a, b| a.temperature == b.temperature)).collect();
    isotherms.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (k, (kelvin, states)) in isotherms.into_iter().enumerate() {
        let shift = law.shift_factor(kelvin)?;
        let is_resolved = |own: &&SweptState| !own.report.warnings.contains(Warnings::FEW_CELLS);
        let point =
            |own: &SweptState| (own.report.velocity[0], [own.report.friction(), own.report.contact_area / area]);
        let (resolved, unresolved): (Vec<_>, Vec<_>) = states.iter().partition(is_resolved);
        let [found, coarse] = [resolved, unresolved].map(|own| own.into_iter().map(point).collect::<Vec<_>>());
        let theory = (4 * DECADES[0]..=4 * DECADES[1]).map(|decade| {
            let speed = 10f64.powf(0.25 * f64::from(decade));
            let own = PerssonFriction::new(grid, road, modulus, args.pressure, [speed * shift, 0.0], 0.5)?;
            Ok((speed, [own.friction, own.contact_share]))
        });
        let theory = theory.collect::<viscocontact::Result<Vec<_>>>()?;
        for (which, chart) in charts.iter_mut().enumerate() {
            let of = |all: &[(f64, [f64; 2])]| all.iter().map(|(speed, own)| (*speed, own[which])).collect();
            // each name once
            let once = |name: &str| if k == 0 { name.to_owned() } else { String::new() };
            chart.add(
                once("contacts fewer than 8 cells across: unresolved"),
                Color(190, 190, 190),
                Style::Dots,
                of(&coarse),
            );
            chart.add(once("lines: Persson's theory"), COLORS[k], Style::Line, of(&theory));
            chart.add(format!("{kelvin} K"), COLORS[k], Style::Dots, of(&found));
        }
    }
    charts[0].save(args.output.join("friction.png"))?;
    charts[1].save(args.output.join("area.png"))?;
    Ok(())
}
