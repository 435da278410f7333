//! PMMA under a ball for eight decades of time: published relaxation data, a force that is held, the contact growing
//! tenfold. Twice: with a constant Poisson's ratio, for which the answer is known, and with an elastic bulk.
//!
//! `cargo run --release -p viscocontact --features data,plot --example polymer_indentation`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::library;

/// A ball on a real polymer over many decades of time.
#[derive(Parser)]
struct Args {
    /// PublishedMaterial material (`--material list` names them).
    #[arg(long, default_value = "PMMA")]
    material: String,
    /// Poisson's ratio at first.
    #[arg(long, default_value_t = 0.35)]
    poisson: f64,
    /// First time shown [s].
    #[arg(long, default_value_t = 1.0e-2)]
    from: f64,
    /// Last time [s].
    #[arg(long, default_value_t = 1.0e6)]
    to: f64,
    /// Force [N].
    #[arg(long, default_value_t = 1.0)]
    load: f64,
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 5.0e-3)]
    radius: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 256)]
    cells: usize,
    /// Steps a decade of time.
    #[arg(long, default_value_t = 20)]
    steps: u32,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/polymer_indentation")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (64, 5);
    }
    support::finish(run(&args));
}

/// A run: history of (time, contact radius, peak pressure), and pressure profiles once a decade.
struct Run {
    history: Vec<[f64; 3]>,
    profiles: Vec<(f64, Vec<(f64, f64)>)>,
    convolutions: f64,
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    if args.material == "list" {
        for material in library::all() {
            println!("{}: {}\n  {}\n  {}", material.name, material.description, material.reference, material.remark);
        }
        return Ok(());
    }
    fs::create_dir_all(&args.output)?;
    let published = library::find(&args.material)?;
    println!("{}: {}\n({})", published.name, published.reference, published.remark);
    let shear = published.rheology(args.poisson)?;
    let spectrum = shear.creep_spectrum().ok_or("a Prony series has a spectrum")?;
    let glassy = 1.0 / spectrum.glassy();
    // the bulk modulus that gives Poisson's ratio at first
    let bulk = 2.0 * glassy * (1.0 + args.poisson) / (3.0 * (1.0 - 2.0 * args.poisson));
    let constant = Material::constant_poisson(shear.clone(), args.poisson)?;
    let elastic_bulk = Material::elastic_bulk(shear, bulk)?;
    println!("G(0) = {:.3e} Pa, B = {bulk:.3e} Pa, {} relaxation times", glassy, spectrum.terms().len());

    let exact = |material: &Material, t: f64| (0.75 * args.radius * args.load * material.contact_compliance(t)).cbrt();
    let runs = [simulate(args, &constant)?, simulate(args, &elastic_bulk)?];
    let mut table = csv::Writer::from_path(args.output.join("history.csv"))?;
    table.write_record([
        "time_s",
        "contact_radius_m",
        "exact_contact_radius_m",
        "max_pressure_pa",
        "elastic_bulk_contact_radius_m",
        "elastic_bulk_exact_contact_radius_m",
        "elastic_bulk_max_pressure_pa",
    ])?;
    let mut worst = [0.0_f64; 2];
    for (one, other) in runs[0].history.iter().zip(&runs[1].history) {
        let expected = [exact(&constant, one[0]), exact(&elastic_bulk, one[0])];
        table.serialize((one[0], one[1], expected[0], one[2], other[1], expected[1], other[2]))?;
        worst[0] = worst[0].max((one[1] / expected[0] - 1.0).abs());
        worst[1] = worst[1].max((other[1] / expected[1] - 1.0).abs());
    }
    table.flush()?;
    for ((name, run), worst) in ["constant Poisson's ratio", "elastic bulk"].iter().zip(&runs).zip(worst) {
        let (first, last) = (run.history[0], run.history[run.history.len() - 1]);
        println!(
            "{name}: contact radius {:.3} -> {:.3} mm, peak pressure {:.2} -> {:.3} MPa; greatest error of the radius {worst:.1e}; \
             {} steps of {:.2} convolutions",
            first[1] * 1e3,
            last[1] * 1e3,
            first[2] * 1e-6,
            last[2] * 1e-6,
            run.history.len(),
            run.convolutions / run.history.len() as f64
        );
    }

    let title = format!("{}: contact radius under a force that is held", published.name);
    let mut chart = Chart::new(&title, "time [s]", "contact radius [mm]", Legend::UpperLeft);
    chart.scale = Scale::LogLog;
    for (run, (material, name, color)) in
        runs.iter().zip([(&constant, "constant Poisson's ratio", 0), (&elastic_bulk, "elastic bulk", 1)])
    {
        let curve = run.history.iter().map(|&[t, ..]| (t, 1e3 * exact(material, t))).collect();
        chart.add(format!("{name}, a³ = ¾ R W C(t)"), COLORS[color], Style::Line, curve);
        let dots = run.history.iter().step_by(4).map(|&[t, a, _]| (t, 1e3 * a)).collect();
        chart.add(format!("{name}, computed"), COLORS[color], Style::Dots, dots);
    }
    chart.save(args.output.join("contact_radius.png"))?;

    let title = format!("{}: shape of the pressure while the contact grows", published.name);
    let mut chart = Chart::new(&title, "x1 / contact radius", "pressure / maximum pressure", Legend::LowerLeft);
    let profiles = &runs[0].profiles;
    let history = &runs[0].history;
    let run_at = |time: f64| history[history.partition_point(|[t, ..]| *t < 0.999 * time).min(history.len() - 1)];
    let mut shapes = Vec::new();
    for (time, profile) in profiles.iter().step_by(2) {
        let inside: Vec<_> = profile.iter().filter(|(_, p)| *p > 0.0).copied().collect();
        let most = inside.iter().fold(0.0_f64, |most, (_, p)| most.max(*p));
        let radius = 1e3 * run_at(*time)[1];
        let shape = |&(x, p): &(f64, f64)| (x / radius, p / most);
        // the last cells are in contact in part
        let shape = inside.iter().map(shape).filter(|(x, _)| x.abs() < 0.97);
        // at the rim the pressure vanishes
        shapes.push((*time, [(-1.0, 0.0)].into_iter().chain(shape).chain([(1.0, 0.0)]).collect()));
    }
    chart.add_family(Quantity::new("time", "s"), Style::Line, shapes);
    chart.save(args.output.join("profiles.png"))?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// The force jumps at t = 0 and is held; two decades before the first time shown are computed, so that the jump is
/// forgotten.
fn simulate(args: &Args, material: &Material) -> Result<Run, Box<dyn Error>> {
    let widest = (0.75 * args.radius * args.load * material.contact_compliance(args.to)).cbrt();
    let mut contact = ViscoelasticContact::builder(Grid::square(args.cells, 2.3 * widest)?)
        .geometry(&Sphere::new(args.radius)?)
        .material(material.clone())
        .build()?;
    contact.step(0.0, Load::force(args.load))?;
    let start = 1e-2 * args.from;
    let decades = (args.to / start).log10();
    let count = (decades * f64::from(args.steps)).round() as u32;
    let mut run = Run { history: Vec::new(), profiles: Vec::new(), convolutions: 0.0 };
    let progress = support::progress(u64::from(count));
    for k in 0..=count {
        let time = start * 10f64.powf(decades * f64::from(k) / f64::from(count));
        let report = contact.step(time - contact.time(), Load::force(args.load))?;
        progress.inc(1);
        if time < 0.999 * args.from {
            continue;
        }
        let peak = contact.pressure().iter().copied().fold(0.0, f64::max);
        run.history.push([time, (report.approach * args.radius).sqrt(), peak]);
        run.convolutions += report.convolution_equivalents();
        if k % args.steps == 0 {
            let (n, middle) = (args.cells, args.cells / 2);
            let row = |j: usize| (contact.grid().center(middle, j)[1] * 1e3, contact.pressure()[middle * n + j] * 1e-6);
            run.profiles.push((time, (0..n).map(row).collect()));
        }
    }
    progress.finish_and_clear();
    Ok(run)
}
