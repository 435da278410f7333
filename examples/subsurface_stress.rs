//! Where a creeping body is stressed most, and how that point moves: a ball under a constant force on a polymer of Poisson's
//! ratio 0.35, and on an incompressible one of the same shear compliance.
//!
//! The contact grows by creep, the pressure falls, and the point of the greatest von Mises stress sinks. While the contact
//! grows fast it lies deeper than Hertz's, at up to 0.62 contact radii, since the pressure is flatter; in the end it is Hertz's
//! again.
//! On bodies that creep tenfold a shallow ring below the rim may carry more for a while; how much depends on mesh and steps there
//! (49 … 55 MPa in one scene), so no such body is shown.
//!
//! `cargo run --release -p viscocontact --features analytic,plot,stress --example subsurface_stress`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::observe::{Stress, StressPeak, StressSection};
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Scale, Style};
use viscocontact::prelude::*;

/// The greatest von Mises stress below a ball on a polymer that creeps.
#[derive(Parser)]
struct Args {
    /// Glassy shear modulus [Pa].
    #[arg(long, default_value_t = 1.0e9)]
    modulus: f64,
    /// Shear modulus of the Kelvin-Voigt element [Pa].
    #[arg(long, default_value_t = 0.3e9)]
    kelvin_modulus: f64,
    /// Retardation time [s].
    #[arg(long, default_value_t = 1.0)]
    tau: f64,
    /// Poisson's ratio of the compressible polymer.
    #[arg(long, default_value_t = 0.35)]
    poisson_ratio: f64,
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 5.0e-3)]
    radius: f64,
    /// Force [N].
    #[arg(long, default_value_t = 50.0)]
    force: f64,
    /// Cells along each side.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Times at which the stress is evaluated, ten per decade from a hundredth of the retardation time.
    #[arg(long, default_value_t = 34)]
    steps: usize,
    /// Coarse and fast: 48 cells.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/subsurface_stress")]
    output: PathBuf,
}

/// Steps between two evaluations of the stress.
const SUBSTEPS: usize = 8;

fn main() {
    support::finish(run(&Args::parse()));
}

/// The state at one time.
struct Moment {
    time: f64,
    radius: f64,
    pressure: f64,
    peak: StressPeak,
}

/// A run on one body.
struct Run {
    moments: Vec<Moment>,
    /// Sections after the jump and at the end, on the contact then.
    sections: Vec<(ViscoelasticContact, StressSection)>,
}

/// Steps a ball on `material` and follows the stress; `advance` is called after each step.
fn press(args: &Args, material: Material, length: f64, advance: impl Fn()) -> viscocontact::Result<Run> {
    let cells = if args.quick { 48 } else { args.cells };
    let mut contact = ViscoelasticContact::builder(Grid::square(cells, length)?)
        .geometry(&Sphere::new(args.radius)?)
        .material(material)
        .build()?;
    let step = length / cells as f64;
    let mut run = Run { moments: Vec::new(), sections: Vec::new() };
    for k in 0..=args.steps {
        // after the jump, steps that grow with time; the stress is evaluated ten times per decade
        for part in 1..=SUBSTEPS {
            let tenths = k as f64 - 1.0 + part as f64 / SUBSTEPS as f64;
            let time = if k == 0 { 0.0 } else { 0.01 * args.tau * 10f64.powf(0.1 * tenths) };
            contact.step(time - contact.time(), Load::force(args.force))?;
        }
        let stress = contact.fields().stress()?;
        let radius = (contact.contact_area() / std::f64::consts::PI).sqrt();
        // nearer the surface the cells that joined last stand out, as in the pressure: they are stiffer than their neighbours
        let depths: Vec<f64> = (2..=12).map(|k| 0.1 * f64::from(k) * radius).collect();
        let peak = stress.maximum(&depths, Stress::von_mises)?;
        run.moments.push(Moment { time: contact.time(), radius, pressure: contact.fields().max_pressure(), peak });
        if k == 0 || k == args.steps {
            let depths: Vec<f64> = (0..cells / 2).map(|k| (k as f64 + 0.5) * step).collect();
            run.sections.push((contact.clone(), stress.on_section(Axis::X1, 0.0, &depths)?));
        }
        advance();
    }
    Ok(run)
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let shear = Zener::with_time(args.modulus, args.kelvin_modulus, args.tau)?;
    let polymer = Material::constant_poisson(shear.clone(), args.poisson_ratio)?;
    // the contact at the end, with some space around it
    let last =
        viscocontact::analytic::Hertz::new(args.radius, 1.0 / polymer.contact_compliance(1e3 * args.tau), args.force)?;
    let length = 3.0 * last.contact_radius;
    let progress = support::progress(2 * (args.steps as u64 + 1));
    let bodies = [("compressible", polymer), ("incompressible", Material::incompressible(shear))];
    let mut runs = Vec::new();
    for (name, material) in bodies {
        runs.push((name, press(args, material, length, || progress.inc(1))?));
    }
    progress.finish_and_clear();

    let mut table = csv::Writer::from_path(args.output.join("peaks.csv"))?;
    table.write_record(["body", "time_s", "radius_m", "max_pressure_pa", "max_von_mises_pa", "depth_m"])?;
    println!("body            t [s]   a [µm]  p0 [MPa]  von Mises [MPa]  over p0  depth [µm]  over a");
    for (name, run) in &runs {
        for (k, Moment { time, radius, pressure, peak }) in run.moments.iter().enumerate() {
            let depth = peak.position[2];
            let values = [*time, *radius, *pressure, peak.value, depth].map(|value| format!("{value:e}"));
            table.write_record(std::iter::once((*name).to_owned()).chain(values))?;
            if k % 6 == 0 || k == args.steps {
                println!(
                    "{name:<14} {time:7.3}  {:7.1}  {:8.2}  {:15.2}  {:7.4}  {:10.1}  {:6.4}",
                    radius * 1e6,
                    pressure * 1e-6,
                    peak.value * 1e-6,
                    peak.value / pressure,
                    depth * 1e6,
                    depth / radius
                );
            }
        }
    }
    table.flush()?;
    draw(args, &runs)
}

fn draw(args: &Args, runs: &[(&str, Run)]) -> Result<(), Box<dyn Error>> {
    let name = || Quantity::new("von Mises stress", "Pa");
    let sections = &runs[0].1.sections;
    let mut maps = Vec::new();
    for (contact, section) in sections {
        maps.push(Map::section(contact, section, Stress::von_mises, name())?);
    }
    // from zero on
    maps.iter_mut().for_each(|map| map.range[0] = 0.0);
    Map::draw_row(&maps)?.save(args.output.join("sections.png"))?;

    let time = || Quantity::new("time", "s");
    let mut depth = Chart::new(
        "Maximum von Mises stress: its depth, and the contact radius",
        time(),
        Quantity::new("length", "m"),
        Legend::UpperLeft,
    );
    let mut relative =
        Chart::new("The same depth over the contact radius", time(), "depth / contact radius", Legend::LowerRight);
    for chart in [&mut depth, &mut relative] {
        chart.scale = Scale::LogX;
    }
    for ((name, run), color) in runs.iter().zip(COLORS) {
        // the jump has no place on a logarithmic axis
        let later = || run.moments.iter().skip(1);
        let depths = later().map(|m| (m.time, m.peak.position[2])).collect();
        depth.add(format!("depth, {name}"), color, Style::LineAndDots, depths);
        let radii = later().map(|m| (m.time, m.radius)).collect();
        depth.add(format!("contact radius, {name}"), color, Style::Line, radii);
        let over = later().map(|m| (m.time, m.peak.position[2] / m.radius)).collect();
        relative.add(*name, color, Style::LineAndDots, over);
    }
    depth.save(args.output.join("depth.png"))?;
    relative.save(args.output.join("relative.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
