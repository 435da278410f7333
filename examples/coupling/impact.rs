//! A ball strikes a creeping half-space: the contact is a part of an equation of motion that another crate integrates.
//!
//! Mass and contact are coupled step by step. The integrator (Runge–Kutta of fourth order, `ode_solvers`) asks for the
//! force at times and approaches within a step, and gets it from a copy of the contact that is advanced to there; when
//! the step is done, the contact itself follows. Since the displacement is taken to be linear in a step, the whole is
//! of second order, which is measured.
//!
//! Compared are: the duration of an elastic impact, 2.943 δ/v with δ = (15 m v²/16 E* √R)^(2/5) (Johnson, *Contact
//! Mechanics*, 1985, §11.4), and its restitution, 1; the restitution of a slowly relaxing Maxwell body, 1 − (4/9) T/τ
//! (Hunter, *J. Mech. Phys. Solids* 8, 1960), T being the elastic duration; and for any T/τ the same equation of motion
//! on a one-dimensional foundation (method of dimensionality reduction; Popov & Heß, 2015).
//!
//! `cargo run --release -p viscocontact-coupling --bin impact`

#[path = "../support/mod.rs"]
mod support;

use std::cell::RefCell;
use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use indicatif::ProgressBar;
use ode_solvers::{Rk4, System, Vector2};
use viscocontact::Result;
use viscocontact::output::Field;
use viscocontact::plot::{Animation, COLORS, Chart, Legend, Quantity, Scale, Style};
use viscocontact::prelude::*;

/// A ball strikes a creeping half-space.
#[derive(Parser)]
struct Args {
    /// Glassy shear modulus of the incompressible half-space [Pa].
    #[arg(long, default_value_t = 1.0e6)]
    modulus: f64,
    /// Mass of the ball [kg].
    #[arg(long, default_value_t = 0.03)]
    mass: f64,
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 10.0e-3)]
    radius: f64,
    /// Its velocity [m/s].
    #[arg(long, default_value_t = 0.3)]
    velocity: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 96)]
    cells: usize,
    /// Steps in the duration of the elastic impact.
    #[arg(long, default_value_t = 100)]
    steps: usize,
    /// Coarse and fast: 32 cells, 50 steps.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/impact")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (32, 50);
    }
    support::finish(run(&args));
}

/// m dv/dt = −F within a step, y = (approach, velocity).
struct Motion<'a, C> {
    contact: &'a C,
    mass: f64,
    /// Force at the start of the step.
    force: f64,
    failed: &'a RefCell<Option<viscocontact::Error>>,
}

impl<C: Contact> System<f64, Vector2<f64>> for Motion<'_, C> {
    fn system(&self, t: f64, y: &Vector2<f64>, dy: &mut Vector2<f64>) {
        let step = |t, approach| Ok(self.contact.clone().step(t, Load::approach(approach))?.force);
        let force = if t > 0.0 { step(t, y[0]) } else { Ok(self.force) };
        let force = force.unwrap_or_else(|error| {
            // the integrator takes no errors: they are reported afterwards
            self.failed.borrow_mut().get_or_insert(error);
            0.0
        });
        *dy = Vector2::new(y[1], -force / self.mass);
    }
}

/// A state of the motion.
#[derive(Clone, Copy)]
struct Moment {
    time: f64,
    approach: f64,
    velocity: f64,
    force: f64,
    /// Done against the contact since the start [J].
    work: f64,
}

/// Follows the ball from the first touch until it leaves; `seen` is shown each state.
fn strike<C: Contact>(
    args: &Args,
    mut contact: C,
    dt: f64,
    mut seen: impl FnMut(&Moment, &C) -> Result<(), Box<dyn Error>>,
) -> Result<Vec<Moment>, Box<dyn Error>> {
    let mut now = Moment { time: 0.0, approach: 0.0, velocity: args.velocity, force: 0.0, work: 0.0 };
    let mut all = vec![now];
    while all.len() == 1 || now.velocity > 0.0 || now.force > 0.0 {
        let failed = RefCell::new(None);
        let motion = Motion { contact: &contact, mass: args.mass, force: now.force, failed: &failed };
        let mut integrator = Rk4::new(motion, 0.0, Vector2::new(now.approach, now.velocity), dt, dt);
        integrator.integrate()?;
        let end = *integrator.y_out().last().ok_or("the integrator took no step")?;
        drop(integrator);
        if let Some(error) = failed.into_inner() {
            return Err(error.into());
        }
        let force = contact.step(dt, Load::approach(end[0]))?.force;
        let work = now.work + 0.5 * (now.force + force) * (end[0] - now.approach);
        now = Moment { time: now.time + dt, approach: end[0], velocity: end[1], force, work };
        all.push(now);
        seen(&now, &contact)?;
        if all.len() > 100_000 {
            return Err("the ball does not leave".into());
        }
    }
    Ok(all)
}

impl Args {
    /// Greatest approach [m] and duration [s] of the elastic impact: Johnson's (11.23) and (11.24).
    fn elastic(&self) -> [f64; 2] {
        let modulus = 4.0 * self.modulus;
        let energy = 15.0 * self.mass * self.velocity.powi(2) / (16.0 * modulus * self.radius.sqrt());
        let depth = energy.powf(0.4);
        // 2 ∫ dζ / √(1 − ζ^(5/2)) from 0 to 1
        [depth, 2.943_275 * depth / self.velocity]
    }

    fn foundation(&self, material: &Material) -> Result<StatesContact> {
        StatesContact::new(&ElasticStates::sphere(self.radius)?, material)
    }

    /// The whole contact, on a grid that holds a contact of the radius `widest`.
    fn contact(&self, material: &Material, widest: f64) -> Result<ViscoelasticContact> {
        ViscoelasticContact::builder(Grid::square(self.cells, 2.2 * widest)?)
            .geometry(&Sphere::new(self.radius)?)
            .material(material.clone())
            .build()
    }

    /// How much of the energy at the start is missing from a state.
    fn imbalance(&self, now: &Moment) -> f64 {
        let first = self.velocity.powi(2);
        (now.velocity.powi(2) - first) / first + now.work / (0.5 * self.mass * first)
    }

    fn restitution(&self, all: &[Moment]) -> f64 {
        all.last().map_or(f64::NAN, |last| -last.velocity / self.velocity)
    }
}

/// A Maxwell body, or a Zener body that relaxes to a third, with the relaxation time `tau`.
fn material(args: &Args, maxwell: bool, tau: f64) -> Result<Material> {
    Ok(if maxwell {
        Material::incompressible(Maxwell::with_time(args.modulus, tau)?)
    } else {
        // relaxed modulus G Gk / (G + Gk), relaxation time η / (G + Gk)
        Material::incompressible(Zener::with_time(args.modulus, 0.5 * args.modulus, 3.0 * tau)?)
    })
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let [depth, duration] = args.elastic();
    let dt = duration / args.steps as f64;
    println!("elastic impact: {:.4} mm deep, {:.4} ms long", depth * 1e3, duration * 1e3);
    order(args)?;

    println!("\n{}² cells, {} steps in an elastic impact", args.cells, args.steps);
    println!(
        "{:>8} {:>8} {:>12} {:>12} {:>12} {:>12} {:>10}",
        "body", "T/τ", "restitution", "foundation", "Hunter", "imbalance", "work/E0"
    );
    let mut table = csv::Writer::from_path(args.output.join("restitution.csv"))?;
    table.write_record(["body", "duration_over_tau", "restitution", "foundation", "imbalance"])?;
    let mut forces = Chart::new(
        "A ball strikes a half-space: lines one-dimensional foundation, dots computed",
        Quantity::new("time", "s"),
        Quantity::new("force", "N"),
        Legend::UpperRight,
    );
    let mut dots = [Vec::new(), Vec::new()];
    let scenes = [("elastic", 0.0), ("Maxwell", 0.1), ("Maxwell", 0.3), ("Maxwell", 1.0), ("Maxwell", 3.0)];
    let scenes = scenes.into_iter().chain([0.03, 0.3, 3.0, 30.0].map(|ratio| ("Zener", ratio)));
    let progress = ProgressBar::new(9);
    for (k, (body, ratio)) in scenes.enumerate() {
        let material = match body {
            "elastic" => Material::incompressible(Elastic::new(args.modulus)?),
            _ => material(args, body == "Maxwell", duration / ratio)?,
        };
        let mut widest: f64 = 0.0;
        let reference = strike(args, args.foundation(&material)?, 0.25 * dt, |_, foundation| {
            widest = widest.max((foundation.contact_area() / std::f64::consts::PI).sqrt());
            Ok(())
        })?;
        let shown = body == "Maxwell" && ratio == 1.0;
        // Hertz's at the greatest depth of the elastic impact
        let peak = 8.0 / std::f64::consts::PI * args.modulus * (depth / args.radius).sqrt();
        let mut animation = if shown {
            Some(Animation::create(args.output.join("impact.gif"), Field::Pressure, [0.0, peak], 0.08)?)
        } else {
            None
        };
        let mut count = 0;
        let computed = strike(args, args.contact(&material, widest)?, dt, |_, contact| {
            count += 1;
            match &mut animation {
                Some(animation) if count % (args.steps / 25).max(1) == 0 => Ok(animation.record(contact)?),
                _ => Ok(()),
            }
        })?;
        if let Some(animation) = animation {
            animation.finish()?;
        }
        let (e, exact) = (args.restitution(&computed), args.restitution(&reference));
        let worst = computed.iter().fold(0.0_f64, |worst, now| worst.max(args.imbalance(now).abs()));
        let work = computed[computed.len() - 1].work / (0.5 * args.mass * args.velocity.powi(2));
        let hunter = if body == "Zener" { "-".into() } else { format!("{:.5}", 1.0 - 4.0 / 9.0 * ratio) };
        progress
            .suspend(|| println!("{body:>8} {ratio:8} {e:12.5} {exact:12.5} {hunter:>12} {worst:12.1e} {work:10.5}"));
        table.serialize((body, ratio, e, exact, worst))?;
        if body != "Zener" && ratio != 0.3 {
            let label = if ratio == 0.0 { "elastic".into() } else { format!("Maxwell, T/τ = {ratio}") };
            let points = |all: &[Moment], step: usize| all.iter().step_by(step).map(|m| (m.time, m.force)).collect();
            forces.add(label, COLORS[k], Style::Line, points(&reference, 1));
            forces.add("", COLORS[k], Style::Dots, points(&computed, (args.steps / 25).max(1)));
        }
        if ratio > 0.0 {
            dots[usize::from(body == "Zener")].push((ratio, e));
        }
        if shown {
            energy(args, &computed)?;
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    table.flush()?;
    forces.save(args.output.join("force.png"))?;
    restitution(args, dots)?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// The order in time, on the foundation, which costs nothing: errors against sixteen times as many steps.
fn order(args: &Args) -> Result<(), Box<dyn Error>> {
    let duration = args.elastic()[1];
    let foundation = args.foundation(&material(args, true, duration)?)?;
    let at = |steps: usize| -> Result<[f64; 2], Box<dyn Error>> {
        let all = strike(args, foundation.clone(), duration / steps as f64, |_, _| Ok(()))?;
        Ok([args.restitution(&all), all.iter().fold(0.0, |worst, now| f64::max(worst, args.imbalance(now).abs()))])
    };
    let exact = at(16 * args.steps)?[0];
    println!("\nMaxwell body, T/τ = 1, foundation: restitution {exact:.6}");
    println!("{:>8} {:>14} {:>12}", "steps", "error", "imbalance");
    for steps in [args.steps / 2, args.steps, 2 * args.steps] {
        let [e, imbalance] = at(steps)?;
        println!("{steps:8} {:14.2e} {imbalance:12.2e}", e - exact);
    }
    Ok(())
}

/// Where the energy is, over time.
fn energy(args: &Args, all: &[Moment]) -> Result<(), Box<dyn Error>> {
    let mut chart = Chart::new(
        "Energy of a ball that strikes a Maxwell body, T/τ = 1",
        Quantity::new("time", "s"),
        Quantity::new("energy", "J"),
        Legend::MiddleLeft,
    );
    let kinetic = |now: &Moment| 0.5 * args.mass * now.velocity.powi(2);
    let curve = |of: &dyn Fn(&Moment) -> f64| all.iter().map(|now| (now.time, of(now))).collect::<Vec<_>>();
    chart.add("kinetic", COLORS[0], Style::Line, curve(&kinetic));
    chart.add("work done on the body", COLORS[1], Style::Line, curve(&|now| now.work));
    chart.add("both", COLORS[6], Style::Line, curve(&|now| kinetic(now) + now.work));
    Ok(chart.save(args.output.join("energy.png"))?)
}

/// Restitution over the duration of the elastic impact in relaxation times.
fn restitution(args: &Args, dots: [Vec<(f64, f64)>; 2]) -> Result<(), Box<dyn Error>> {
    let duration = args.elastic()[1];
    let mut chart = Chart::new(
        "Coefficient of restitution",
        "duration of the elastic impact / relaxation time",
        "restitution",
        Legend::LowerLeft,
    );
    chart.scale = Scale::LogX;
    let ratios: Vec<f64> = (0..=108).map(|k| 10f64.powf(-2.0 + f64::from(k) / 27.0)).collect();
    let names = ["Maxwell, foundation", "relaxes to a third (Zener), foundation"];
    for ((name, maxwell), color) in names.into_iter().zip([true, false]).zip(COLORS) {
        let mut curve = Vec::new();
        for &ratio in ratios.iter().filter(|&&ratio| !maxwell || ratio < 10.0) {
            let foundation = args.foundation(&material(args, maxwell, duration / ratio)?)?;
            let all = strike(args, foundation, 0.5 * duration / args.steps as f64, |_, _| Ok(()))?;
            curve.push((ratio, args.restitution(&all)));
        }
        chart.add(name, color, Style::Line, curve);
    }
    let hunter = ratios.iter().filter(|ratio| **ratio < 1.0).map(|&ratio| (ratio, 1.0 - 4.0 / 9.0 * ratio)).collect();
    chart.add("Hunter (1960), slow relaxation", COLORS[2], Style::Line, hunter);
    let [maxwell, zener] = dots;
    chart.add("computed", COLORS[6], Style::Dots, maxwell);
    chart.add("", COLORS[6], Style::Dots, zener);
    Ok(chart.save(args.output.join("restitution.png"))?)
}
