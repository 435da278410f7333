//! A sphere sliding without friction over a standard linear solid: what the creep of the solid alone resists with.
//!
//! 1. Steady sliding at many speeds, on a grid that goes with the sphere: the friction coefficient over speed.
//! 2. A start from rest, a stop and the way back, on a grid that stays with the solid: how friction builds up over a
//!    length of contact, and how the sphere sinks in while it rests and climbs when it moves.
//!
//! `cargo run --release -p viscocontact --features motion,plot --example sliding_sphere`

#[path = "support/scenes/march.rs"]
mod march;
mod support;

use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::{Path as File, PathBuf};

use clap::Parser;
use march::march;
use viscocontact::Result;
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Scale, Style};
use viscocontact::prelude::*;

/// A sphere sliding over a standard solid.
#[derive(Parser)]
struct Args {
    /// Glassy shear modulus [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    modulus: f64,
    /// Shear modulus of the Kelvin-Voigt element [Pa].
    #[arg(long, default_value_t = 0.5e6)]
    kelvin_modulus: f64,
    /// Retardation time [s].
    #[arg(long, default_value_t = 0.01)]
    tau: f64,
    /// Radius of the sphere [m].
    #[arg(long, default_value_t = 0.01, value_parser = support::positive)]
    radius: f64,
    /// Force [N].
    #[arg(long, default_value_t = 0.5, value_parser = support::positive)]
    load: f64,
    /// Cells on the radius of the contact with the glassy solid.
    #[arg(long, default_value_t = 16)]
    cells: usize,
    /// Speeds, evenly spaced on a logarithmic scale.
    #[arg(long, default_value_t = 13)]
    speeds: usize,
    /// Coarse and fast: 6 cells, 5 speeds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/sliding_sphere")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

struct Bodies {
    material: Material,
    radius: f64,
    load: Load,
    tau: f64,
    /// Radii of the contact with the glassy and the relaxed solid [m].
    glassy: f64,
    relaxed: f64,
}

impl Bodies {
    fn new(args: &Args) -> Result<Bodies> {
        let body = Zener::with_time(args.modulus, args.kelvin_modulus, args.tau)?;
        let material = Material::incompressible(body);
        let radius = |t: f64| (0.75 * args.radius * args.load * material.contact_compliance(t)).cbrt();
        let (glassy, relaxed) = (radius(0.0), radius(1e3 * args.tau));
        Ok(Bodies { material, radius: args.radius, load: Load::force(args.load), tau: args.tau, glassy, relaxed })
    }

    /// The steady state at a speed, cells of a given side, and the sphere where it is on the grid.
    fn slide(&self, velocity: f64, side: f64) -> Result<(ViscoelasticContact, Shifted)> {
        // behind, the solid recovers over v τ; displacements farther away matter little
        let behind = (4.0 * velocity * self.tau).clamp(3.0 * self.relaxed, 32.0 * self.relaxed);
        let cells = [behind + 2.0 * self.relaxed, 2.6 * self.relaxed].map(|length| (length / side).ceil() as usize);
        let grid = Grid::new(cells, cells.map(|count| count as f64 * side))?;
        let sphere = Shifted::new(Sphere::new(self.radius)?, [0.5 * grid.lengths()[0] - 1.4 * self.relaxed, 0.0])?;
        let mut contact = ViscoelasticContact::builder(grid)
            .geometry(&sphere)
            .material(self.material.clone())
            .settings(Settings::default().with_frame(Frame::Indenter))
            .build()?;
        // the bodies pass the whole grid
        let length = contact.grid().lengths()[0];
        march(&mut contact, Axis::X1, velocity, self.load, (length, 5e-3))?;
        Ok((contact, sphere))
    }
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let (cells, speeds) = if args.quick { (6, 5) } else { (args.cells, args.speeds) };
    let bodies = Bodies::new(args)?;
    println!("radius of the contact: glassy {:.3} mm, relaxed {:.3} mm", bodies.glassy * 1e3, bodies.relaxed * 1e3);
    steady(&bodies, cells, speeds, &args.output)?;
    there_and_back(&bodies, cells, &args.output)?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// Friction over speed, and the contact where it is greatest.
fn steady(bodies: &Bodies, cells: usize, speeds: usize, output: &File) -> Result<(), Box<dyn Error>> {
    let side = bodies.glassy / cells as f64;
    println!("   v [m/s]   v τ/a0   friction  (cells twice as long)   area/glassy   approach [µm]");
    let mut table = csv::Writer::from_path(output.join("speeds.csv"))?;
    table.write_record(["velocity_m_s", "friction", "friction_on_half_as_many_cells", "area_m2", "approach_m"])?;
    let (mut fine, mut coarse) = (Vec::new(), Vec::new());
    let mut greatest: Option<(f64, ViscoelasticContact, Shifted)> = None;
    let progress = support::progress(speeds as u64);
    for k in 0..speeds {
        let ratio = 10f64.powf(-1.5 + 3.0 * k as f64 / (speeds - 1) as f64);
        let velocity = ratio * bodies.glassy / bodies.tau;
        let friction = |(contact, sphere): &(ViscoelasticContact, Shifted)| {
            contact.fields().slope_force(sphere)[0] / contact.force()
        };
        let slid = bodies.slide(velocity, side)?;
        let (own, other) = (friction(&slid), friction(&bodies.slide(velocity, 2.0 * side)?));
        let (contact, sphere) = slid;
        let area = contact.contact_area();
        progress.suspend(|| {
            let share = area / (PI * bodies.glassy * bodies.glassy);
            println!(
                "{velocity:10.4} {ratio:8.3} {own:10.5} {other:12.5} {share:21.3} {:15.2}",
                contact.approach() * 1e6
            );
        });
        table.serialize((velocity, own, other, area, contact.approach()))?;
        fine.push((ratio, own));
        coarse.push((ratio, other));
        if greatest.as_ref().is_none_or(|(most, ..)| own > *most) {
            greatest = Some((own, contact, sphere));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    table.flush()?;

    let mut chart = Chart::new(
        "Hysteretic friction of a sliding sphere",
        "v τ / radius of the glassy contact",
        "lateral over normal force",
        Legend::UpperLeft,
    );
    chart.scale = Scale::LogX;
    chart.add(format!("{cells} cells on a radius"), COLORS[0], Style::LineAndDots, fine);
    chart.add(format!("{} cells", cells / 2), COLORS[1], Style::Dots, coarse);
    chart.save(output.join("friction.png"))?;

    let Some((friction, contact, _)) = greatest else { return Ok(()) };
    // as many cells before as behind the sphere
    let (grid, [_, n2]) = (contact.grid(), contact.grid().cells());
    let [side, _] = grid.spacing();
    // the sphere is so far from the end of the grid
    let middle = ((grid.lengths()[0] - 1.4 * bodies.relaxed) / side) as usize;
    let reach = (1.3 * bodies.relaxed / side) as usize;
    let part = &contact.pressure()[(middle - reach) * n2..(middle + reach) * n2];
    let around = Grid::new([2 * reach, n2], [2 * reach, n2].map(|cells| cells as f64 * side))?;
    let values = part.iter().map(|&p| if p > 0.0 { p } else { f64::NAN }).collect();
    let mut map = Map::new(&around, values, Quantity::new("pressure", "Pa"))?;
    map.axes[0] = Quantity::new("x1 from the axis of the sphere", "m");
    map.title = format!("A sphere slides to the right, friction {friction:.3}");
    map.save(output.join("pressure.png"))?;
    {
        use viscocontact::output::{Earlier, Field, Format, FrameSeries, Metadata};
        let scene = Metadata::new("Sphere sliding steadily").note("friction", friction.to_string());
        FrameSeries::create(output.join("vtk"), Format::Vtk, &scene, &contact, Field::of(&contact), Earlier::Replace)?
            .record(&contact)?;
    }
    Ok(())
}

/// A start, a stop and the way back.
fn there_and_back(bodies: &Bodies, cells: usize, output: &File) -> Result<(), Box<dyn Error>> {
    // as fast as resists most; four contacts far, at rest for twenty retardation times, and back
    let (velocity, far) = (1.5 * bodies.glassy / bodies.tau, 8.0 * bodies.glassy);
    let (moving, resting) = (far / velocity, 20.0 * bodies.tau);
    let path = move |t: f64| {
        let out = (velocity * t).min(far);
        let back = (velocity * (t - moving - resting)).clamp(0.0, far);
        [out - back - 0.5 * far, 0.0]
    };
    let side = bodies.glassy / (cells / 2).max(4) as f64;
    let counts = [far + 2.6 * bodies.relaxed, 2.6 * bodies.relaxed].map(|length| (length / side).ceil() as usize);
    let grid = Grid::new(counts, counts.map(|count| count as f64 * side))?;
    let travel = Travel::new(Sphere::new(bodies.radius)?, FnPath::new(path));
    let mut contact = ViscoelasticContact::builder(grid)
        .geometry(&travel.shape_at(0.0)?)
        .material(bodies.material.clone())
        .build()?;
    contact.step(0.0, bodies.load)?;
    let scene = viscocontact::output::Metadata::new("Sphere sliding there and back");
    let history = output.join("there_and_back.csv");
    let columns = ["position [m]", "lateral force [N]", "power [W]"];
    let mut table = viscocontact::output::CsvHistory::create(&history, &scene, &contact, &columns, Earlier::Replace)?;
    let (mut friction, mut sinking) = (Vec::new(), Vec::new());
    // two steps a cell while it moves; at rest they may grow
    let step = 0.5 * side / velocity;
    let corners = [moving, moving + resting, 2.0 * moving + resting];
    let progress = support::progress((2.0 * moving / step) as u64 + 60);
    let mut dt = step;
    for (k, &corner) in corners.iter().enumerate() {
        while contact.time() < corner * (1.0 - 1e-12) {
            let next = dt.min(corner - contact.time());
            let report = contact.step_along(&travel, next, bodies.load)?;
            table.record(&contact, &report.step, &[report.position[0], report.lateral_force[0], report.power])?;
            friction.push((report.step.time / bodies.tau, report.lateral_force[0] / report.step.force));
            sinking.push((report.step.time / bodies.tau, report.step.approach * 1e6));
            dt = if k == 1 { dt * 1.2 } else { step };
            progress.inc(1);
        }
        dt = step;
    }
    progress.finish_and_clear();
    let steady = |from: f64, to: f64| {
        let span = friction.iter().filter(|(t, _)| (from..to).contains(&(t * bodies.tau)));
        span.clone().map(|(_, f)| f).sum::<f64>() / span.count() as f64
    };
    println!(
        "there and back at {velocity:.3} m/s: friction {:.4} at the end of the way out, {:.4} at the end of the way back",
        steady(0.8 * moving, moving),
        steady(1.8 * moving + resting, 2.0 * moving + resting)
    );
    let mut chart =
        Chart::new("Start, stop and the way back: friction", "t / τ", "lateral over normal force", Legend::UpperRight);
    chart.add("", COLORS[0], Style::Line, friction);
    chart.save(output.join("start_and_stop.png"))?;
    let mut chart = Chart::new("Start, stop and the way back: approach", "t / τ", "approach [µm]", Legend::UpperRight);
    chart.add("", COLORS[1], Style::Line, sinking);
    chart.save(output.join("sinking.png"))?;
    Ok(())
}
