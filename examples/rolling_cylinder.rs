//! A cylinder rolling over a standard linear solid, in plane strain: how the pressure skews, and the friction that comes of it,
//! over four decades of speed: the bell curve.
//!
//! Each speed is computed step by step to its steady state, on a grid that follows the cylinder, and compared with a
//! formulation that has no steps: exponential integrals in a dense system for the steady state itself
//! (`examples/support/scenes/rolling.rs`). The curve is the closed form of S. C. Hunter (J. Appl. Mech. 28, 1961); on it are the steady states
//! as one contact problem each, too.
//!
//! `cargo run --release -p viscocontact --features analytic,data,plot,sliding --example rolling_cylinder`

#[path = "support/scenes/march.rs"]
mod march;
#[path = "support/scenes/rolling.rs"]
mod reference;
mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use march::{March, march};
use reference::RollingCylinder;
use viscocontact::Result;
use viscocontact::analytic;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::sliding::SlidingSweep;

/// A cylinder rolling over a standard solid: pressure and friction at many speeds.
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
    /// Radius of the cylinder [m].
    #[arg(long, default_value_t = 0.02, value_parser = support::positive)]
    radius: f64,
    /// Force on a metre of the cylinder [N/m].
    #[arg(long, default_value_t = 500.0, value_parser = support::positive)]
    load: f64,
    /// Cells on half the width of the contact with the glassy body.
    #[arg(long, default_value_t = 32)]
    cells: usize,
    /// Speeds, evenly spaced on a logarithmic scale.
    #[arg(long, default_value_t = 17)]
    speeds: usize,
    /// Coarse and fast: 12 cells, 7 speeds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/rolling_cylinder")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

/// The steady state at one speed.
struct Rolled {
    /// Positions from the axis of the cylinder [m], and the pressure there [Pa].
    profile: Vec<(f64, f64)>,
    peak: f64,
    width: f64,
    /// Lateral force over normal force.
    friction: f64,
    /// How far it rolled [m], in how many steps, with how many convolutions.
    distance: f64,
    steps: usize,
    convolutions: usize,
}

fn roll(scene: &RollingCylinder, material: &Material, velocity: f64, cells: usize) -> Result<Rolled> {
    let glassy = scene.hertz(scene.glassy).0;
    let relaxed = scene.hertz(scene.glassy + scene.delayed).0;
    let side = glassy / cells as f64;
    // behind the contact the body recovers over v τ; ahead nothing happened yet
    let behind = (5.0 * scene.reach).clamp(4.0 * relaxed, 500.0 * glassy);
    let count = ((behind + 3.0 * relaxed) / side) as usize;
    let grid = Grid::new([count, 1], [count as f64 * side, 1.0])?;
    let axis = 0.5 * grid.lengths()[0] - 2.0 * relaxed;
    let cylinder = Shifted::new(Cylinder::new(scene.radius)?, [axis, 0.0])?;
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&cylinder)
        .material(material.clone())
        .kernel(InfluenceKernel::line(&grid, 10.0 * grid.lengths()[0])?)
        .settings(Settings::default().with_frame(Frame::Indenter))
        .build()?;
    // the bodies pass the whole grid
    let (load, length) = (Load::force(scene.per_length), grid.lengths()[0]);
    let March { steps, convolutions, distance } = march(&mut contact, Axis::X1, velocity, load, (length, 5e-3))?;
    let near = |x: f64| (x - axis).abs() < 1.5 * relaxed;
    let points = contact.pressure().iter().enumerate().map(|(i, &p)| (grid.center(i, 0)[0], p));
    Ok(Rolled {
        profile: points.filter(|(x, _)| near(*x)).map(|(x, p)| (x - axis, p)).collect(),
        peak: contact.fields().max_pressure(),
        width: contact.contact_area() / grid.lengths()[1],
        friction: contact.fields().slope_force(&cylinder)[0] / contact.force(),
        distance,
        steps,
        convolutions,
    })
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let (cells, speeds) = if args.quick { (12, 7) } else { (args.cells, args.speeds) };
    let body = Zener::with_time(args.modulus, args.kelvin_modulus, args.tau)?;
    let material = Material::incompressible(body);
    let mut scene = RollingCylinder {
        radius: args.radius,
        per_length: args.load,
        glassy: 0.25 / args.modulus,
        delayed: 0.25 / args.kelvin_modulus,
        reach: 1.0,
    };
    let (glassy, glassy_peak) = scene.hertz(scene.glassy);
    let (relaxed, relaxed_peak) = scene.hertz(scene.glassy + scene.delayed);
    println!("glassy contact {:.3} mm wide, relaxed {:.3} mm", 2e3 * glassy, 2e3 * relaxed);
    println!(
        "      v [m/s]  v τ/a0   peak [kPa]  error    width [mm]  cells off  friction   error    steps  conv/step"
    );

    let mut table = csv::Writer::from_path(args.output.join("speeds.csv"))?;
    table.write_record([
        "velocity_m_s",
        "reach_over_glassy_half_width",
        "max_pressure_pa",
        "reference_max_pressure_pa",
        "width_m",
        "reference_width_m",
        "friction",
        "reference_friction",
        "steps",
        "convolutions",
        "distance_m",
    ])?;
    let mut computed = Vec::new();
    let mut profiles = Vec::new();
    let progress = support::progress(speeds as u64);
    for k in 0..speeds {
        let ratio = 10f64.powf(-2.0 + 4.0 * k as f64 / (speeds - 1) as f64);
        scene.reach = ratio * glassy;
        let velocity = scene.reach / args.tau;
        let rolled = roll(&scene, &material, velocity, cells)?;
        let steady = scene.steady(500);
        let [behind, ahead] = steady.ends();
        let friction = steady.friction(args.radius);
        progress.suspend(|| {
            println!(
                "{velocity:13.4} {ratio:8.2} {:11.2} {:8.1e} {:12.4} {:9.2} {:10.5} {:8.1e} {:7} {:9.2}",
                rolled.peak * 1e-3,
                rolled.peak / steady.peak() - 1.0,
                rolled.width * 1e3,
                (rolled.width - (ahead - behind)) * cells as f64 / glassy,
                rolled.friction,
                rolled.friction / friction - 1.0,
                rolled.steps,
                rolled.convolutions as f64 / rolled.steps as f64,
            );
        });
        table.serialize((
            velocity,
            ratio,
            rolled.peak,
            steady.peak(),
            rolled.width,
            ahead - behind,
            rolled.friction,
            friction,
            rolled.steps,
            rolled.convolutions,
            rolled.distance,
        ))?;
        computed.push((ratio, rolled.friction));
        if k % (speeds - 1).div_ceil(4).max(1) == 0 {
            let points = rolled.profile.iter().map(|(x, p)| (x * 1e3, p * 1e-3)).collect::<Vec<_>>();
            profiles.push((ratio, points));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    table.flush()?;
    println!("Hertz: relaxed {:.2} kPa, glassy {:.2} kPa", relaxed_peak * 1e-3, glassy_peak * 1e-3);

    let finely = (0..=80).map(|k| 10f64.powf(-2.0 + 0.05 * f64::from(k)));
    let exact = finely.map(|ratio| {
        let compliances = [scene.glassy, scene.delayed];
        Ok((ratio, analytic::RollingCylinder::new(args.radius, compliances, args.load, ratio * glassy)?.friction))
    });
    let exact = exact.collect::<Result<Vec<_>>>()?;
    let grid = Grid::new([16 * cells, 1], [3.0 * relaxed, 1.0])?;
    let mut roller = ViscoelasticContact::builder(grid.clone())
        .geometry(&Cylinder::new(args.radius)?)
        .material(material)
        .kernel(InfluenceKernel::line(&grid, 1.0)?)
        .build_sliding()?;
    let velocities = (0..=20).map(|k| [10f64.powf(-2.0 + 0.2 * f64::from(k)) * glassy / args.tau, 0.0]);
    let table = roller.sweep(&SlidingSweep::new(velocities, [Load::force(args.load)]))?;
    let states =
        table.states().iter().map(|state| (state.report.velocity[0] * args.tau / glassy, state.report.friction()));
    let states: Vec<_> = states.collect();
    let mut chart = Chart::new(
        "Hysteretic friction of a rolling cylinder",
        "v τ / half the width of the glassy contact",
        "lateral over normal force",
        Legend::UpperLeft,
    );
    chart.scale = Scale::LogX;
    chart.add("Hunter 1961", COLORS[0], Style::Line, exact);
    chart.add("one problem a speed", COLORS[2], Style::Dots, states);
    chart.add("by steps", COLORS[1], Style::Dots, computed);
    chart.save(args.output.join("friction.png"))?;
    let mut chart = Chart::new(
        "Pressure under a cylinder that rolls to the right",
        "distance from the axis [mm]",
        "pressure [kPa]",
        Legend::UpperLeft,
    );
    chart.add_family("v τ / half the width of the glassy contact", Style::Line, profiles);
    chart.save(args.output.join("pressure.png"))?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}
