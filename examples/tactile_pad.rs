//! A tactile pad with ridges is pressed on glass, sheared, held while it creeps, and then twisted: the pressures and tractions that
//! its sensors would see, and how much of it still sticks.
//!
//! The pad is incompressible rubber on a rigid plane, so that normal and tangential loads do not act on each other. Each cell sticks or
//! slips by Coulomb's law; the body is free to turn under its torque.
//!
//! `cargo run --release -p viscocontact --features plot,friction --example tactile_pad`

mod support;

use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::friction::{Coulomb, FrictionContact, Outcome, ShearLoad};
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Style};
use viscocontact::prelude::*;

/// A ridged pad that is pressed, sheared and twisted.
#[derive(Parser)]
struct Args {
    /// Radius of the pad [m].
    #[arg(long, default_value_t = 12.0e-3, value_parser = support::positive)]
    radius: f64,
    /// Distance of its ridges [m].
    #[arg(long, default_value_t = 0.8e-3, value_parser = support::positive)]
    ridges: f64,
    /// Height of its ridges [m].
    #[arg(long, default_value_t = 20.0e-6, value_parser = support::positive)]
    height: f64,
    /// Force that presses it [N].
    #[arg(long, default_value_t = 1.0, value_parser = support::positive)]
    force: f64,
    /// Coefficient of friction.
    #[arg(long, default_value_t = 0.8, value_parser = support::positive)]
    friction: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 96, value_parser = support::at_least_one)]
    cells: usize,
    /// A small grid, for a look.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/tactile_pad")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let grid = Grid::square(if args.quick { 48 } else { args.cells }, 0.6 * args.radius)?;
    let (radius, ridges, height) = (args.radius, args.ridges, args.height);
    let pad = FnGeometry::new(move |x1, x2| {
        0.5 * (x1 * x1 + x2 * x2) / radius + 0.5 * height * (1.0 - (TAU * (x1 + 0.4 * x2) / ridges).cos())
    });
    let rubber = Material::incompressible(GeneralizedMaxwell::new(0.15e6, &[(0.15e6, 0.1), (0.1e6, 3.0)])?);
    let scene = ViscoelasticContact::builder(grid.clone()).geometry(&pad).material(rubber);
    let mut contact = FrictionContact::new(scene, Coulomb::new(args.friction)?)?;
    let (load, limit) = (Load::force(args.force), args.friction * args.force);
    let mut table = csv::Writer::from_path(args.output.join("steps.csv"))?;
    table.write_record(["time [s]", "force [N]", "torque [N m]", "displacement [m]", "angle [rad]", "sticks"])?;
    let mut sticking = Vec::new();
    let mut take = |contact: &mut FrictionContact, dt: f64, shear: ShearLoad| -> Result<(), Box<dyn Error>> {
        match contact.step(dt, load, shear)? {
            Outcome::Holds(_) => {}
            outcome => return Err(format!("the pad slides: {outcome:?}").into()),
        }
        let ([force, _, torque], [shift, _, angle]) = (contact.force(), contact.motion());
        let share = contact.stick_cells() as f64 / contact.normal().contact_cells() as f64;
        table.serialize((contact.normal().time(), force, torque, shift, angle, share))?;
        sticking.push((contact.normal().time(), share));
        Ok(())
    };
    // pressed for a second, sheared within two, held for five, twisted within two
    take(&mut contact, 0.0, ShearLoad::force([0.0; 2]))?;
    (0..5).try_for_each(|_| take(&mut contact, 0.2, ShearLoad::force([0.0; 2])))?;
    (1..=10).try_for_each(|k| take(&mut contact, 0.2, ShearLoad::force([0.07 * f64::from(k) * limit, 0.0])))?;
    let shear = ShearLoad::force([0.7 * limit, 0.0]);
    let sheared = maps(&grid, &contact, "sheared")?;
    (0..5).try_for_each(|_| take(&mut contact, 1.0, shear))?;
    let arm = (contact.normal().contact_area() / std::f64::consts::PI).sqrt();
    (1..=10).try_for_each(|k| take(&mut contact, 0.2, shear.with_torque(0.03 * f64::from(k) * limit * arm)))?;
    table.flush()?;
    let twisted = maps(&grid, &contact, "sheared and twisted")?;
    Map::draw_row(&sheared)?.save(args.output.join("sheared.png"))?;
    Map::draw_row(&twisted)?.save(args.output.join("twisted.png"))?;
    let mut chart = Chart::new(
        "Pressed to 1 s, sheared to 3 s, held to 8 s, twisted to 10 s",
        Quantity::new("time", "s"),
        "stick area / contact area",
        Legend::LowerLeft,
    );
    chart.add("", COLORS[0], Style::LineAndDots, sticking);
    chart.save(args.output.join("sticks.png"))?;
    let work = contact.lateral_work();
    println!(
        "shifted by {:.1} µm and turned by {:.2}°; {:.2} µJ of work along the surface, {:.2} µJ lost by slip",
        1e6 * contact.motion()[0],
        contact.motion()[2].to_degrees(),
        1e6 * work.work,
        1e6 * work.slip
    );
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}

/// Pressure, the size of the traction along the surface, and the slip of the last step.
fn maps(grid: &Grid, contact: &FrictionContact, title: &str) -> viscocontact::Result<[Map; 3]> {
    let size = |[one, two]: [Vec<f64>; 2]| one.iter().zip(&two).map(|(one, two)| one.hypot(*two)).collect();
    let pressure = contact.normal().pressure();
    // blank outside the contact
    let inside = |values: Vec<f64>| -> Vec<f64> {
        values.into_iter().zip(pressure).map(|(value, p)| if *p > 0.0 { value } else { f64::NAN }).collect()
    };
    let mut maps = [
        Map::new(grid, inside(pressure.to_vec()), Quantity::new("pressure", "Pa"))?,
        Map::new(grid, inside(size(contact.traction())), Quantity::new("tangential traction", "Pa"))?,
        Map::new(grid, inside(size(contact.slip())), Quantity::new("slip in the last step", "m"))?,
    ];
    maps.iter_mut().for_each(|map| map.range[0] = 0.0);
    for (map, what) in maps.iter_mut().zip(["pressure", "traction", "slip"]) {
        map.title = format!("{what}, {title}");
    }
    Ok(maps)
}
