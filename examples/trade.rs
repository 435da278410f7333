//! Speed against accuracy, measured: five scenes with a reference, given and adaptive steps, several meshes and step counts. Writes a table (CSV) and a picture for each scene.
//!
//! `cargo run --release -p viscocontact --features analytic,plot,states --example trade` (about five minutes), or with `-- --quick` (seconds)

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use viscocontact::Result;
use viscocontact::analytic::GrowingSphere;
use viscocontact::contact::Builder;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;

/// Measures what accuracy costs.
#[derive(Parser)]
struct Args {
    /// Small meshes and few steps.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/trade")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

/// Cells along each side of the finer mesh, and the tolerances of adaptive steps.
const FINE: usize = 128;
const TOLERANCES: [f64; 6] = [3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4];

const RADIUS: f64 = 10.0e-3;
const PUNCH: f64 = 1.0e-3;

struct Scene {
    name: &'static str,
    material: Material,
    history: Box<dyn LoadHistory>,
    until: f64,
    /// Steps spaced evenly in the logarithm of time, from this time on.
    logarithmic_from: Option<f64>,
    punch: bool,
    /// Exact approach at a time.
    exact: Box<dyn Fn(f64) -> f64>,
    /// Exact pressure under the middle, where it is known: at a distance from the axis and a time.
    pressure: Option<GrowingSphere>,
}

/// How a scene is run.
#[derive(Clone, Copy, PartialEq)]
struct Method {
    name: &'static str,
    rule: TimeRule,
    adaptive: bool,
}

const METHODS: [Method; 3] = [
    Method { name: "exponential, linear", rule: TimeRule::ExponentialLinear, adaptive: false },
    Method { name: "exponential", rule: TimeRule::Exponential, adaptive: false },
    Method { name: "adaptive", rule: TimeRule::Exponential, adaptive: true },
];

#[derive(Clone)]
struct Row {
    scene: &'static str,
    method: Method,
    cells: usize,
    /// Steps, or the tolerance of adaptive ones.
    asked: f64,
    steps: usize,
    error: f64,
    /// Of the last state, relative to that state.
    error_at_end: f64,
    equivalents: f64,
    seconds: f64,
    bytes: u64,
}

fn scenes() -> Result<Vec<Scene>> {
    let held = |material: &Material| {
        let material = material.clone();
        move |t: f64| (0.75 * RADIUS * material.contact_compliance(t)).powf(2.0 / 3.0) / RADIUS
    };
    let step = || StepLoad::new(Load::force(1.0));
    let maxwell = Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?);
    let zener = Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0)?);
    let four = [(0.5e-6, 0.05), (0.5e-6, 0.3), (0.5e-6, 2.0), (0.5e-6, 10.0)];
    let four = Material::incompressible(GeneralizedKelvin::new(1.0e-6, 0.0, &four)?);
    let power = Material::incompressible(FractionalMaxwell::findley(1.0e-6, 1.0e-6, 0.3)?);
    let corners = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.5, 0.0), (3.5, 1.0)];
    let triangle = PiecewiseLinear::new(&corners.map(|(time, force)| (time, Load::force(force))))?;
    let sine = Sinusoid::new(Load::force(0.2), Load::force(1.0), 1.0)?;
    let punch = |t: f64| 0.5 / PUNCH * 0.25e-6 * (1.0 + t);
    let plain =
        |name, material: &Material, until, history: Box<dyn LoadHistory>, exact: Box<dyn Fn(f64) -> f64>| Scene {
            name,
            material: material.clone(),
            history,
            until,
            logarithmic_from: None,
            punch: false,
            exact,
            pressure: None,
        };
    let eccentric = StepLoad::new(Load::eccentric_force(1.0, [PUNCH / 4.0, 0.0]))?;
    Ok(vec![
        Scene {
            pressure: Some(GrowingSphere::step(RADIUS, &maxwell, 1.0)?),
            ..plain("Maxwell, held", &maxwell, 2.0, Box::new(step()?), Box::new(held(&maxwell)))
        },
        plain("Zener, load-unload-load", &zener, 3.5, Box::new(triangle.clone()), foundation(&zener, &triangle, 3.5)?),
        plain("four times, sine", &four, 3.0, Box::new(sine), foundation(&four, &sine, 3.0)?),
        Scene {
            logarithmic_from: Some(1e-6),
            ..plain("power law, eight decades", &power, 1e4, Box::new(step()?), Box::new(held(&power)))
        },
        Scene { punch: true, ..plain("eccentric punch", &maxwell, 2.0, Box::new(eccentric), Box::new(punch)) },
    ])
}

/// The approach by the method of dimensionality reduction, tabulated.
fn foundation(material: &Material, history: &dyn LoadHistory, until: f64) -> Result<Box<dyn Fn(f64) -> f64>> {
    let mut contact = StatesContact::new(&ElasticStates::sphere(RADIUS)?, material)?;
    // between corners of the load, closer together towards both ends, where the approach has roots
    contact.step(0.0, history.at(0.0))?;
    let (mut table, mut from) = (vec![(0.0, contact.approach())], 0.0);
    while from < until {
        let to = history.next_breakpoint(from).unwrap_or(until).min(until);
        let count = (3000.0 * (to - from)).ceil();
        for k in 1..=count as u32 {
            let x = f64::from(k) / count;
            let t = if x == 1.0 { to } else { from + (to - from) * x * x * (3.0 - 2.0 * x) };
            contact.step(t - contact.time(), history.before(t))?;
            table.push((t, contact.approach()));
        }
        from = to;
    }
    Ok(Box::new(move |t| {
        let after = table.partition_point(|&(time, _)| time < t).clamp(1, table.len() - 1);
        let ((t0, w0), (t1, w1)) = (table[after - 1], table[after]);
        w0 + (t - t0) / (t1 - t0) * (w1 - w0)
    }))
}

impl Scene {
    fn builder(&self, cells: usize) -> Result<Builder> {
        let widest = (0.75 * RADIUS * self.material.contact_compliance(self.until)).cbrt();
        let grid = Grid::square(cells, if self.punch { 2.2 * PUNCH } else { 2.3 * widest })?;
        let builder = ViscoelasticContact::builder(grid).material(self.material.clone());
        let builder = builder.times(self.logarithmic_from.unwrap_or(1e-6)..=self.until * 1.01);
        Ok(if self.punch {
            builder.geometry(&FlatPunch::circular(PUNCH)?)
        } else {
            builder.geometry(&Sphere::new(RADIUS)?)
        })
    }

    /// One run; `asked` is the number of steps, or the tolerance of adaptive ones. `None` if it fails, as unstable rules do.
    fn measure(&self, method: Method, cells: usize, asked: f64) -> Result<Option<Row>> {
        let settings = Settings::default()
            .with_time_rule(method.rule)
            // a hundredth of the errors looked for is enough
            .with_tolerance(1e-5)
            .with_edge(Edge::Allow);
        let builder = self.builder(cells)?.settings(settings);
        let memory = builder.memory()?;
        let mut contact = builder.build()?;
        let clock = Instant::now();
        let (mut states, mut pressures, mut equivalents) = (Vec::new(), Vec::new(), 0.0);
        let landings: Vec<f64> = match self.logarithmic_from {
            Some(first) if !method.adaptive => {
                let decades = (self.until / first).log10();
                (0..=asked as usize).map(|k| first * 10f64.powf(decades * k as f64 / asked)).collect()
            }
            _ => Vec::new(),
        };
        let stepping = match (method.adaptive, self.logarithmic_from) {
            (true, _) => Stepping::adaptive(asked),
            (false, None) => Stepping::fixed(self.until / asked),
            (false, Some(_)) => Stepping::fixed(2.0 * self.until),
        };
        let mut run = contact.follow(&*self.history, stepping, self.until).stop_at(&landings)?;
        loop {
            match run.next_step() {
                Ok(Some(report)) => {
                    states.push((report.time, report.approach));
                    equivalents += report.convolution_equivalents();
                    if let Some(exact) = &self.pressure {
                        let [x1, x2] = run.contact().grid().center(cells / 2, cells / 2);
                        let center = run.contact().pressure()[cells / 2 * cells + cells / 2];
                        pressures.push((center, exact.pressure(x1.hypot(x2), report.time)));
                    }
                }
                Ok(None) => break,
                Err(_) => return Ok(None),
            }
        }
        let seconds = clock.elapsed().as_secs_f64();
        let greatest = states.iter().map(|&(t, _)| (self.exact)(t)).fold(0.0, f64::max);
        let late = self.logarithmic_from.map_or(0.0, |first| 100.0 * first);
        let errors =
            states.iter().filter(|state| state.0 >= late).map(|&(t, approach)| (approach - (self.exact)(t)).abs());
        let highest = pressures.iter().map(|&(_, exact)| exact).fold(f64::MIN_POSITIVE, f64::max);
        let central = pressures.iter().map(|&(p, exact)| (p - exact).abs() / highest).fold(0.0, f64::max);
        let error = (errors.fold(0.0, f64::max) / greatest).max(central);
        let steps = states.len();
        let (end, approach) = states[steps - 1];
        let at_end = (approach / (self.exact)(end) - 1.0).abs();
        let error_at_end = pressures.last().map_or(at_end, |(p, exact)| at_end.max((p / exact - 1.0).abs()));
        // adaptive steps keep one difference of the displacement more
        let more = if method.adaptive { 8 * memory.computed_cells as u64 } else { 0 };
        Ok(Some(Row {
            scene: self.name,
            method,
            cells,
            asked,
            steps,
            error,
            error_at_end,
            equivalents,
            seconds,
            bytes: memory.total() + more,
        }))
    }
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let meshes: &[usize] = if args.quick { &[24] } else { &[64, FINE] };
    let counts: &[f64] = if args.quick {
        &[10.0, 20.0]
    } else {
        &[4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 25.0, 50.0, 100.0, 200.0, 400.0, 800.0]
    };
    let tolerances: &[f64] = if args.quick { &[1e-2, 1e-3] } else { &TOLERANCES };
    let scenes = scenes()?;
    let mut rows: Vec<Row> = Vec::new();
    let mut failures: Vec<(&str, Method, usize, f64)> = Vec::new();
    let progress = support::progress((scenes.len() * meshes.len() * METHODS.len()) as u64);
    for scene in &scenes {
        for &cells in meshes {
            for method in METHODS {
                for &asked in if method.adaptive { tolerances } else { counts } {
                    match scene.measure(method, cells, asked)? {
                        Some(row) => rows.push(row),
                        None => failures.push((scene.name, method, cells, asked)),
                    }
                }
                progress.inc(1);
            }
        }
    }
    progress.finish_and_clear();

    let mut table = csv::Writer::from_path(args.output.join("trade.csv"))?;
    table.write_record([
        "scene",
        "method",
        "cells_a_side",
        "steps_or_tolerance",
        "steps",
        "error",
        "error_at_end",
        "convolution_equivalents",
        "seconds",
        "bytes",
    ])?;
    for row in &rows {
        table.serialize((
            row.scene,
            row.method.name,
            row.cells,
            row.asked,
            row.steps,
            row.error,
            row.error_at_end,
            row.equivalents,
            row.seconds,
            row.bytes,
        ))?;
    }
    table.flush()?;
    for scene in &scenes {
        plot(args, scene.name, meshes[meshes.len() - 1], &rows)?;
    }
    let page = page(&scenes, meshes, &rows, &failures);
    println!("{page}");
    if args.quick {
        // of the full table the rows of adaptive steps, which take seconds
        let mut adaptive = Vec::new();
        for scene in &scenes {
            for tolerance in TOLERANCES {
                adaptive.extend(scene.measure(METHODS[METHODS.len() - 1], FINE, tolerance)?);
            }
        }
        let page = self::page(&scenes, &[FINE], &adaptive, &[]);
        support::figures::lines("work to reach an error", &page, "| adaptive |")?;
    } else {
        support::figures::figure("work to reach an error", &page)?;
    }
    println!("table and pictures are in {}", args.output.display());
    Ok(())
}

fn plot(args: &Args, scene: &str, cells: usize, rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let title = format!("{scene}, {cells}² cells");
    let mut chart = Chart::new(&title, "convolution equivalents", "relative error", Legend::UpperRight);
    chart.scale = Scale::LogLog;
    for (k, method) in METHODS.into_iter().enumerate() {
        let of = |row: &&Row| row.scene == scene && row.cells == cells && row.method == method;
        let mut points: Vec<_> = rows.iter().filter(of).map(|row| (row.equivalents, row.error.max(1e-8))).collect();
        // the runs that no cheaper run of the method beats
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut least = f64::INFINITY;
        points.retain(|&(_, error)| {
            let better = error < least;
            least = least.min(error);
            better
        });
        if !points.is_empty() {
            chart.add(method.name, COLORS[k], Style::LineAndDots, points);
        }
    }
    let name: String = scene.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    Ok(chart.save(args.output.join(format!("{name}.png")))?)
}

/// For every scene and method the least work that reaches an error.
fn page(scenes: &[Scene], meshes: &[usize], rows: &[Row], failures: &[(&str, Method, usize, f64)]) -> String {
    let mut page = String::from(
        "## Work to reach an error\n\n\
         Least convolution equivalents over all step counts or tolerances of the sweep for which the error of the approach\n\
         (greatest over the run, relative to its greatest value; mesh included; for the held sphere on a Maxwell body of the\n\
         central pressure too) is below 1e-2, 1e-3 and 1e-4; in brackets the steps. A dash: not reached in the sweep.\n\
         Memory is that of `Builder::memory` and what the steps add.\n",
    );
    let cells = meshes[meshes.len() - 1];
    for scene in scenes {
        page += &format!(
            "\n### {}, {cells}² cells\n\n| method | 1e-2 | 1e-3 | 1e-4 | memory at 1e-2 |\n|---|---|---|---|---|\n",
            scene.name
        );
        for method in METHODS {
            let best = |target: f64| {
                let of = |row: &&Row| row.scene == scene.name && row.cells == cells && row.method == method;
                let fits = rows.iter().filter(of).filter(|row| row.error <= target);
                fits.min_by(|a, b| a.equivalents.total_cmp(&b.equivalents))
            };
            let cell =
                |target| best(target).map_or("–".into(), |row| format!("{:.0} ({})", row.equivalents, row.steps));
            let memory = best(1e-2).map_or("–".into(), |row| format!("{:.1} MB", row.bytes as f64 * 1e-6));
            page += &format!("| {} | {} | {} | {} | {memory} |\n", method.name, cell(1e-2), cell(1e-3), cell(1e-4));
        }
    }
    let name = scenes[0].name;
    page += &format!(
        "\n### {name}, {cells}² cells: approach and central pressure at the end, relative to themselves\n\n| method | 1e-2 | 1e-3 |\n|---|---|---|\n"
    );
    for method in METHODS {
        let best = |target: f64| {
            let of = |row: &&Row| row.scene == name && row.cells == cells && row.method == method;
            let fits = rows.iter().filter(of).filter(|row| row.error_at_end <= target);
            let best = fits.min_by(|a, b| a.equivalents.total_cmp(&b.equivalents));
            best.map_or("–".into(), |row| format!("{:.0} ({})", row.equivalents, row.steps))
        };
        page += &format!("| {} | {} | {} |\n", method.name, best(1e-2), best(1e-3));
    }
    if !failures.is_empty() {
        page += "\nRuns that failed (a rule that is unstable for such steps):\n\n";
        for (scene, method, cells, asked) in failures {
            page += &format!("* {scene}, {}, {cells}², {asked} steps\n", method.name);
        }
    }
    page
}
