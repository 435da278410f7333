//! A ball strikes a creeping body at an angle: how fast it leaves along the normal and along the surface, over the angle.
//!
//! The elastic curve is that of Maw, Barber and Fawcett (Wear 38, 1976): steep impacts stick and spring back along the surface,
//! flat ones slide throughout. The ball meets elastic states with friction by displacements in both directions, so that it slides
//! where it has to; the equations of motion are integrated by the leapfrog rule.
//!
//! `cargo run --release -p viscocontact-coupling --bin oblique`

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Style};
use viscocontact::prelude::*;

/// A ball strikes a creeping body at an angle.
#[derive(Parser)]
struct Args {
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 10.0e-3)]
    radius: f64,
    /// Its mass [kg].
    #[arg(long, default_value_t = 0.03)]
    mass: f64,
    /// Its velocity along the normal [m/s].
    #[arg(long, default_value_t = 0.3)]
    velocity: f64,
    /// Shear modulus of the body at once [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    modulus: f64,
    /// Coefficient of friction.
    #[arg(long, default_value_t = 0.3)]
    friction: f64,
    /// Steps in an impact, about.
    #[arg(long, default_value_t = 600)]
    steps: usize,
    /// Fewer angles.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/oblique")]
    output: PathBuf,
}

fn main() -> Result<(), Box<dyn Error>> {
    run(&Args::parse())
}

/// Velocities of the surface of the ball after the impact, along the normal and along the surface, over those before; that
/// along the surface over that along the normal before.
fn strike(args: &Args, body: &Material, slope: f64) -> viscocontact::Result<[f64; 2]> {
    let mut contact =
        StatesContact::new(&ElasticStates::sphere(args.radius)?, body)?.with_estimated_friction(args.friction)?;
    // duration of an elastic impact (Johnson, Contact Mechanics, 11.4) on a contact modulus 4 G
    let modulus = 4.0 * args.modulus;
    let duration = 2.87 * (args.mass.powi(2) / (args.radius * modulus.powi(2) * args.velocity)).powf(0.2);
    let dt = duration / args.steps as f64;
    let before = [args.velocity, slope * args.velocity];
    let (mut place, mut velocity, mut force) = ([0.0; 2], before, [0.0; 2]);
    // a solid ball turns as well: 1/m + R²/I = 7/(2 m)
    let inverse = [1.0 / args.mass, 3.5 / args.mass];
    for step in 0..20 * args.steps {
        for axis in 0..2 {
            velocity[axis] -= 0.5 * dt * inverse[axis] * force[axis];
            place[axis] += dt * velocity[axis];
        }
        contact.step_sheared(dt, Load::approach(place[0]), Load::approach(place[1]))?;
        force = [contact.force(), contact.lateral_force()];
        (0..2).for_each(|axis| velocity[axis] -= 0.5 * dt * inverse[axis] * force[axis]);
        if step > 0 && contact.is_separated() {
            break;
        }
    }
    Ok([-velocity[0] / before[0], -velocity[1] / before[1]])
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let creeping = |time: f64| {
        let parts = [(0.75 * args.modulus, time)];
        GeneralizedMaxwell::new(0.25 * args.modulus, &parts).map(Material::incompressible)
    };
    let bodies = [
        ("elastic", Material::incompressible(Elastic::new(args.modulus)?)),
        ("relaxes in 30 ms", creeping(30.0e-3)?),
        ("relaxes in 3 ms", creeping(3.0e-3)?),
    ];
    let axis = "velocity along the surface over f times that along the normal";
    let mut along = Chart::new("Oblique impact", axis, "restitution along the surface", Legend::UpperRight);
    let mut normal = Chart::new("Oblique impact", axis, "restitution along the normal", Legend::LowerRight);
    let mut table = csv::Writer::from_path(args.output.join("impacts.csv"))?;
    table.write_record(["body", "slope over f", "restitution along the normal", "restitution along the surface"])?;
    let count = if args.quick { 16 } else { 64 };
    for (n, (name, body)) in bodies.iter().enumerate() {
        let (mut normals, mut alongs) = (Vec::new(), Vec::new());
        for k in 1..=count {
            let slope = 8.0 * f64::from(k) / f64::from(count);
            let [by_normal, by_surface] = strike(args, body, slope * args.friction)?;
            table.serialize((name, slope, by_normal, by_surface))?;
            normals.push((slope, by_normal));
            alongs.push((slope, by_surface));
        }
        // an impact that slides throughout loses (7/2) f (1 + e) of its velocity along the surface
        let (slope, found) = alongs[alongs.len() - 1];
        let slides = 3.5 * (1.0 + normals[normals.len() - 1].1) / slope - 1.0;
        println!(
            "{name}: restitution {:.4}; along the surface at most {:.4}; at the flattest angle {found:.4}, if it slides throughout {slides:.4}",
            normals[0].1,
            alongs.iter().map(|point| point.1).fold(f64::MIN, f64::max)
        );
        along.add(*name, COLORS[n], Style::Line, alongs);
        normal.add(*name, COLORS[n], Style::Line, normals);
    }
    table.flush()?;
    along.save(args.output.join("along.png"))?;
    normal.save(args.output.join("normal.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
