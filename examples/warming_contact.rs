//! A steel ball pressed on a rubber seal in the cold, near the glass transition of the rubber, under a constant force: the
//! seal warms up, and the contact grows as the rubber softens. Beside it the same ball on a seal that stays cold, and on one
//! that stays in between; over the reduced time ξ = ∫ dt/a_T all three are one, that of Lee & Radok's growing sphere.
//!
//! `cargo run --release -p viscocontact --features plot,temperature --example warming_contact`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};

/// A seal that warms up under a ball.
#[derive(Parser)]
struct Args {
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 5.0e-3)]
    radius: f64,
    /// Force [N].
    #[arg(long, default_value_t = 5.0)]
    load: f64,
    /// Temperatures of the cold and of the warm seal [°C].
    #[arg(long, default_value_t = -18.0, allow_hyphen_values = true)]
    cold: f64,
    #[arg(long, default_value_t = 20.0, allow_hyphen_values = true)]
    warm: f64,
    /// A temperature in between at which another seal stays [°C].
    #[arg(long, default_value_t = -5.0, allow_hyphen_values = true)]
    cool: f64,
    /// When the warming begins and ends [s]; the run is half as long again.
    #[arg(long, default_value_t = 600.0)]
    begins: f64,
    #[arg(long, default_value_t = 3000.0)]
    ends: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 192)]
    cells: usize,
    /// Tolerance of the steps.
    #[arg(long, default_value_t = 1.0e-4)]
    tolerance: f64,
    /// Few cells.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and pictures.
    #[arg(long, default_value = "out/warming_contact")]
    output: PathBuf,
}

/// 0 °C [K].
const FREEZING: f64 = 273.15;

fn main() {
    support::finish(run(&Args::parse()));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    // a fluoroelastomer: glassy 800 MPa, relaxed 2 MPa, glass transition at -18 °C, the WLF constants of many polymers
    let rubber = FractionalZener::new(800.0e6, 2.0e6, 2.0e4, 0.5)?;
    let material = Material::incompressible(rubber);
    let law = TimeTemperature::wlf(17.44, 51.6, FREEZING - 18.0)?;
    let [cold, warm, cool] = [args.cold, args.warm, args.cool].map(|celsius| FREEZING + celsius);
    let (until, cells) = (1.5 * args.ends, if args.quick { 48 } else { args.cells });

    // a growing contact equals the contact of an elastic body as soft as the creeping body is now (Lee & Radok 1960)
    let approach = |xi: f64| {
        let contact_radius = (0.75 * args.radius * args.load * material.contact_compliance(xi)).cbrt();
        contact_radius * contact_radius / args.radius
    };
    let relaxed = 1.0e12;
    let grid = Grid::square(cells, 2.4 * (args.radius * approach(relaxed)).sqrt())?;
    let load = StepLoad::new(Load::force(args.load))?;

    let time = "time [min]";
    let mut areas = Chart::new("Contact area of a ball on a seal", time, "contact area [mm²]", Legend::UpperLeft);
    let mut depths = Chart::new("Approach of a ball to a seal", time, "approach [mm]", Legend::UpperLeft);
    let mut temperatures = Chart::new("Temperature of the seal", time, "temperature [°C]", Legend::UpperLeft);
    let mut reduced =
        Chart::new("Contact area over the reduced time", "reduced time [s]", "contact area [mm²]", Legend::UpperLeft);
    reduced.scale = Scale::LogX;
    let mut table = csv::Writer::from_path(args.output.join("seal.csv"))?;
    table.write_record(["seal", "time_s", "temperature_k", "reduced_time_s", "area_m2", "approach_m"])?;

    let courses = [
        (format!("stays at {} °C", args.cold), vec![(0.0, cold)]),
        (format!("warms up to {} °C", args.warm), vec![(args.begins, cold), (args.ends, warm)]),
        (format!("stays at {} °C", args.cool), vec![(0.0, cool)]),
    ];
    let progress = support::progress(3 * 100);
    for (n, (name, course)) in courses.into_iter().enumerate() {
        let temperature = TemperatureHistory::table(law.clone(), &course)?;
        let mut contact = ViscoelasticContact::builder(grid.clone())
            .geometry(&Sphere::new(args.radius)?)
            .material(material.clone())
            .temperature(temperature.clone())
            // reduced times
            .times(1.0e-2..=1.0e12)
            .build()?;
        // the curves go through states within the steps, which are as long as their error allows
        let mut follow =
            contact.follow(&load, Stepping::adaptive(args.tolerance), until).sample_at(Times::every(until / 60.0))?;
        let (mut area, mut depth, mut course, mut collapsed) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut steps, mut error) = (0, 0.0);
        while let Some(report) = follow.next_step()? {
            progress.set_position((100.0 * (n as f64 + report.time / until)) as u64);
            steps += 1;
            for sample in follow.samples() {
                let sample = sample?;
                let contact = sample.contact();
                let (t, xi) = (contact.time(), contact.reduced_time());
                let (now, minutes) = (temperature.at(t), t / 60.0);
                area.push((minutes, 1e6 * contact.contact_area()));
                depth.push((minutes, 1e3 * contact.approach()));
                course.push((minutes, now - FREEZING));
                collapsed.extend((xi > 1.0).then_some((xi, 1e6 * contact.contact_area())));
                error = contact.approach() / approach(xi) - 1.0;
                table.serialize((&name, t, now, xi, contact.contact_area(), contact.approach()))?;
            }
        }
        progress.suspend(|| println!(
            "{name}: contact area {:.3} mm² at first, {:.3} mm² at the end, after {:.1e} s at the reference temperature; \
             {steps} steps, approach over Lee & Radok's {error:+.1e}",
            area[0].1,
            1e6 * contact.contact_area(),
            contact.reduced_time()
        ));
        areas.add(name.clone(), COLORS[n], Style::Line, area);
        depths.add(name.clone(), COLORS[n], Style::Line, depth);
        temperatures.add(name.clone(), COLORS[n], Style::Line, course);
        let thinned = collapsed.iter().step_by((collapsed.len() / 30).max(1)).copied().collect();
        reduced.add(name, COLORS[n], Style::Dots, thinned);
    }
    table.flush()?;
    let closed_form: Vec<(f64, f64)> = (0..=130)
        .map(|k| 10_f64.powf(f64::from(k) / 12.0))
        .map(|xi| (xi, 1e6 * std::f64::consts::PI * args.radius * approach(xi)))
        .collect();
    reduced.add("closed form (Lee & Radok)", COLORS[3], Style::Line, closed_form);
    areas.save(args.output.join("area.png"))?;
    depths.save(args.output.join("approach.png"))?;
    temperatures.save(args.output.join("temperature.png"))?;
    reduced.save(args.output.join("reduced.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
