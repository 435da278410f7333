//! The source paper's title scene: a flat punch under an eccentric force. First elastic, against Lur'e while
//! the whole face is in contact and beyond, where it opens; then on a creeping body, where the tilt grows
//! with time under a steady force.
//!
//! `cargo run --release -p viscocontact --features analytic,plot --example eccentric_punch`

mod support;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use viscocontact::Result;
use viscocontact::analytic::RigidPunch;
use viscocontact::plot::{COLORS, Chart, Legend, Map, Style};
use viscocontact::prelude::*;

/// A flat circular punch under an eccentric force.
#[derive(Parser)]
struct Args {
    /// Shear modulus [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    modulus: f64,
    /// Relaxation time of the creeping body [s].
    #[arg(long, default_value_t = 1.0)]
    tau: f64,
    /// Force [N].
    #[arg(long, default_value_t = 0.05)]
    load: f64,
    /// Radius of the punch [m].
    #[arg(long, default_value_t = 1.0e-3)]
    radius: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 256)]
    cells: usize,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/eccentric_punch")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        args.cells = 64;
    }
    support::finish(run(&args));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    against_lure(args)?;
    opening(args)?;
    creeping(args)?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

fn punch(args: &Args, material: Material) -> Result<ViscoelasticContact> {
    ViscoelasticContact::builder(Grid::square(args.cells, 2.1 * args.radius)?)
        .geometry(&FlatPunch::circular(args.radius)?)
        .material(material)
        .settings(Settings::default().with_tolerance(1e-7))
        .build()
}

fn elastic(args: &Args) -> Result<ViscoelasticContact> {
    punch(args, Material::incompressible(Elastic::new(args.modulus)?))
}

/// Pressure along x1 for loads within R/3 of the axis, on Lur'e's curves.
fn against_lure(args: &Args) -> Result<(), Box<dyn Error>> {
    println!("closed contact, {}² cells, against Lur'e", args.cells);
    println!("{:>6} {:>14} {:>10} {:>10} {:>13}", "e/R", "p, r < 0.8 R", "approach", "tilt", "convolutions");
    let mut chart = Chart::new(
        "Flat punch under an eccentric force, whole face in contact",
        "x1 / R",
        "p / mean pressure",
        Legend::UpperMiddle,
    );
    let mean = args.load / (std::f64::consts::PI * args.radius * args.radius);
    for (e, color) in [0.0, 0.1, 0.2, 0.3].into_iter().zip(COLORS) {
        let exact = RigidPunch::new(args.radius, 4.0 * args.modulus, args.load, e * args.radius)?;
        let mut contact = elastic(args)?;
        let report = contact.step(0.0, Load::eccentric_force(args.load, [e * args.radius, 0.0]))?;
        let (n, grid) = (args.cells, contact.grid());
        let mut worst: f64 = 0.0;
        for (k, &p) in contact.pressure().iter().enumerate() {
            let [x1, x2] = grid.center(k / n, k % n);
            if x1.hypot(x2) < 0.8 * args.radius {
                worst = worst.max((p / exact.pressure(x1, x2) - 1.0).abs());
            }
        }
        let tilt = if e > 0.0 { contact.tilt()[0] / exact.tilt - 1.0 } else { 0.0 };
        println!(
            "{e:6.2} {worst:14.1e} {:10.1e} {tilt:10.1e} {:13.2}",
            contact.approach() / exact.approach - 1.0,
            report.convolution_equivalents()
        );
        let curve = (-98..=98).map(|k| k as f64 / 100.0);
        let curve = curve.map(|x| (x, exact.pressure(x * args.radius, 0.0) / mean)).collect();
        chart.add(format!("e = {e} R, Lur'e"), color, Style::Line, curve);
        let cells =
            (0..n).step_by(n.div_ceil(48)).map(|i| (grid.center(i, n / 2)[0], contact.pressure()[i * n + n / 2]));
        let dots = cells.filter(|(x, _)| x.abs() < 0.98 * args.radius).map(|(x, p)| (x / args.radius, p / mean));
        chart.add(if e == 0.0 { "computed (dots)" } else { "" }, color, Style::Dots, dots.collect());
    }
    Ok(chart.save(args.output.join("pressure_closed.png"))?)
}

/// Contact fraction and tilt over the eccentricity, and maps of the pressure.
fn opening(args: &Args) -> Result<(), Box<dyn Error>> {
    let face = elastic(args)?.step(0.0, Load::force(args.load))?.contact_cells as f64;
    let unit = 0.75 * args.load / (4.0 * args.modulus * args.radius * args.radius);
    let (mut fraction, mut tilt) = (Vec::new(), Vec::new());
    let mut table = csv::Writer::from_path(args.output.join("opening.csv"))?;
    table.write_record(["eccentricity_over_radius", "contact_fraction", "tilt_rad", "approach_m", "convolutions"])?;
    println!("\nopening contact\n{:>6} {:>9} {:>12} {:>13}", "e/R", "contact", "tilt [rad]", "convolutions");
    let progress = support::progress(19);
    for k in 0..19 {
        let e = 0.05 * k as f64;
        let mut contact = elastic(args)?;
        let report = contact.step(0.0, Load::eccentric_force(args.load, [e * args.radius, 0.0]))?;
        let (share, work) = (report.contact_cells as f64 / face, report.convolution_equivalents());
        table.serialize((e, share, report.tilt[0], report.approach, work))?;
        fraction.push((e, share));
        tilt.push((e, report.tilt[0] / unit));
        if [4, 10, 16].contains(&k) {
            save_map(&contact, args, e, &args.output.join(format!("map_{:02}.png", 5 * k)))?;
        }
        if k % 3 == 0 {
            progress.suspend(|| println!("{e:6.2} {share:9.4} {:12.4e} {work:13.2}", report.tilt[0]));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    table.flush()?;
    let mut chart = Chart::new("The contact opens beyond R/3", "e / R", "fraction of the face", Legend::LowerLeft);
    chart.add("contact area / area of the face", COLORS[0], Style::LineAndDots, fraction);
    chart.save(args.output.join("contact_fraction.png"))?;
    let lure = vec![(0.0, 0.0), (1.0 / 3.0, 1.0 / 3.0)];
    let mut chart = Chart::new("Tilt over eccentricity", "e / R", "tilt / (3W / 4R²E*)", Legend::UpperLeft);
    chart.add("Lur'e, e < R/3", COLORS[1], Style::Line, lure);
    chart.add("computed", COLORS[0], Style::Dots, tilt);
    Ok(chart.save(args.output.join("tilt.png"))?)
}

fn save_map(contact: &ViscoelasticContact, args: &Args, e: f64, path: &Path) -> Result<(), Box<dyn Error>> {
    let mean = args.load / (std::f64::consts::PI * args.radius * args.radius);
    let grid = Grid::new(contact.grid().cells(), contact.grid().lengths().map(|length| length / args.radius))?;
    let values = contact.pressure().iter().map(|&p| if p > 0.0 { p / mean } else { f64::NAN }).collect();
    let mut map = Map::new(&grid, values, "p / mean pressure")?;
    map.title = format!("Load at e = {e:.1} R");
    map.axes = ["x1 / R".into(), "x2 / R".into()];
    // the rim is singular: the scale ends where the map is still legible
    map.range = [0.0, 4.0];
    Ok(map.save(path)?)
}

/// A steady eccentric force on a Maxwell body. Face and load set no length in the depth, so that the pressure does
/// not change, open contact or not, and everything else grows as J(t).
fn creeping(args: &Args) -> Result<(), Box<dyn Error>> {
    let mut tilts = Chart::new(
        "Tilt under a steady eccentric force, Maxwell body",
        "t / τ",
        "tilt / tilt at t = 0",
        Legend::UpperLeft,
    );
    let mut table = csv::Writer::from_path(args.output.join("creep.csv"))?;
    table.write_record(["eccentricity_over_radius", "time_s", "tilt_rad", "approach_m", "contact_cells"])?;
    println!("\ncreeping, 40 steps to 4 τ");
    for (e, color) in [0.2, 0.5, 0.8].into_iter().zip(COLORS) {
        let body = Maxwell::with_time(args.modulus, args.tau)?;
        let mut contact = punch(args, Material::incompressible(body))?;
        let load = Load::eccentric_force(args.load, [e * args.radius, 0.0]);
        let history = StepLoad::new(load)?;
        let (mut points, mut work, mut steps) = (Vec::new(), 0.0, 0);
        let mut run = contact.follow(&history, Stepping::fixed(0.1 * args.tau), 4.0 * args.tau);
        while let Some(report) = run.next_step()? {
            table.serialize((e, report.time, report.tilt[0], report.approach, report.contact_cells))?;
            points.push((report.time / args.tau, report.tilt[0]));
            work += report.convolution_equivalents();
            steps += 1;
        }
        let first = points[0].1;
        let growth = points[points.len() - 1].1 / first;
        println!("e = {e} R: tilt grows {growth:.4} times, {:.2} convolutions a step", work / f64::from(steps));
        let curve = points.into_iter().map(|(t, tilt)| (t, tilt / first)).collect();
        tilts.add(format!("e = {e} R"), color, Style::LineAndDots, curve);
    }
    tilts.add("J(t) / J(0)", COLORS[6], Style::Line, vec![(0.0, 1.0), (4.0, 5.0)]);
    table.flush()?;
    Ok(tilts.save(args.output.join("tilt_creep.png"))?)
}
