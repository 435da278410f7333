//! The real contact area of a rough polymer over nine decades of time. A stiff, self-affine random surface lies on a
//! flat polymer under a constant mean pressure; only its summits touch, and more of them as the polymer creeps. Then
//! half of the load is taken off: the area drops, and grows again in the hold.
//!
//! While no contact opens, theory says (Lee & Radok 1960) that the area is the one of an elastic body with the
//! compliance C(t) of the moment, which is computed here too, on the same surface. Cells in contact are counted for
//! this: edges drawn through the pressures of a creeping body lie a little farther out than those of an elastic one,
//! as what came into contact last is stiff. Persson's theory of contact
//! has for it
//!
//! A / A0 = erf(√2 p C / h'),
//!
//! p the mean pressure and h' the rms slope (Persson, J. Chem. Phys. 115, 2001, in the form of Manners & Greenwood, Wear
//! 261, 2006). At small loads the area is κ p C / h', with κ = √(8/π) = 1.6 from this formula and about 2 in computations.
//!
//! `cargo run --release -p viscocontact --features data,plot,surfaces --example rough_creep`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use viscocontact::Result;
use viscocontact::output::{CsvHistory, Earlier, Metadata};
use viscocontact::plot::{COLORS, Chart, Legend, Map, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::library;

/// The real contact area of a rough polymer, growing over decades of time.
#[derive(Parser)]
struct Args {
    /// Published material.
    #[arg(long, default_value = "adhesive")]
    material: String,
    /// Temperature [K], where it is published how the material shifts with it.
    #[arg(long, default_value_t = 318.15)]
    temperature: f64,
    /// Poisson's ratio, where none is published.
    #[arg(long, default_value_t = 0.35)]
    poisson: f64,
    /// First time shown [s].
    #[arg(long, default_value_t = 1.0e-3, value_parser = support::positive)]
    from: f64,
    /// Time at which half of the load is taken off, and length of the hold after it [s].
    #[arg(long, default_value_t = 1.0e6, value_parser = support::positive)]
    to: f64,
    /// Mean pressure, in units of rms slope / C at the first time shown.
    #[arg(long, default_value_t = 0.03)]
    pressure: f64,
    /// Side of the surface, which repeats [m].
    #[arg(long, default_value_t = 1.0e-3)]
    length: f64,
    /// Root mean square of the slope.
    #[arg(long, default_value_t = 0.02)]
    slope: f64,
    /// Which random surface.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 512)]
    cells: usize,
    /// Error in time allowed to a step, relative to the displacement.
    #[arg(long, default_value_t = 1.0e-3)]
    error: f64,
    /// A small grid, for a look.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/rough_creep")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

/// Results at one time.
struct Moment {
    time: f64,
    /// Share of the cells in contact.
    cells: f64,
    /// Share of the area that the edges of the patches say, which lie within cells.
    area: f64,
    patches: usize,
    /// Part of the cells in contact that belong to the largest patch.
    largest: f64,
    /// [m]
    mean_gap: f64,
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let began = Instant::now();
    let cells = if args.quick { 128 } else { args.cells };
    let grid = Grid::square(cells, args.length)?;
    // a summit of the shortest waves is eight cells wide
    let spec = RoughSpec::new(0.5 * args.length, 8.0 * args.length / cells as f64, Roughness::RmsSlope(args.slope))
        .with_roll_off(0.25 * args.length)
        .with_seed(args.seed);
    let surface = Rough::new(&grid, spec)?;
    let statistics = surface.height_map().statistics()?;
    println!(
        "surface: {cells}² cells on ({:.2} mm)², rms height {:.3} µm, rms slope {:.4}, H = {}",
        args.length * 1e3,
        statistics.rms_height * 1e6,
        statistics.rms_slope,
        spec.hurst()
    );

    let material = polymer(args)?;
    let compliance = |t: f64| material.contact_compliance(t);
    let mean = args.pressure * args.slope / compliance(args.from);
    let force = mean * args.length * args.length;
    println!(
        "polymer: 1/C falls from {:.3} GPa at {:.0e} s to {:.3} GPa at {:.0e} s; mean pressure {:.3} MPa\n",
        1e-9 / compliance(args.from),
        args.from,
        1e-9 / compliance(args.to),
        args.to,
        mean * 1e-6
    );

    // The bodies repeat as the surface does. Counting cells in the hold asks for a close solution.
    let kernel = Arc::new(InfluenceKernel::periodic(&grid)?);
    let build = |material: &Material| {
        ViscoelasticContact::builder(grid.clone())
            .geometry(&surface)
            .material(material.clone())
            .kernel(kernel.clone())
            .settings(Settings::default().with_tolerance(1e-7))
            .build()
    };
    let mut contact = build(&material)?;
    let scene = Metadata::new("Rough surface on a creeping polymer").note("material", &args.material);
    let mut files = Files::create(args, &scene, &contact)?;

    // Loading: steps as long as their error allows, and such that the times of the table are met.
    let decades = (args.to / args.from).log10().round() as i32;
    let mut shown: Vec<f64> = (0..5 * decades).map(|k| args.from * 10f64.powf(0.2 * f64::from(k))).collect();
    shown.retain(|time| *time < 0.9 * args.to);
    shown.push(args.to);
    let pictured = [0, (shown.len() - 1) / 15 * 10, shown.len() - 1].map(|k| shown[k]);
    println!(
        "shares of the surface: cells in contact, those of an elastic body, Persson, area by the edges of the patches"
    );
    println!(
        "{:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}",
        "t [s]", "cells", "elastic", "Persson", "edges", "patches", "largest", "gap [µm]"
    );
    let (mut growth, mut elastic, mut maps) = (Vec::new(), Vec::new(), Vec::new());
    let (mut work, mut worst) = ((0, 0.0), 0.0_f64);
    let progress = support::progress(shown.len() as u64);
    let history = StepLoad::new(Load::force(force))?;
    let mut follow = contact.follow(&history, Stepping::adaptive(args.error), args.to).stop_at(&shown)?;
    while let Some(report) = follow.next_step()? {
        let contact = follow.contact();
        work = (work.0 + 1, work.1 + report.convolution_equivalents());
        files.history.record(contact, &report, &[])?;
        if !shown.contains(&report.time) {
            continue;
        }
        let moment = observe(contact)?;
        if growth.len() % 5 == 0 {
            // the elastic body of the compliance of this moment, on the same surface
            let now = compliance(report.time);
            let mut other = build(&Material::incompressible(Elastic::new(0.25 / now)?))?;
            other.step(0.0, Load::force(force))?;
            let expected = observe(&other)?.cells;
            worst = worst.max((moment.cells / expected - 1.0).abs());
            elastic.push((report.time, expected));
            progress.suspend(|| {
                println!(
                    "{:8.0e} {:8.4} {expected:8.4} {:8.4} {:8.4} {:8} {:8.4} {:9.3}",
                    report.time,
                    moment.cells,
                    persson(mean * now / args.slope),
                    moment.area,
                    moment.patches,
                    moment.largest,
                    moment.mean_gap * 1e6
                );
            });
            files.frame(contact)?;
        }
        if pictured.contains(&report.time) {
            maps.push(map(contact, mean, report.time, moment.cells)?);
        }
        growth.push(moment);
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!(
        "{} steps of {:.2} convolutions; cells in contact differ from those of the elastic body by {worst:.1e} at most",
        work.0,
        work.1 / f64::from(work.0)
    );

    // Unloading: a jump, then steps that grow with the time since.
    let held = Load::force(0.5 * force);
    let report = contact.step(0.0, held)?;
    files.history.record(&contact, &report, &[])?;
    let mut hold = vec![observe(&contact)?];
    let (mut before, mut fell) = (contact.contact_cells(), 0);
    let progress = support::progress(shown.len() as u64);
    for &since in &shown {
        let report = contact.step(args.to + since - contact.time(), held)?;
        files.history.record(&contact, &report, &[])?;
        fell += usize::from(report.contact_cells < before);
        before = report.contact_cells;
        hold.push(Moment { time: since, ..observe(&contact)? });
        progress.inc(1);
    }
    progress.finish_and_clear();
    files.frame(&contact)?;
    let last = &growth[growth.len() - 1];
    println!(
        "\nhalf of the load off: cells in contact {:.4} -> {:.4} at once, {:.4} after {:.0e} s more; \
         steps of the hold in which their number fell: {fell} of {}",
        last.cells,
        hold[0].cells,
        hold[hold.len() - 1].cells,
        args.to,
        shown.len()
    );

    // κ from the first point; with it the law of small loads says how the area would go on
    let kappa = growth[0].cells / args.pressure;
    println!("κ at {:.0e} s: {kappa:.3}", args.from);
    let title =
        format!("Real contact area of a rough surface under {:.2} MPa (polymer: {})", mean * 1e-6, args.material);
    let mut chart =
        Chart::new(&title, "time since the load changed [s]", "cells in contact / all cells", Legend::UpperLeft);
    chart.scale = Scale::LogX;
    let small = shown.iter().map(|&t| (t, kappa * mean * compliance(t) / args.slope));
    let small = small.filter(|(_, share)| *share < 1.05 * last.cells).collect();
    chart.add(format!("small loads, κ p C(t)/h' with κ = {kappa:.2}"), COLORS[4], Style::Line, small);
    let theory = shown.iter().map(|&t| (t, persson(mean * compliance(t) / args.slope))).collect();
    chart.add("Persson, erf(√2 p C(t)/h')", COLORS[1], Style::Line, theory);
    let points = growth.iter().map(|m| (m.time, m.cells)).collect();
    chart.add("creeping, after the load was applied", COLORS[0], Style::Line, points);
    chart.add("elastic body of compliance C(t), same surface", COLORS[6], Style::Dots, elastic);
    let points = hold[1..].iter().map(|m| (m.time, m.cells)).collect();
    chart.add("creeping, after half of the load was taken off", COLORS[2], Style::Line, points);
    chart.save(args.output.join("area.png"))?;

    let mut chart = Chart::new("Patches of contact", "time [s]", "number of patches", Legend::UpperRight);
    chart.scale = Scale::LogX;
    let points = growth.iter().map(|m| (m.time, m.patches as f64)).collect();
    chart.add("patches", COLORS[0], Style::LineAndDots, points);
    chart.save(args.output.join("patches.png"))?;
    Map::draw_row(&maps)?.save(args.output.join("maps.png"))?;
    println!("{:.1} s; tables and pictures are in {}", began.elapsed().as_secs_f64(), args.output.display());
    Ok(())
}

/// The published polymer, at another temperature where it is known how it shifts.
fn polymer(args: &Args) -> Result<Material, Box<dyn Error>> {
    let published = library::find(&args.material)?;
    println!("{}: {}\n({})", published.name, published.description, published.reference);
    let nu = published.poisson.unwrap_or(args.poisson);
    let rheology = published.rheology(nu)?;
    Ok(match published.time_temperature() {
        Some(law) => {
            let warm = law.at(rheology, args.temperature)?;
            println!(
                "at {} K everything takes {:.1e} times as long as published",
                args.temperature,
                warm.shift_factor()
            );
            Material::constant_poisson(warm, nu)?
        }
        None => Material::constant_poisson(rheology, nu)?,
    })
}

/// Share of the surface in contact, `load` being p C / h'.
fn persson(load: f64) -> f64 {
    libm::erf(std::f64::consts::SQRT_2 * load)
}

fn observe(contact: &ViscoelasticContact) -> Result<Moment> {
    let nominal = contact.grid().cell_area() * contact.grid().len() as f64;
    let patches = contact.fields().patches()?;
    let mut gap = vec![0.0; contact.grid().len()];
    contact.fields().gap_into(&mut gap)?;
    Ok(Moment {
        time: contact.time(),
        area: contact.contact_area() / nominal,
        cells: contact.contact_cells() as f64 / gap.len() as f64,
        patches: patches.all.len(),
        largest: patches.largest().map_or(0.0, |patch| patch.cells as f64 / contact.contact_cells() as f64),
        mean_gap: gap.iter().sum::<f64>() / gap.len() as f64,
    })
}

/// Where it touches, and how hard.
fn map(contact: &ViscoelasticContact, mean: f64, time: f64, share: f64) -> Result<Map> {
    let values = contact.pressure().iter().map(|&p| if p > 0.0 { p / mean } else { f64::NAN }).collect();
    let mut map = Map::new(contact.grid(), values, "p / mean pressure")?;
    map.title = format!("{time:.0e} s: {:.0} % in contact", 100.0 * share);
    map.range = [0.0, 20.0];
    Ok(map)
}

/// The run as files: a row a step, and the whole state once a decade where the crate is built to write it.
struct Files {
    history: CsvHistory,
    frames: Vec<viscocontact::output::FrameSeries>,
}

impl Files {
    fn create(args: &Args, scene: &Metadata, contact: &ViscoelasticContact) -> Result<Files, Box<dyn Error>> {
        Ok(Files {
            history: CsvHistory::create(args.output.join("history.csv"), scene, contact, &[], Earlier::Replace)?,
            frames: {
                use viscocontact::output::{Earlier, Field, Format, FrameSeries};
                let formats = [
                    #[cfg(feature = "npy")]
                    (Format::Npz, "npz"),
                    (Format::Vtk, "vtk"),
                ];
                let series = formats.map(|(format, folder)| {
                    FrameSeries::create(
                        args.output.join(folder),
                        format,
                        scene,
                        contact,
                        Field::of(contact),
                        Earlier::Replace,
                    )
                });
                series.into_iter().collect::<Result<_>>()?
            },
        })
    }

    /// Writes the state as it is.
    #[allow(clippy::unnecessary_wraps, unused_variables, reason = "there is nothing to write without features")]
    fn frame(&mut self, contact: &ViscoelasticContact) -> Result<()> {
        for series in &mut self.frames {
            series.record(contact)?;
        }
        Ok(())
    }
}
