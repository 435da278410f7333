//! Three flat punches and a sphere on one viscoelastic body, each with a force of its own: several rigid indenters that feel
//! each other through the surface, one of the two systems that the source paper builds on.
//!
//! * Under forces that are held, no contact shrinks, and the approaches of all four are those of an elastic body of
//!   compliance C(t) (correspondence principle). What the others add to the approach of each stands beside the sum of
//!   lone indenters: the closed forms of what they would displace at its centre.
//! * The punches carry a heavy force in turn. As long as their faces stay in contact all over, they are a linear system,
//!   ω_i(t) = Σ_j S_ij ∫ C(t − s) dW_j(s), with the S_ij of an elastic body. A sphere between them is under a constant
//!   force; its centre of pressure moves away from the punch whose turn it is.
//!
//! `cargo run --release -p viscocontact --features plot --example several_indenters`

#[path = "support/scenes/indenters.rs"]
mod indenters;
mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use indenters::{ClosedFaces, Indenters, SPHERE};
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Style};
use viscocontact::prelude::*;

/// Three punches and a sphere on a standard solid: held forces, and forces in turn.
#[derive(Parser)]
struct Args {
    /// Glassy shear modulus of the incompressible body [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    modulus: f64,
    /// Shear modulus of the Kelvin-Voigt element [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    kelvin_modulus: f64,
    /// Retardation time [s].
    #[arg(long, default_value_t = 1.0)]
    tau: f64,
    /// Radius of the punches [m].
    #[arg(long, default_value_t = 0.3e-3)]
    punch: f64,
    /// Radius of the sphere [m].
    #[arg(long, default_value_t = 10.0e-3)]
    sphere: f64,
    /// Distance of the punches from the sphere [m].
    #[arg(long, default_value_t = 1.0e-3)]
    distance: f64,
    /// Force on a punch; a quarter of it while another takes its turn [N].
    #[arg(long, default_value_t = 0.05)]
    load: f64,
    /// Force on the sphere [N].
    #[arg(long, default_value_t = 0.02)]
    sphere_load: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 192)]
    cells: usize,
    /// Steps in a retardation time.
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..))]
    steps: u32,
    /// Coarse and fast: 64 cells, 10 steps.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/several_indenters")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (64, 10);
    }
    support::finish(run(&args));
}

const NAMES: [&str; 4] = ["left punch", "right punch", "upper punch", "sphere"];
/// Retardation times for which the forces are held, and turns, each of one retardation time.
const HELD: u32 = 4;
const TURNS: u32 = 6;

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let Args { punch, sphere, distance, cells, .. } = *args;
    let scene = Indenters { punch, sphere, distance, cells };
    let body = Zener::with_time(args.modulus, args.kelvin_modulus, args.tau)?;
    let material = Material::incompressible(body);
    held(args, &scene, &material)?;
    in_turn(args, &scene, &material)?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// Approach of a body [m].
fn approach(contact: &ViscoelasticContact, body: usize) -> f64 {
    contact.fields().body(body).map_or(f64::NAN, |body| body.approach)
}

/// All forces jump at t = 0 and are held.
fn held(args: &Args, scene: &Indenters, material: &Material) -> Result<(), Box<dyn Error>> {
    let forces = [args.load, args.load, args.load, args.sphere_load];
    let loads = forces.map(Load::force);
    let mut contact = scene.on(material, 4)?;
    println!("held forces, {}² cells, {} steps a retardation time", args.cells, args.steps);
    println!(
        "{:>5} {:>12} {:>15} {:>9} {:>8} {:>9} {:>12}",
        "t / τ", "body", "approach [µm]", "exact", "error", "by others", "sum of lone"
    );
    let mut table = csv::Writer::from_path(args.output.join("held.csv"))?;
    table.write_record(["time_s", "body", "approach_m", "exact_m", "by_others_m", "sum_of_lone_m"])?;
    let progress = support::progress(u64::from(HELD * args.steps) + 1);
    for k in 0..=HELD * args.steps {
        progress.inc(1);
        let dt = if k == 0 { 0.0 } else { args.tau / f64::from(args.steps) };
        contact.step(dt, loads)?;
        if ![0, args.steps, HELD * args.steps].contains(&k) {
            continue;
        }
        let (time, compliance) = (contact.time(), material.contact_compliance(contact.time()));
        let elastic = scene.elastic(compliance, &forces)?;
        for (body, name) in NAMES.iter().enumerate() {
            let [computed, exact] = [&contact, &elastic].map(|contact| approach(contact, body));
            // what the others add, by the same cells, and if each were alone
            let by_others = computed - scene.approach_alone(body, forces[body], compliance)?;
            let own = scene.alone(body, forces[body], compliance, 0.0);
            let sum = scene.sum_of_lone(scene.center(body), &forces, compliance) - own;
            progress.suspend(|| {
                println!(
                    "{:5.1} {name:>12} {:15.4} {:9.4} {:8.1e} {:9.4} {:12.4}",
                    time / args.tau,
                    1e6 * computed,
                    1e6 * exact,
                    computed / exact - 1.0,
                    1e6 * by_others,
                    1e6 * sum
                )
            });
            table.serialize((time, name, computed, exact, by_others, sum))?;
        }
    }
    table.flush()?;
    let mut map = Map::of(&contact, Field::Pressure)?;
    map.title = format!("Three punches and a sphere, t = {HELD} τ");
    // the rims are singular: the scale ends where the map is still legible
    map.range[1] = 2.0 * args.load / (std::f64::consts::PI * args.punch * args.punch);
    map.save(args.output.join("pressure.png"))?;
    surface(args, scene, &contact, &forces, material.contact_compliance(contact.time()))
}

/// The surface along the line through two punches and the sphere, beside the sum of what each would do alone.
fn surface(
    args: &Args,
    scene: &Indenters,
    contact: &ViscoelasticContact,
    forces: &[f64],
    compliance: f64,
) -> Result<(), Box<dyn Error>> {
    let line = contact.fields().profile(Axis::X1, 0.0)?;
    let mut chart = Chart::new(
        format!("Surface through two punches and the sphere, t = {HELD} τ"),
        Quantity::new("x1", "m"),
        Quantity::new("height of the surface", "m"),
        Legend::LowerMiddle,
    );
    let sum = line.positions.iter().map(|&x| (x, -scene.sum_of_lone([x, line.at], forces, compliance))).collect();
    chart.add("sum of lone indenters", COLORS[1], Style::Line, sum);
    let computed = line.positions.iter().zip(&line.displacement).map(|(&x, &u)| (x, -u)).collect();
    chart.add("together", COLORS[0], Style::Line, computed);
    Ok(chart.save(args.output.join("surface.png"))?)
}

/// The punches carry the heavy force in turn; first alone, then with the sphere between them under a constant force.
fn in_turn(args: &Args, scene: &Indenters, material: &Material) -> Result<(), Box<dyn Error>> {
    let rest = 0.25 * args.load;
    let forces_of = |turn: u32| [0, 1, 2].map(|body| if body == turn % 3 { args.load } else { rest });
    let faces = ClosedFaces::new(scene, rest, args.load)?;
    println!("\nforces in turn\n{:>5} {:>15} {:>9} {:>8}", "t / τ", "approach [µm]", "exact", "error");
    let mut table = csv::Writer::from_path(args.output.join("turns.csv"))?;
    table.write_record(["time_s", "punch", "approach_m", "exact_m"])?;
    let mut punches = scene.on(material, 3)?;
    let mut four = scene.on(material, 4)?;
    let mut jumps: Vec<(f64, [f64; 3])> = Vec::new();
    let (mut exact_curves, mut dots) = ([const { Vec::new() }; 3], Vec::new());
    let mut centers = [const { Vec::new() }; 2];
    let mut before = [0.0; 3];
    let progress = support::progress(u64::from(TURNS));
    for turn in 0..TURNS {
        progress.inc(1);
        let forces = forces_of(turn);
        jumps.push((punches.time(), [0, 1, 2].map(|body| forces[body] - before[body])));
        before = forces;
        let loads = [forces[0], forces[1], forces[2], args.sphere_load].map(Load::force);
        for k in 0..=args.steps {
            let dt = if k == 0 { 0.0 } else { args.tau / f64::from(args.steps) };
            punches.step(dt, &loads[..3])?;
            four.step(dt, loads)?;
            let time = punches.time();
            let exact = faces.approaches(material, &jumps, time);
            for body in 0..3 {
                let computed = approach(&punches, body);
                exact_curves[body].push((time / args.tau, 1e6 * exact[body]));
                if k % (args.steps / 5).max(1) == 0 {
                    dots.push((time / args.tau, 1e6 * computed));
                }
                table.serialize((time, body, computed, exact[body]))?;
                if body == turn as usize % 3 && k == args.steps {
                    progress.suspend(|| {
                        println!(
                            "{:5.1} {:15.4} {:9.4} {:8.1e}",
                            time / args.tau,
                            1e6 * computed,
                            1e6 * exact[body],
                            computed / exact[body] - 1.0
                        )
                    });
                }
            }
            let sphere = four.fields().body(SPHERE).ok_or("the sphere is the last of four bodies")?;
            for (axis, path) in centers.iter_mut().enumerate() {
                path.push((time / args.tau, 1e6 * sphere.moment[axis] / sphere.force));
            }
        }
    }
    table.flush()?;
    let mut chart = Chart::new("Three punches pressed in turn", "t / τ", "approach [µm]", Legend::LowerRight);
    for (body, curve) in exact_curves.into_iter().enumerate() {
        chart.add(NAMES[body], COLORS[body], Style::Line, curve);
    }
    chart.add("computed", COLORS[6], Style::Dots, dots);
    chart.save(args.output.join("turns.png"))?;
    let title = "Centre of pressure of the sphere while the punches are pressed in turn";
    let mut chart = Chart::new(title, "t / τ", "from the middle of the sphere [µm]", Legend::UpperRight);
    for (path, (name, color)) in centers.into_iter().zip([("along x1", COLORS[0]), ("along x2", COLORS[1])]) {
        chart.add(name, color, Style::Line, path);
    }
    Ok(chart.save(args.output.join("sphere.png"))?)
}
