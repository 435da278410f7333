//! PMMA under a force that oscillates: the energy lost in each cycle over nine decades of frequency, against the complex
//! compliance. It is one of the two systems that the source paper builds on; S. Spinu, D. Cerlinca, *Adv. Tribol.* 2018,
//! 9432894, press a sphere onto PMMA in the same way. The material is the one that `viscocontact::rheology::library`
//! names, with its source.
//!
//! A flat punch of radius a has a fixed contact. Force and approach then form a linear system,
//! ω(t) = ∫ C(t − s) dW(s) / 2a. Under W = Wm + Wa cos Ωt, with C*(Ω) = C′ − iC″, the approach settles to
//! ωm + (Wa/2a) (C′ cos Ωt + C″ sin Ωt), and a cycle costs
//!
//! ΔW = ∮ W dω = π Wa² C″(Ω) / 2a
//!
//! whatever the mean force. Under a ball the contact grows and shrinks in each cycle. For small amplitudes this changes
//! nothing, a being the radius under the mean force, a³ = ¾ R Wm C(t); for large ones the difference is shown. The
//! reference of the ball is the one-dimensional foundation (method of dimensionality reduction).
//!
//! `cargo run --release -p viscocontact --features data,plot,states --example cyclic_pmma`

#[path = "support/scenes/oscillation.rs"]
mod oscillation;
mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use oscillation::{Cycle, Oscillation};
use viscocontact::Result;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSpectrum, library};

/// PMMA under a punch and under a ball, pressed by a force that oscillates.
#[derive(Parser)]
struct Args {
    /// Poisson's ratio, constant; it is not published with the data.
    #[arg(long, default_value_t = 0.35)]
    poisson: f64,
    /// Mean force [N].
    #[arg(long, default_value_t = 1.0)]
    mean: f64,
    /// Radius of the punch [m].
    #[arg(long, default_value_t = 0.5e-3)]
    punch: f64,
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 5.0e-3)]
    ball: f64,
    /// Frequency in the table over the amplitude [Hz].
    #[arg(long, default_value_t = 1.0e-3)]
    frequency: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Steps in the last cycle, at least.
    #[arg(long, default_value_t = 64)]
    steps: u32,
    /// Error in time of each step.
    #[arg(long, default_value_t = 1.0e-5)]
    tolerance: f64,
    /// Coarse and fast: 48 cells, 32 steps.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/cyclic_pmma")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        (args.cells, args.steps) = (48, 32);
    }
    support::finish(run(&args));
}

/// PMMA as published, with the Poisson's ratio of the flags.
struct Body {
    material: Material,
    /// C(t) as a series.
    creep: CreepSpectrum,
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let published = library::find("PMMA")?;
    println!("{}: {}\n({})", published.name, published.reference, published.remark);
    let material = published.material(args.poisson)?;
    let creep = material.contact_spectrum()?.ok_or("a Prony series has a spectrum")?;
    let body = Body { material, creep };
    over_frequency(args, &body)?;
    over_amplitude(args, &body)?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// The last cycle under the ball: computed, and on the one-dimensional foundation.
fn under_ball(args: &Args, body: &Body, force: Oscillation) -> Result<[Cycle; 2]> {
    // a force of twice the mean at the last time bounds the contact
    let widest = 2f64.cbrt() * force.radius_under_mean(&body.material, args.ball);
    let mut contact = ViscoelasticContact::builder(Grid::square(args.cells, 2.1 * widest)?)
        .geometry(&Sphere::new(args.ball)?)
        .material(body.material.clone())
        .build()?;
    Ok([force.follow(&mut contact, args.steps, args.tolerance)?, on_foundation(args, body, force)?])
}

/// The ball in closed form, by the elastic states of the one-dimensional foundation.
fn on_foundation(args: &Args, body: &Body, force: Oscillation) -> Result<Cycle> {
    let foundation = StatesContact::new(&ElasticStates::sphere(args.ball)?, &body.material)?;
    // its own error in time is 1e-3 at the lowest frequencies; with twice the steps the ball errs by 4e-4 at most
    force.follow_on(foundation, 4 * args.steps)
}

/// The loss per cycle over the frequency, under punch and ball.
fn over_frequency(args: &Args, body: &Body) -> Result<(), Box<dyn Error>> {
    let swing = |frequency: f64| Oscillation { mean: args.mean, amplitude: 0.5 * args.mean, frequency };
    println!("\nforce of {} ± {} N, {}² cells", args.mean, 0.5 * args.mean, args.cells);
    println!("{:>27}{:>45}", "punch", "ball");
    println!(
        "{:>8} {:>11} {:>11} {:>8} {:>8} {:>12} {:>11} {:>8} {:>9}",
        "f [Hz]", "loss [J]", "exact", "error", "in time", "loss [J]", "foundation", "error", "/ fixed"
    );
    let mut table = csv::Writer::from_path(args.output.join("frequency.csv"))?;
    table.write_record([
        "frequency_hz",
        "punch_loss_j",
        "punch_exact_j",
        "ball_loss_j",
        "ball_foundation_j",
        "ball_fixed_contact_j",
    ])?;
    let mut dots = [const { Vec::new() }; 2];
    let count: u32 = if args.quick { 4 } else { 10 };
    let progress = support::progress(count.into());
    for k in 0..count {
        let force = swing(10f64.powf(-8.0 + 9.0 * f64::from(k) / f64::from(count - 1)));
        let mut punch = ViscoelasticContact::builder(Grid::square(args.cells, 2.1 * args.punch)?)
            .geometry(&FlatPunch::circular(args.punch)?)
            .material(body.material.clone())
            .build()?;
        let loss = force.follow(&mut punch, args.steps, args.tolerance)?.loss();
        let exact = force.loss_of_fixed_contact(&body.creep, args.punch);
        // with 2a as the cells have it, the error in time is left
        let on_mesh = force.loss_of_fixed_contact(&body.creep, 0.5 * punch.fields().stiffness_over_modulus()?);
        let [ball, foundation] = under_ball(args, body, force)?.map(|cycle| cycle.loss());
        let fixed = force.loss_of_fixed_contact(&body.creep, force.radius_under_mean(&body.material, args.ball));
        progress.suspend(|| {
            println!(
                "{:8.1e} {loss:11.4e} {exact:11.4e} {:8.1e} {:8.1e} {ball:12.4e} {foundation:11.4e} {:8.1e} {:9.4}",
                force.frequency,
                loss / exact - 1.0,
                loss / on_mesh - 1.0,
                ball / foundation - 1.0,
                ball / fixed
            );
        });
        table.serialize((force.frequency, loss, exact, ball, foundation, fixed))?;
        dots[0].push((force.frequency, loss));
        dots[1].push((force.frequency, ball));
        progress.inc(1);
    }
    progress.finish_and_clear();
    table.flush()?;
    let title = "PMMA: energy lost in a cycle";
    let mut chart = Chart::new(title, "frequency [Hz]", "loss per cycle [J]", Legend::UpperRight);
    chart.scale = Scale::LogLog;
    let fixed = |radius: &dyn Fn(&Oscillation) -> f64| {
        let forces = (0..=90).map(|k| swing(10f64.powf(-8.0 + 0.1 * f64::from(k))));
        forces.map(|force| (force.frequency, force.loss_of_fixed_contact(&body.creep, radius(&force)))).collect()
    };
    let under_mean = |force: &Oscillation| force.radius_under_mean(&body.material, args.ball);
    chart.add("flat punch: π Wa² |Im C*| / 2a", COLORS[0], Style::Line, fixed(&|_| args.punch));
    chart.add("ball: the same, a as under the mean force", COLORS[1], Style::Line, fixed(&under_mean));
    for (label, dots) in ["computed", ""].into_iter().zip(dots) {
        chart.add(label, COLORS[6], Style::Dots, dots);
    }
    Ok(chart.save(args.output.join("frequency.png"))?)
}

/// Loss in the changing contact of the ball over the amplitude, and the loop of force and approach.
fn over_amplitude(args: &Args, body: &Body) -> Result<(), Box<dyn Error>> {
    println!("\nball at {} Hz: loss over that of a fixed contact", args.frequency);
    println!("{:>7} {:>10} {:>11} {:>8}", "Wa / Wm", "computed", "foundation", "error");
    let mut table = csv::Writer::from_path(args.output.join("amplitude.csv"))?;
    table.write_record(["amplitude_over_mean", "loss_over_fixed", "foundation_over_fixed"])?;
    let mut curves = [const { Vec::new() }; 2];
    let count: u32 = if args.quick { 2 } else { 10 };
    for share in (1..=count).map(|k| f64::from(k) / f64::from(count)) {
        let force = Oscillation { mean: args.mean, amplitude: share * args.mean, frequency: args.frequency };
        let radius = force.radius_under_mean(&body.material, args.ball);
        let cycles = under_ball(args, body, force)?;
        let fixed = force.loss_of_fixed_contact(&body.creep, radius);
        let [ratio, exact] = cycles.each_ref().map(|cycle| cycle.loss() / fixed);
        println!("{share:7} {ratio:10.5} {exact:11.5} {:8.1e}", ratio / exact - 1.0);
        // twice between two amplitudes: the curve is smooth
        for part in [2.0 / 3.0, 1.0 / 3.0] {
            let share = share - part / f64::from(count);
            let force = Oscillation { amplitude: share * args.mean, ..force };
            let fixed = force.loss_of_fixed_contact(&body.creep, radius);
            curves[0].push((share, on_foundation(args, body, force)?.loss() / fixed));
        }
        table.serialize((share, ratio, exact))?;
        curves[0].push((share, exact));
        curves[1].push((share, ratio));
        if share == 1.0 {
            save_loop(args, cycles, force.ellipse(&body.creep, radius))?;
        }
    }
    table.flush()?;
    let title = format!("A ball on PMMA at {} Hz: loss over that of a fixed contact", args.frequency);
    let mut chart = Chart::new(title, "amplitude / mean force", "loss / (π Wa² |Im C*| / 2a)", Legend::UpperLeft);
    let [exact, computed] = curves;
    chart.add("flat punch: fixed contact", COLORS[0], Style::Line, vec![(0.0, 1.0), (1.0, 1.0)]);
    chart.add("ball: one-dimensional foundation", COLORS[1], Style::Line, exact);
    chart.add("ball: computed", COLORS[6], Style::Dots, computed);
    Ok(chart.save(args.output.join("amplitude.png"))?)
}

fn save_loop(args: &Args, [computed, exact]: [Cycle; 2], fixed: Vec<(f64, f64)>) -> Result<(), Box<dyn Error>> {
    let mut chart = Chart::new(
        format!("A cycle of a ball on PMMA at {} Hz, force between 0 and twice its mean", args.frequency),
        Quantity::new("approach − mean", "m"),
        Quantity::new("force − mean", "N"),
        Legend::UpperLeft,
    );
    chart.add("if the contact were fixed", COLORS[0], Style::Line, fixed);
    chart.add("one-dimensional foundation", COLORS[1], Style::Line, exact.about_means().collect());
    chart.add("computed", COLORS[6], Style::Dots, computed.about_means().step_by(2).collect());
    Ok(chart.save(args.output.join("loop.png"))?)
}
