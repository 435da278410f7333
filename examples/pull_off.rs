//! A ball that sticks to a creeping body: it rests until the body has relaxed, and is pulled off at speeds over five decades.
//!
//! Slowly pulled, the ball separates as from an elastic body of the relaxed modulus E*. At once the body is k times as stiff. A fast
//! pull finds the stiff body in the shape that the pressure p₀ gave it at rest, at the approach ω₀ and the relaxed compliance C.
//! Where the bodies still touch, C K p₀ + (C/k) K (p − p₀) = ω − r²/2R and C K p₀ = ω₀ − r²/2R, so that
//! (C/k) K p = ω − (1 − 1/k) ω₀ − r²/2kR: the contact of a stiff body with a ball of radius kR. By JKR it holds up to 3π k w R/2, as
//! if the work of adhesion were k w. Between both, the edge of the contact opens as fast as the body lets it: the theory of an
//! [`OpeningEdge`](viscocontact::analytic::OpeningEdge) holds while the bulk is relaxed.
//!
//! `cargo run --release -p viscocontact --features adhesion,analytic,plot --example pull_off`

mod support;

use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::adhesion::{ExponentialAttraction, tabor_number};
use viscocontact::analytic::{Jkr, OpeningEdge};
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Scale, Style, measure};
use viscocontact::prelude::*;

/// A ball that is pulled off a creeping body, at speeds over five decades.
#[derive(Parser)]
struct Args {
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 1.0e-3, value_parser = support::positive)]
    radius: f64,
    /// Relaxed contact modulus E* [Pa].
    #[arg(long, default_value_t = 1.0e5, value_parser = support::positive)]
    modulus: f64,
    /// Contact modulus at once over the relaxed one, k.
    #[arg(long, default_value_t = 10.0, value_parser = support::positive)]
    ratio: f64,
    /// Relaxation time [s].
    #[arg(long, default_value_t = 1.0, value_parser = support::positive)]
    tau: f64,
    /// Work of separation [J/m²].
    #[arg(long, default_value_t = 0.1, value_parser = support::positive)]
    work: f64,
    /// Range of the attraction [m].
    #[arg(long, default_value_t = 6.5e-6, value_parser = support::positive)]
    range: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 192)]
    cells: usize,
    /// Fewer speeds, cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/pull_off")]
    output: PathBuf,
}

/// The zone of the exponential attraction over its length l and the stiffening, fitted (docs/guide/adhesion.md).
const ZONE: f64 = 1.4;

/// Minimum and maximum speed in unit depths a relaxation time, as powers of ten.
const DECADES: [i32; 2] = [-3, 2];

fn main() {
    support::finish(run(&Args::parse()));
}

/// A point of a history: time \[s\], approach \[m\], force \[N\] and contact area \[m²\].
type Point = [f64; 4];

/// Pulls at `speed` with steps of at most `longest` \[m\] until the bodies are apart; a quarter as long while the pull is near
/// its greatest.
fn pull(contact: &mut ViscoelasticContact, speed: f64, longest: f64) -> viscocontact::Result<Vec<Point>> {
    let (began, start) = (contact.time(), contact.approach());
    let mut path = vec![[0.0, start, contact.force(), contact.contact_area()]];
    let (mut moved, mut step, mut least) = (0.0, 0.1 * longest, 0.0_f64);
    loop {
        moved += step;
        let report = contact.step(step / speed, Load::approach(start - moved))?;
        path.push([report.time - began, report.approach, report.force, contact.contact_area()]);
        if contact.is_separated() {
            return Ok(path);
        }
        least = least.min(report.force);
        step = (1.1 * step).min(if report.force < 0.7 * least { 0.25 * longest } else { longest });
    }
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let &Args { radius, modulus, ratio, work, .. } = args;
    // incompressible: E* = 4 G
    let body = GeneralizedMaxwell::new(0.25 * modulus, &[(0.25 * modulus * (ratio - 1.0), args.tau)])?;
    let law = ExponentialAttraction::new(work, args.range)?;
    // the lengths of JKR's theory, along the surface and across it
    let width = (radius * radius * work / modulus).cbrt();
    let depth = width * width / radius;
    let (cells, longest, every) = if args.quick { (128, 0.3, 3) } else { (args.cells, 0.15, 1) };
    let grid = Grid::square(cells, 13.0 * width)?;
    let material = Material::incompressible(body);
    let edge = OpeningEdge::new(&material, work, args.range)?.with_zone(ZONE)?;
    println!(
        "Tabor's number {:.2} relaxed, {:.2} at once; {:.1} cells in the zone of the attraction, l = {:.2e} m",
        tabor_number(&law, radius, modulus)?,
        tabor_number(&law, radius, ratio * modulus)?,
        edge.length() / grid.spacing()[0],
        edge.length()
    );

    // the limits of an attraction of vanishing range
    let limits = [Jkr::new(radius, modulus, work)?, Jkr::new(ratio * radius, ratio * modulus, work)?];
    let widest = 5.0 * width;
    let [_, rest] = limits[0].state(widest);
    let shift = [0.0, (1.0 - 1.0 / ratio) * rest];
    let dots = [0, 1].map(|n| {
        let (limit, narrowest) = (limits[n], limits[n].radius_at_min_approach());
        let radii = (0..=20).map(|k| widest + (narrowest - widest) * f64::from(k) / 20.0);
        let points = radii.map(|a| limit.state(a)).map(|[force, approach]| (approach + shift[n], force));
        points.collect::<Vec<_>>()
    });

    let mut rested = ViscoelasticContact::builder(grid)
        .geometry(&Sphere::new(radius)?)
        .material(material)
        .attraction(law)
        .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(true))
        .build()?;
    // the contact grows for much longer than the body relaxes
    for _ in 0..4 {
        rested.step(1.0e4 * args.tau, Load::approach(rest))?;
    }

    let mut forces = Chart::new(
        "A ball is pulled off a creeping body at six speeds",
        Quantity::new("approach", "m"),
        Quantity::new("force", "N"),
        Legend::LowerRight,
    );
    let mut table = csv::Writer::from_path(args.output.join("histories.csv"))?;
    table.write_record(["speed_m_s", "time_s", "approach_m", "force_n", "contact_area_m2"])?;
    let mut summary = csv::Writer::from_path(args.output.join("pulls.csv"))?;
    summary.write_record(["speed_m_s", "maximum_pull_n", "apparent_work_of_adhesion_j_m2", "theory_j_m2", "steps"])?;
    let exponents: Vec<i32> = (3 * DECADES[0]..=3 * DECADES[1]).step_by(every).collect();
    let progress = support::progress(exponents.len() as u64);
    let (mut apparent, mut theories) = (Vec::new(), Vec::new());
    let mut curves = Vec::new();
    for &exponent in &exponents {
        let speed = 10f64.powf(f64::from(exponent) / 3.0) * depth / args.tau;
        let path = pull(&mut rested.clone(), speed, longest * depth)?;
        for [time, approach, force, area] in &path {
            table.serialize((speed, time, approach, force, area))?;
        }
        let pulled = path.iter().map(|point| -point[2]).fold(0.0, f64::max);
        let adhesion = pulled / (1.5 * PI * radius);
        let theory = -edge.pull_off(radius, rest, speed)?.force / (1.5 * PI * radius);
        summary.serialize((speed, pulled, adhesion, theory, path.len() - 1))?;
        progress.suspend(|| {
            println!(
                "{} (V τ/l = {:.1e}): maximum pull {:.3} mN, apparent work of adhesion {:.2} w (theory {:.2} w), {} steps",
                measure(speed, "m/s"),
                speed * args.tau / edge.length(),
                1e3 * pulled,
                adhesion / work,
                theory / work,
                path.len() - 1
            );
        });
        apparent.push((speed, adhesion));
        theories.push((speed, theory));
        if exponent % 3 == 0 {
            curves.push((speed, path.iter().map(|point| (point[1], point[2])).collect()));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    table.flush()?;
    summary.flush()?;

    let mut works = Chart::new(
        "Apparent work of adhesion F/(1.5 π R) of the maximum pull F",
        Quantity::new("speed", "m/s"),
        Quantity::new("apparent work of adhesion", "J/m²"),
        Legend::LowerRight,
    );
    works.scale = Scale::LogLog;
    let across = |value: f64| apparent.iter().map(|&(speed, _)| (speed, value)).collect();
    for (n, name) in ["closed form (JKR), relaxed: w", "closed form (JKR), instantaneous: k w"].into_iter().enumerate()
    {
        works.add(name, COLORS[n], Style::Line, across(-limits[n].pull_off_force() / (1.5 * PI * radius)));
    }
    works.add("computed", COLORS[2], Style::LineAndDots, apparent.clone());
    works.add("theory of an opening edge, relaxed bulk", COLORS[3], Style::Line, theories);
    let [slow, fast] = dots;
    forces.add_family(Quantity::new("speed", "m/s"), Style::Line, curves);
    forces.add("closed form (JKR), relaxed", COLORS[6], Style::Dots, slow);
    forces.add("closed form (JKR), instantaneous", COLORS[1], Style::Dots, fast);
    works.save(args.output.join("work.png"))?;
    forces.save(args.output.join("force.png"))?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}
