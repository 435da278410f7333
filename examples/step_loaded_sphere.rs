//! The source paper's scene: a sphere pressed onto a creeping half-space by a force that is applied at
//! once and held. Reproduces its Figures 4, 5 and 6 against the closed forms of its Table 1.
//!
//! `cargo run --release -p viscocontact --features analytic,plot --example step_loaded_sphere` takes no argument; `-- --help` lists them.

#[path = "support/scenes/step_loaded_sphere.rs"]
mod scene;
mod support;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use scene::{Errors, StepLoadedSphere, errors};
use viscocontact::Result;
use viscocontact::analytic::{GrowingSphere, Hertz};
use viscocontact::plot::{COLORS, Chart, Color, Legend, Scale, Style};
use viscocontact::prelude::*;

/// Profiles are taken at these times, in units of τ.
const PROFILE_TIMES: [f64; 4] = [0.0, 0.5, 1.0, 2.0];
/// Steps of the study of convergence in time.
const STEP_COUNTS: [usize; 7] = [4, 8, 16, 32, 64, 128, 256];

/// A step-loaded sphere on a viscoelastic half-space, against Table 1 of the source paper.
#[derive(Parser)]
struct Args {
    /// Body under the sphere.
    #[arg(long, value_enum, default_value = "both")]
    model: Model,
    /// Glassy shear modulus G [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    modulus: f64,
    /// Shear modulus G_K of the Zener body's Kelvin-Voigt element [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    kelvin_modulus: f64,
    /// Relaxation time (Maxwell) or retardation time (Zener) [s].
    #[arg(long, default_value_t = 1.0)]
    tau: f64,
    /// Force [N].
    #[arg(long, default_value_t = 1.0)]
    load: f64,
    /// Radius of the sphere [m].
    #[arg(long, default_value_t = 10.0e-3)]
    radius: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 256)]
    cells: usize,
    /// Steps to the end, t = 2 tau.
    #[arg(long, default_value_t = 100)]
    steps: usize,
    /// Tolerance of the solver.
    #[arg(long, default_value_t = 1e-6)]
    tolerance: f64,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/step_loaded_sphere")]
    output: PathBuf,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Model {
    Maxwell,
    Zener,
    Both,
}

impl Args {
    fn settings(&self) -> Settings {
        Settings::default().with_tolerance(self.tolerance)
    }

    fn scenes(&self) -> Result<Vec<StepLoadedSphere>> {
        let base = StepLoadedSphere {
            radius: self.radius,
            force: self.load,
            modulus: self.modulus,
            tau: self.tau,
            duration: 2.0 * self.tau,
            ..StepLoadedSphere::maxwell()
        };
        let mut scenes = Vec::new();
        if self.model != Model::Zener {
            let body = Maxwell::with_time(self.modulus, self.tau)?;
            scenes.push(StepLoadedSphere { name: "Maxwell", material: Material::incompressible(body), ..base.clone() });
        }
        if self.model != Model::Maxwell {
            let body = Zener::with_time(self.modulus, self.kelvin_modulus, self.tau)?;
            scenes.push(StepLoadedSphere { name: "Zener", material: Material::incompressible(body), ..base });
        }
        Ok(scenes)
    }
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (64, 20);
    }
    support::finish(run(&args));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let started = Instant::now();
    let mut growth = Chart::new(
        "Contact radius under a step load",
        "t / τ",
        "contact radius / Hertz radius at t = 0",
        Legend::UpperLeft,
    );
    let title = format!("Error in time at t = 2τ, {}² cells", args.cells / 2);
    let y = "central pressure: |computed / exact − 1|";
    let mut convergence = Chart::new(&title, "steps", y, Legend::LowerLeft);
    convergence.scale = Scale::LogLog;
    for (index, scene) in args.scenes()?.iter().enumerate() {
        let colors = [COLORS[2 * index], COLORS[2 * index + 1]];
        let run = follow(scene, args)?;
        run.print(scene, args);
        run.write_tables(scene, &args.output)?;
        run.plot_profiles(scene)?.save(file(&args.output, "profiles", scene, "png"))?;
        run.add_growth(scene, &mut growth, colors[0]);
        add_convergence(scene, args, &mut convergence, colors)?;
    }
    growth.save(args.output.join("contact_radius.png"))?;
    convergence.save(args.output.join("convergence.png"))?;
    println!("tables and pictures are in {} ({:.1} s in all)", args.output.display(), started.elapsed().as_secs_f64());
    Ok(())
}

/// A pressure profile along x1, at the time it was taken.
struct Profile {
    time: f64,
    /// (distance, computed pressure, exact pressure)
    points: Vec<[f64; 3]>,
    errors: Errors,
}

struct Run {
    exact: GrowingSphere,
    hertz: Hertz,
    reports: Vec<StepReport>,
    /// Contact radius after each step.
    radii: Vec<f64>,
    profiles: Vec<Profile>,
    seconds: f64,
}

fn bar(length: usize, message: String) -> Result<ProgressBar, Box<dyn Error>> {
    let style = ProgressStyle::with_template("{msg:24} {bar:40} {pos}/{len} steps, {eta} left")?;
    Ok(ProgressBar::new(length as u64).with_style(style).with_message(message))
}

/// Runs the scene along its load history, taking profiles on the way.
fn follow(scene: &StepLoadedSphere, args: &Args) -> Result<Run, Box<dyn Error>> {
    let exact = scene.reference()?;
    let hertz = Hertz::new(scene.radius, 1.0 / scene.material.contact_compliance(0.0), scene.force)?;
    let mut contact = scene.contact(args.cells, args.settings())?;
    let times = PROFILE_TIMES.map(|time| time * scene.tau);
    let force = scene.force;
    let history = FnHistory::new(move |_| Load::force(force)).with_breakpoints(&times)?;
    let step = scene.duration / args.steps as f64;

    let (mut reports, mut radii, mut profiles) = (Vec::new(), Vec::new(), Vec::new());
    let progress = bar(args.steps, format!("{} body", scene.name))?;
    let started = Instant::now();
    let mut seconds = 0.0;
    let mut run = contact.follow(&history, Stepping::fixed(step), scene.duration);
    while let Some(report) = run.next_step()? {
        progress.set_position((report.time / step).round() as u64);
        reports.push(report);
        radii.push((run.contact().contact_area() / std::f64::consts::PI).sqrt());
        if times.contains(&report.time) {
            let pause = Instant::now();
            profiles.push(profile(run.contact(), &exact));
            seconds -= pause.elapsed().as_secs_f64();
        }
    }
    seconds += started.elapsed().as_secs_f64();
    progress.finish_and_clear();
    Ok(Run { exact, hertz, reports, radii, profiles, seconds })
}

fn profile(contact: &ViscoelasticContact, exact: &GrowingSphere) -> Profile {
    let (grid, time) = (contact.grid(), contact.time());
    let [n1, n2] = grid.cells();
    let points = (n1 / 2..n1)
        .map(|i| {
            let [x1, x2] = grid.center(i, n2 / 2);
            let r = x1.hypot(x2);
            [r, contact.pressure()[i * n2 + n2 / 2], exact.pressure(r, time)]
        })
        .collect();
    Profile { time, points, errors: errors(contact, exact) }
}

impl Run {
    fn work_per_step(&self) -> f64 {
        let work = self.reports.iter().skip(1).map(StepReport::convolution_equivalents);
        work.sum::<f64>() / (self.reports.len() - 1) as f64
    }

    fn print(&self, scene: &StepLoadedSphere, args: &Args) {
        println!("{} half-space, {}² cells, {} steps to t = 2τ", scene.name, args.cells, args.steps);
        println!(
            "{:>6} {:>12} {:>9} {:>14} {:>9} {:>12} {:>9} {:>9}",
            "t/τ", "radius [m]", "error", "p(0) [Pa]", "error", "approach [m]", "error", "L1 of p"
        );
        for Profile { time, points, errors } in &self.profiles {
            let report = self.reports.iter().find(|report| report.time == *time);
            let radius = self.exact.contact_radius(*time) * (1.0 + errors.contact_radius);
            println!(
                "{:6.2} {:12.5e} {:9.1e} {:14.6e} {:9.1e} {:12.5e} {:9.1e} {:9.1e}",
                time / scene.tau,
                radius,
                errors.contact_radius,
                points[0][1],
                errors.central_pressure,
                report.map_or(f64::NAN, |report| report.approach),
                errors.approach,
                errors.l1
            );
        }
        println!(
            "{:.2} convolution equivalents a step, the jump {:.2}; {:.2} s",
            self.work_per_step(),
            self.reports[0].convolution_equivalents(),
            self.seconds
        );
    }

    fn write_tables(&self, scene: &StepLoadedSphere, folder: &Path) -> Result<(), Box<dyn Error>> {
        let mut table = csv::Writer::from_path(file(folder, "profiles", scene, "csv"))?;
        table.write_record(["time_s", "r_m", "pressure_pa", "exact_pressure_pa"])?;
        for profile in &self.profiles {
            for [r, p, exact] in &profile.points {
                table.serialize((profile.time, r, p, exact))?;
            }
        }
        table.flush()?;
        let mut table = csv::Writer::from_path(file(folder, "history", scene, "csv"))?;
        table.write_record([
            "time_s",
            "contact_radius_m",
            "exact_contact_radius_m",
            "approach_m",
            "exact_approach_m",
            "force_n",
            "iterations",
            "convolutions",
            "preconditioner_applications",
            "residual",
        ])?;
        for (report, radius) in self.reports.iter().zip(&self.radii) {
            let (a, approach) = (self.exact.contact_radius(report.time), self.exact.approach(report.time));
            table.serialize((
                report.time,
                radius,
                a,
                report.approach,
                approach,
                report.force,
                report.iterations,
                report.convolutions,
                report.preconditioner_applications,
                report.residual,
            ))?;
        }
        Ok(table.flush()?)
    }

    fn plot_profiles(&self, scene: &StepLoadedSphere) -> Result<Chart, Box<dyn Error>> {
        let title = format!("Pressure under a step-loaded sphere, {} half-space", scene.name);
        let [x, y] = ["r / Hertz radius at t = 0", "p / Hertz pressure at t = 0"];
        let mut chart = Chart::new(&title, x, y, Legend::UpperRight);
        let (a, p) = (self.hertz.contact_radius, self.hertz.max_pressure);
        for (profile, color) in self.profiles.iter().zip(COLORS) {
            let edge = self.exact.contact_radius(profile.time);
            // dense near the rim, where the profile falls like a root
            let radii = (0..=200).map(|k| edge * (1.0 - (1.0 - k as f64 / 200.0).powi(2)));
            let line = radii.map(|r| (r / a, self.exact.pressure(r, profile.time) / p)).collect();
            chart.add(format!("t = {} τ, closed form", profile.time / scene.tau), color, Style::Line, line);
            let stride = profile.points.len().div_ceil(40);
            let dots = profile.points.iter().step_by(stride).filter(|point| point[1] > 0.0);
            let dots = dots.map(|point| (point[0] / a, point[1] / p)).collect();
            chart.add(if profile.time == 0.0 { "computed (dots)" } else { "" }, color, Style::Dots, dots);
        }
        Ok(chart)
    }

    fn add_growth(&self, scene: &StepLoadedSphere, chart: &mut Chart, color: Color) {
        let unit = self.hertz.contact_radius;
        let times = (0..=200).map(|k| scene.duration * k as f64 / 200.0);
        let line = times.map(|t| (t / scene.tau, self.exact.contact_radius(t) / unit)).collect();
        chart.add(format!("{}, closed form", scene.name), color, Style::Line, line);
        let states = self.reports.iter().zip(&self.radii).step_by(self.reports.len().div_ceil(34));
        let dots = states.map(|(report, radius)| (report.time / scene.tau, radius / unit)).collect();
        chart.add(format!("{}, computed", scene.name), color, Style::Dots, dots);
    }
}

/// The error at t = 2τ over the number of steps, without the correction of past steps and with it.
fn add_convergence(
    scene: &StepLoadedSphere,
    args: &Args,
    chart: &mut Chart,
    colors: [Color; 2],
) -> Result<(), Box<dyn Error>> {
    let mut table = csv::Writer::from_path(file(&args.output, "convergence", scene, "csv"))?;
    table.write_record(["rule", "steps", "central_pressure_error", "l1_error", "approach_error"])?;
    let rules = [("linear rule", TimeRule::ExponentialLinear), ("default rule", TimeRule::Exponential)];
    let progress = bar(2 * STEP_COUNTS.iter().sum::<usize>(), format!("{} convergence", scene.name))?;
    for ((name, time_rule), color) in rules.into_iter().zip(colors) {
        let mut points = Vec::new();
        for steps in STEP_COUNTS {
            // the solver below the errors in time that are shown
            let settings = Settings::default().with_tolerance(args.tolerance.min(1e-6)).with_time_rule(time_rule);
            let (contact, _) = scene.run(args.cells / 2, steps, settings)?;
            let error = errors(&contact, &scene.reference()?);
            table.serialize((name, steps, error.central_pressure, error.l1, error.approach))?;
            points.push((steps as f64, error.central_pressure.abs()));
            progress.inc(steps as u64);
        }
        chart.add(format!("{}, {name}", scene.name), color, Style::LineAndDots, points);
    }
    progress.finish_and_clear();
    Ok(table.flush()?)
}

fn file(folder: &Path, name: &str, scene: &StepLoadedSphere, extension: &str) -> PathBuf {
    folder.join(format!("{name}_{}.{extension}", scene.name.to_lowercase()))
}
