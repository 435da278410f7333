//! The cost that the source paper states in its section 4, measured: O(N_t² N₁N₂ log(N₁N₂)) for its algorithm taken literally,
//! beside the same with past convolutions kept, and the default of this crate; summation of all pairs of cells against
//! the FFT; and the ratio of the paper's time to the default one, cause by cause. Writes tables (CSV) and a picture.
//!
//! Times are processor times where the system measures them (Linux), so that a busy machine disturbs them little.
//!
//! `RAYON_NUM_THREADS=1 cargo run --release -p viscocontact --features analytic,plot --example paper_cost`
//! (six minutes), or with `-- --quick` (seconds)

#[path = "support/scenes/step_loaded_sphere.rs"]
mod step_loaded_sphere;
mod support;

use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use step_loaded_sphere::{StepLoadedSphere, errors};
use viscocontact::Result;
use viscocontact::Workspace;
use viscocontact::plot::{COLORS, Chart, Legend, Picture, Scale, Style};
use viscocontact::prelude::*;

/// Measures the cost that the source paper states.
#[derive(Parser)]
struct Args {
    /// Numbers of steps to twice the relaxation time.
    #[arg(long, value_delimiter = ',', default_value = "25,50,100,200,400,800,1600")]
    steps: Vec<usize>,
    /// Cells along each side of the grid while the number of steps changes.
    #[arg(long, value_delimiter = ',', default_value = "64,32")]
    cells_of_steps: Vec<usize>,
    /// Cells along each side of the grid, in --steps-of-cells steps.
    #[arg(long, value_delimiter = ',', default_value = "32,64,128,256,512")]
    cells: Vec<usize>,
    /// Steps while the number of cells changes, and of the comparison cause by cause on 256² cells.
    #[arg(long, default_value_t = 100)]
    steps_of_cells: usize,
    /// No run is started that is likely to take longer than this [s].
    #[arg(long, default_value_t = 150.0, value_parser = support::positive)]
    longest: f64,
    /// Runs are repeated for so long [s].
    #[arg(long, default_value_t = 1.5)]
    repeat: f64,
    /// Small grids, few steps, and less than a second for all: no times to rely on.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/paper_cost")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.steps, args.cells_of_steps) = (vec![10, 20, 40, 80], vec![16]);
        (args.cells, args.steps_of_cells) = (vec![16, 32, 64], 20);
        args.repeat = 0.0;
    }
    support::finish(run(&args));
}

/// Processor time of all threads so far, else the time of day \[s\].
fn seconds_so_far(start: Instant) -> f64 {
    let times = fs::read_dir("/proc/self/task").map(|tasks| {
        let own = |task: std::io::Result<fs::DirEntry>| -> Option<f64> {
            let text = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
            Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
        };
        tasks.filter_map(own).sum::<f64>()
    });
    times.ok().filter(|&seconds| seconds > 0.0).unwrap_or_else(|| start.elapsed().as_secs_f64())
}

/// A way to compute the scene.
#[derive(Clone, Copy)]
struct Way {
    name: &'static str,
    settings: Settings,
    /// Whether each step convolves all past increments of the pressure anew.
    literally: bool,
}

impl Way {
    fn new(name: &'static str, settings: Settings) -> Way {
        Way { name, settings, literally: false }
    }

    /// [`Settings::paper`] at the cost that the source paper states.
    fn literal() -> Way {
        Way { literally: true, ..Way::new("paper, literally", Settings::paper()) }
    }

    fn all() -> [Way; 3] {
        let kept = Way::new("paper, convolutions kept", Settings::paper());
        [Way::literal(), kept, Way::new("default", Settings::default())]
    }
}

/// The past as Eq. 11 is written: all increments of the pressure with their times. Its displacement equals the displacement that
/// [`Settings::paper`] finds from convolutions that it keeps, in a small part of the time.
struct Past {
    kernel: Arc<InfluenceKernel>,
    work: Workspace,
    increments: Vec<(f64, Vec<f64>)>,
    /// The pressure so far, the convolution of an increment, and the sum of all.
    pressure: Vec<f64>,
    image: Vec<f64>,
    displacement: Vec<f64>,
}

impl Past {
    fn new(contact: &ViscoelasticContact) -> Result<Past> {
        let kernel = Arc::clone(contact.fields().kernel());
        let empty = || vec![0.0; contact.grid().len()];
        let (work, increments) = (kernel.workspace()?, Vec::new());
        Ok(Past { kernel, work, increments, pressure: empty(), image: empty(), displacement: empty() })
    }

    /// The displacement at a time due to all increments so far; returns the number of convolutions.
    fn superpose(&mut self, time: f64, material: &Material) -> Result<usize> {
        self.displacement.fill(0.0);
        for (then, increment) in &self.increments {
            self.kernel.convolve(increment, &mut self.image, &mut self.work)?;
            let creep = material.contact_compliance(time - then);
            self.displacement.iter_mut().zip(&self.image).for_each(|(u, v)| *u += creep * v);
        }
        black_box(&self.displacement);
        Ok(self.increments.len())
    }

    /// Adds the increment of a step.
    fn add(&mut self, contact: &ViscoelasticContact) {
        let increment = contact.pressure().iter().zip(&self.pressure).map(|(now, before)| now - before).collect();
        self.increments.push((contact.time(), increment));
        self.pressure.copy_from_slice(contact.pressure());
    }
}

/// Cost of a run after the jump of the load.
#[derive(Clone, Copy)]
struct Cost {
    /// Convolution equivalents: an application of the preconditioner counts a quarter.
    convolutions: f64,
    /// Those of them that superpose the past.
    of_the_past: f64,
    seconds: f64,
    bytes: f64,
}

/// The least time of a run within `repeat` seconds. The system measures processor times in milliseconds: short runs are
/// repeated for a tenth of a second, and their mean counts as one.
fn cost(cells: usize, steps: usize, way: Way, repeat: f64) -> Result<Cost> {
    let (scene, settings) = (StepLoadedSphere::maxwell(), way.settings);
    let memory = ViscoelasticContact::builder(scene.grid(cells)?)
        .geometry(&Sphere::new(scene.radius)?)
        .material(scene.material.clone())
        .settings(settings)
        .memory()?;
    // taken literally, the past needs one field more: the convolution of an increment
    let fields = 8 * (cells * cells) as u64 * u64::from(way.literally);
    let bytes = (memory.total() + fields + memory.each_step * (steps as u64 + 1)) as f64;
    let (mut least, mut all, mut batch) = (f64::INFINITY, 0.0, (0.0, 0.0));
    loop {
        let mut contact = scene.contact(cells, settings)?;
        contact.step(0.0, Load::force(scene.force))?;
        let mut past = if way.literally { Some(Past::new(&contact)?) } else { None };
        past.iter_mut().for_each(|past| past.add(&contact));
        let (clock, mut convolutions, mut of_the_past) = (Instant::now(), 0.0, 0.0);
        let start = seconds_so_far(clock);
        for _ in 0..steps {
            let dt = scene.duration / steps as f64;
            if let Some(past) = &mut past {
                let repeated = past.superpose(contact.time() + dt, contact.material())? as f64;
                (convolutions, of_the_past) = (convolutions + repeated, of_the_past + repeated);
            }
            let report = contact.step(dt, Load::force(scene.force))?;
            past.iter_mut().for_each(|past| past.add(&contact));
            convolutions += report.convolution_equivalents();
            if settings.solver() == Solver::PolonskyKeer {
                of_the_past += (report.convolutions - 2 * report.iterations - 1) as f64;
            }
        }
        let (runs, seconds) = (batch.0 + 1.0, batch.1 + seconds_so_far(clock) - start);
        batch = (runs, seconds);
        if seconds > repeat.min(0.1) {
            (least, all, batch) = (least.min(seconds / runs), all + seconds, (0.0, 0.0));
        }
        if all > repeat {
            return Ok(Cost { convolutions, of_the_past, seconds: least, bytes });
        }
    }
}

/// The slope of a straight line through the logarithms of the points, by least squares.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let [covariance, variance] = [mean(&|p| (p.0 - x) * (p.1 - y)), mean(&|p| (p.0 - x).powi(2))];
    covariance / variance
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let mut table = csv::Writer::from_path(args.output.join("paper_cost.csv"))?;
    table.write_record(["way", "cells", "steps", "convolutions", "of the past", "seconds", "bytes"])?;
    let mut pictures = Vec::new();
    let fixed_cells = args.cells_of_steps.iter().map(|&cells| (format!("{cells}² cells"), "N_t", cells));
    for (of, symbol, cells) in fixed_cells {
        let runs: Vec<_> = args.steps.iter().map(|&steps| (steps as f64, cells, steps)).collect();
        pictures.push(sweep(args, &mut table, [&of, symbol], &runs, 2.0)?);
    }
    let runs: Vec<_> = args.cells.iter().map(|&n| ((n * n) as f64, n, args.steps_of_cells)).collect();
    let of = format!("{} steps", args.steps_of_cells);
    pictures.push(sweep(args, &mut table, [&of, "N1 N2"], &runs, 1.2)?);
    table.flush()?;
    // the steps on the first grid, and the cells
    pictures.drain(1..pictures.len() - 1);
    Picture::beside(&pictures)?.save(args.output.join("paper_cost.png"))?;
    direct_summation(args.quick)?;
    causes(args)?;
    println!("table and picture are in {}", args.output.display());
    Ok(())
}

/// All ways over the abscissa of `runs`, with their cells and steps; `growth` is the exponent that tells which run would take
/// too long.
fn sweep(
    args: &Args,
    table: &mut csv::Writer<fs::File>,
    [of, symbol]: [&str; 2],
    runs: &[(f64, usize, usize)],
    growth: f64,
) -> Result<Picture, Box<dyn Error>> {
    let mut chart = Chart::new(format!("Time of a run, {of}"), symbol, "processor time [s]", Legend::UpperLeft);
    chart.scale = Scale::LogLog;
    println!("\n{of}\n| way | {symbol} | convolutions | of the past | seconds | MB |\n|---|---|---|---|---|---|");
    let (ways, mut fits) = (Way::all(), Vec::new());
    let progress = support::progress((ways.len() * runs.len()) as u64);
    for (way, color) in ways.into_iter().zip(COLORS) {
        let mut costs: Vec<(f64, Cost)> = Vec::new();
        for &(x, cells, steps) in runs {
            progress.inc(1);
            let likely = costs.last().map_or(0.0, |(last, cost)| cost.seconds * (x / last).powf(growth));
            if likely > args.longest {
                progress.suspend(|| println!("| {} | {x} | left out, likely {likely:.0} s | | | |", way.name));
                break;
            }
            let cost = cost(cells, steps, way, args.repeat)?;
            let Cost { convolutions, of_the_past, seconds, bytes } = cost;
            let mb = 1e-6 * bytes;
            progress.suspend(|| {
                println!("| {} | {x} | {convolutions:.0} | {of_the_past:.0} | {seconds:.3} | {mb:.1} |", way.name);
            });
            table.serialize((way.name, cells, steps, convolutions, of_the_past, seconds, bytes))?;
            costs.push((x, cost));
        }
        let points = |of: fn(&Cost) -> f64| costs.iter().map(|(x, cost)| (*x, of(cost))).collect::<Vec<_>>();
        chart.add(way.name, color, Style::LineAndDots, points(|cost| cost.seconds));
        let of_all = |range: std::ops::RangeFrom<usize>| {
            let of: [fn(&Cost) -> f64; 3] = [|cost| cost.convolutions, |cost| cost.seconds, |cost| cost.bytes];
            of.map(|of| exponent(&points(of)[range.clone()]))
        };
        let late = costs.len().saturating_sub(3);
        fits.push((way.name, of_all(0..), costs[late].0, of_all(late..)));
    }
    progress.finish_and_clear();
    println!(
        "\n| exponents of {symbol} | convolutions | time | bytes | from {symbol} = | convolutions | time | bytes |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (way, [counts, time, bytes], from, late) in fits {
        let [late_counts, late_time, late_bytes] = late;
        println!(
            "| {way} | {counts:.2} | {time:.2} | {bytes:.2} | {from} | {late_counts:.2} | {late_time:.2} | {late_bytes:.2} |"
        );
    }
    Ok(chart.draw()?)
}

/// The displacement as a sum over all pairs of cells, against the convolution by FFT.
fn direct_summation(quick: bool) -> Result<(), Box<dyn Error>> {
    println!("\n| cells | sum of all pairs [ms] | FFT [ms] | ratio | difference |\n|---|---|---|---|---|");
    let mut points = [Vec::new(), Vec::new()];
    for n in if quick { vec![8, 16, 32] } else { vec![16, 32, 64, 128] } {
        let kernel = InfluenceKernel::half_space(&Grid::square(n, 1.0e-3)?)?;
        let (mut work, mut by_fft) = (kernel.workspace()?, vec![0.0; n * n]);
        let less = if quick { 4 } else { 0 };
        // K(i, j) for i, j ≥ 0, by which it is even
        let mut unit = vec![0.0; n * n];
        unit[0] = 1.0;
        let mut coefficients = unit.clone();
        kernel.convolve(&unit, &mut coefficients, &mut work)?;
        let pressure: Vec<f64> = (0..n * n).map(|k| 1.0 + (0.1 * k as f64).sin()).collect();
        let seconds = |repeat: usize, work: &mut dyn FnMut() -> Result<()>| -> Result<f64> {
            let clock = Instant::now();
            let start = seconds_so_far(clock);
            (0..repeat).try_for_each(|_| work())?;
            Ok((seconds_so_far(clock) - start) / repeat as f64)
        };
        let mut by_sum = vec![0.0; n * n];
        let direct = seconds(1 + (1 << (29 - less)) / n.pow(4), &mut || {
            for (k, u) in by_sum.iter_mut().enumerate() {
                let (i, j) = (k / n, k % n);
                *u = 0.0;
                for (row, pressure) in pressure.chunks_exact(n).enumerate() {
                    // of the row of coefficients |i − i'|, first those of j' ≤ j backwards, then the others
                    let coefficients = &coefficients[i.abs_diff(row) * n..][..n];
                    let (left, right) = pressure.split_at(j);
                    let before = left.iter().rev().zip(&coefficients[1..]).map(|(p, c)| p * c);
                    let after = right.iter().zip(coefficients).map(|(p, c)| p * c);
                    *u += before.sum::<f64>() + after.sum::<f64>();
                }
            }
            Ok(())
        })?;
        let fft =
            seconds(1 + (1 << (26 - less)) / (n * n), &mut || kernel.convolve(&pressure, &mut by_fft, &mut work))?;
        let greatest = by_sum.iter().copied().fold(0.0, f64::max);
        let apart = by_sum.iter().zip(&by_fft).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / greatest;
        let [direct_ms, fft_ms] = [1e3 * direct, 1e3 * fft];
        println!("| {n}² | {direct_ms:.4} | {fft_ms:.4} | {:.1} | {apart:.0e} |", direct / fft);
        points[0].push(((n * n) as f64, direct));
        points[1].push(((n * n) as f64, fft));
    }
    println!("exponents of N1 N2: {:.2} and {:.2}", exponent(&points[0]), exponent(&points[1]));
    Ok(())
}

/// From the paper's algorithm to the default, one setting after the other.
fn causes(args: &Args) -> Result<(), Box<dyn Error>> {
    let (cells, steps) = (if args.quick { 32 } else { 256 }, args.steps_of_cells);
    let paper = Settings::paper();
    let chain = [
        Way::literal(),
        Way::new("convolutions of the past kept", paper),
        Way::new("active set in place of Polonsky–Keer", paper.with_solver(Solver::ActiveSet)),
        Way::new("exponential time rule", Settings::default().with_symmetry(false).with_window(false)),
        Way::new("symmetry", Settings::default().with_window(false)),
        Way::new("window (default)", Settings::default()),
    ];
    println!(
        "\n{cells}² cells, {steps} steps\n| | ms per step | convolution equivalents per step | factor | MB |\n|---|---|---|---|---|"
    );
    let (mut first, mut last) = (None, None);
    let mut table =
        "| | ms per step | convolution equivalents per step | factor | MB |\n|---|---|---|---|---|\n".to_owned();
    let mut rows = Vec::new();
    for way in chain {
        let (name, Cost { convolutions, seconds, bytes, .. }) = (way.name, cost(cells, steps, way, args.repeat)?);
        let factor = last.map_or(1.0, |last: f64| last / seconds);
        let [ms, each] = [1e3 * seconds, convolutions].map(|value| value / steps as f64);
        let row = format!("| {name} | {ms:.2} | {each:.1} | {factor:.2} | {:.1} |", 1e-6 * bytes);
        println!("{row}");
        table += &format!("{row}\n");
        rows.push(format!("{ms:.1} | {each:.1} | {:.0} MB |", 1e-6 * bytes));
        (first, last) = (first.or(Some(seconds)), Some(seconds));
    }
    if let (Some(first), Some(last)) = (first, last) {
        println!("all together: {:.1}", first / last);
        table += &format!("| all together | | | {:.0} | |", first / last);
    }
    if !args.quick {
        support::figures::timed("where the factor comes from", &table)?;
        let [literal, kept, .., default] = &rows[..] else { unreachable!() };
        let table = format!(
            "| | ms per step | convolution equivalents per step | memory |\n|---|---|---|---|\n\
             | the source paper's algorithm, literally | {literal}\n\
             | the same, convolutions of past pressures kept | {kept}\n\
             | this crate's defaults | {default}"
        );
        support::figures::timed("speed", &table)?;
    }
    // the fewest steps from which on the default rule is no less exact than the paper's rule
    let scene = StepLoadedSphere::maxwell();
    let error = |steps: usize, time_rule: TimeRule| -> Result<f64> {
        let (contact, _) = scene.run(cells, steps, Settings::default().with_time_rule(time_rule))?;
        Ok(errors(&contact, &scene.reference()?).l1)
    };
    let by_paper = error(steps, TimeRule::Rectangle)?;
    println!("\nL1 error of p at t = 2 τ by the paper's rule in {steps} steps: {by_paper:.1e}; by the default rule:");
    for fewer in [2, 3, 4, 5, 6, 8, 10, 12, 16, 20].into_iter().take_while(|&fewer| fewer <= steps) {
        let by_default = error(fewer, TimeRule::Exponential)?;
        println!("{fewer} steps: {by_default:.1e}{}", if by_default <= by_paper { ", no less exact" } else { "" });
    }
    Ok(())
}
