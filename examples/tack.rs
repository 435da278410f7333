//! Tack: a probe is pressed on a layer of gel bonded to glass, held, and pulled off at several speeds: force over displacement, and the work
//! of separation.
//!
//! Bonded gel cannot flow in under a flat probe: a slow pull separates it from its edge, a fast one from its middle too. A ball separates from
//! its edge. The gel loses most at the speeds at which it relaxes while it separates; at greater speeds it is an elastic body again, a
//! stiffer one. The apparent work of separation is the work of the pull from the last zero of the force on.
//!
//! `cargo run --release -p viscocontact --features adhesion,layers,plot --example tack`

mod support;

use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::plot::{COLORS, Chart, Legend, Map, Quantity, Scale, Style, measure};
use viscocontact::prelude::*;

/// A flat probe and a ball pulled off a layer of gel.
#[derive(Parser)]
struct Args {
    /// Thickness of the layer [m].
    #[arg(long, default_value_t = 0.5e-3, value_parser = support::positive)]
    thickness: f64,
    /// Radius of the flat probe; the ball's is four times as long [m].
    #[arg(long, default_value_t = 1.0e-3, value_parser = support::positive)]
    radius: f64,
    /// Relaxed contact modulus E* of the gel [Pa].
    #[arg(long, default_value_t = 4.0e4, value_parser = support::positive)]
    modulus: f64,
    /// Contact modulus at once over the relaxed one.
    #[arg(long, default_value_t = 4.0, value_parser = support::positive)]
    ratio: f64,
    /// Relaxation time [s].
    #[arg(long, default_value_t = 1.0, value_parser = support::positive)]
    tau: f64,
    /// Work of separation [J/m²].
    #[arg(long, default_value_t = 0.1, value_parser = support::positive)]
    work: f64,
    /// Range of the attraction [m].
    #[arg(long, default_value_t = 18.0e-6, value_parser = support::positive)]
    range: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Fewer cells, speeds and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/tack")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

/// A pull: displacement from the held position \[m\], force \[N\] and contact area \[m²\] of each step, and the contact at the greatest pull.
struct Pull {
    path: Vec<[f64; 3]>,
    strongest: ViscoelasticContact,
}

/// Pulls at `speed` with steps of at most `longest` \[m\] until the bodies are apart; a seventh as long while the pull is near
/// its greatest.
fn pull(held: &ViscoelasticContact, speed: f64, longest: f64) -> viscocontact::Result<Pull> {
    let (mut contact, mut strongest, start) = (held.clone(), held.clone(), held.approach());
    let mut path = vec![[0.0, contact.force(), contact.contact_area()]];
    let (mut moved, mut step) = (0.0, 0.1 * longest);
    loop {
        moved += step;
        let report = contact.step(step / speed, Load::approach(start - moved))?;
        path.push([moved, report.force, contact.contact_area()]);
        if report.force < strongest.force() {
            strongest.clone_from(&contact);
        }
        if contact.is_separated() {
            return Ok(Pull { path, strongest });
        }
        let near_greatest = report.force < 0.7 * strongest.force();
        step = (1.1 * step).min(if near_greatest { 0.15 * longest } else { longest });
    }
}

/// The work of a pull from the last zero of the force on \[J\].
fn work_of(path: &[[f64; 3]]) -> f64 {
    let trapezia = path.windows(2).filter(|pair| pair[1][1] < 0.0);
    trapezia.map(|pair| -0.5 * (pair[0][1].min(0.0) + pair[1][1]) * (pair[1][0] - pair[0][0])).sum()
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let (cells, every) = if args.quick { (96, 4) } else { (args.cells, 1) };
    let grid = Grid::square(cells, 3.0 * args.radius)?;
    let shear = 0.25 * args.modulus;
    let gel = Material::incompressible(GeneralizedMaxwell::new(shear, &[(shear * (args.ratio - 1.0), args.tau)])?);
    let law = ExponentialAttraction::new(args.work, args.range)?;
    println!(
        "{:.1} cells in the zone of the attraction on the relaxed gel",
        args.modulus * args.range.powi(2) / args.work / grid.spacing()[0]
    );
    let kernel = Arc::new(InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(args.thickness, 0.5)?)?);
    let probes: [(&str, Box<dyn Geometry>); 2] = [
        ("flat probe", Box::new(FlatPunch::circular(args.radius)?)),
        ("ball", Box::new(Sphere::new(4.0 * args.radius)?)),
    ];
    let exponents: Vec<i32> = (-6..=6).step_by(every).collect();
    let mut table = csv::Writer::from_path(args.output.join("pulls.csv"))?;
    table.write_record(["probe", "speed_m_s", "displacement_m", "force_n", "contact_area_m2"])?;
    let mut works = Chart::new(
        "Work of separation for each unit of the contact area",
        Quantity::new("speed", "m/s"),
        "work of separation / w",
        Legend::UpperLeft,
    );
    works.scale = Scale::LogX;
    let progress = support::progress(2 * exponents.len() as u64);
    for (n, (name, probe)) in probes.into_iter().enumerate() {
        let mut held = ViscoelasticContact::builder(grid.clone())
            .geometry(&*probe)
            .material(gel.clone())
            .kernel(Arc::clone(&kernel))
            .attraction(law)
            .settings(Settings::default().with_symmetry(true))
            .build()?;
        let depth = 0.04 * args.thickness;
        for _ in 0..3 {
            held.step(1.0e3 * args.tau, Load::approach(depth))?;
        }
        let area = held.contact_area();
        let mut forces = Chart::new(
            format!("A {name} is pulled off a gel"),
            Quantity::new("displacement", "m"),
            Quantity::new("force", "N"),
            Legend::LowerRight,
        );
        let (mut apparent, mut maps, mut curves) = (Vec::new(), Vec::new(), Vec::new());
        for &exponent in &exponents {
            let speed = 10f64.powf(f64::from(exponent) / 3.0) * args.range / args.tau;
            let Pull { path, strongest } = pull(&held, speed, 0.2 * args.range)?;
            let work = work_of(&path) / area;
            for [moved, force, area] in &path {
                table.serialize((name, speed, moved, force, area))?;
            }
            progress.suspend(|| {
                let pull = -1e3 * strongest.force();
                println!(
                    "{name}, {}: maximum pull {pull:.2} mN, work of separation {:.2} w",
                    measure(speed, "m/s"),
                    work / args.work
                );
            });
            apparent.push((speed, work / args.work));
            if exponent % 3 == 0 || args.quick {
                curves.push((speed, path.iter().map(|point| (point[0], point[1])).collect()));
            }
            if [exponents.first(), exponents.last()].contains(&Some(&exponent)) {
                let mut map = Map::of(&strongest, Field::Traction)?;
                map.title = format!("{name}, {}: maximum pull", measure(speed, "m/s"));
                map.range = [-args.work / args.range, 0.0];
                maps.push(map);
            }
            progress.inc(1);
        }
        forces.add_family(Quantity::new("speed", "m/s"), Style::Line, curves);
        works.add(name, COLORS[n], Style::LineAndDots, apparent);
        let file = name.replace(' ', "_");
        forces.save(args.output.join(format!("{file}.png")))?;
        Map::draw_row(&maps)?.save(args.output.join(format!("{file}_traction.png")))?;
        println!(
            "{name}: held on {:.3} mm² ({:.2} of the probe's section)",
            1e6 * area,
            area / (PI * args.radius.powi(2))
        );
    }
    progress.finish_and_clear();
    table.flush()?;
    works.save(args.output.join("work.png"))?;
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}
