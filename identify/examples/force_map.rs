//! A map of a thousand force curves, each identified for itself on all threads: two gels beside each other.
//!
//! Every curve has its own contact point. The picture has the identified moduli along the map. The time of one fit is printed.
//!
//! `cargo run --release -p viscocontact-identify --features plot --example force_map`

mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use clap::Parser;
use viscocontact::plot::{COLORS, Chart, Legend, Quantity, Style};
use viscocontact::states::ElasticStates;
use viscocontact_identify::{Curve, Experiment, Identification, Model, Nuisance, Protocol};

/// A map of force curves.
#[derive(Parser)]
struct Args {
    /// Number of curves.
    #[arg(long, default_value_t = 1000)]
    curves: usize,
    /// Points of a curve.
    #[arg(long, default_value_t = 1000)]
    points: u32,
    /// Forty curves.
    #[arg(long)]
    quick: bool,
    /// Folder for the picture.
    #[arg(long, default_value = "out/force_map")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let count = if args.quick { 40 } else { args.curves };
    let bead = ElasticStates::sphere(5.0e-6)?;
    let zener = Identification::new(Model::Zener);
    // 0.2 µm of air, 0.6 µm of gel, held for half of the time
    let times: Vec<f64> = (0..args.points).map(|k| 2.0 * f64::from(k) / f64::from(args.points - 1)).collect();
    let drive = |t: f64| 0.8e-6 * (t / 0.4).min(1.0).min((2.0 - t) / 0.4) - 0.2e-6;
    let protocol = Protocol::new(times.clone(), times.iter().map(|&t| drive(t)).collect())?;
    let experiment = Experiment::new(protocol, bead).with_spring(0.1)?;
    let heights = support::noise(count, 2.0e-8, 0.0, 3);
    let stiff = |k: usize| k >= count / 2;
    let mut curves = Vec::new();
    for (k, height) in heights.into_iter().enumerate() {
        let modulus = if stiff(k) { 8.0e3 } else { 3.0e3 };
        let body = [("E0", modulus), ("Einf", 0.3 * modulus), ("tau", 0.3)];
        let height = Nuisance::Fixed(height);
        let samples = zener.clone().contact_point(height).respond(&experiment, &body)?;
        let noise = support::noise(samples.len(), 2.0e-11, 0.0, 4 + k as u64);
        let force = samples.iter().zip(noise).map(|(sample, noise)| sample.force + noise).collect();
        curves.push(Curve::new(experiment.clone(), force)?);
    }
    let bar = support::progress(count as u64);
    let start = Instant::now();
    let fits = zener.contact_point(Nuisance::Fitted).fit_each(&curves, |_| bar.inc(1));
    bar.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();
    println!("{count} curves of {} points in {seconds:.1} s: {:.1} ms each", args.points, 1e3 * seconds / count as f64);

    let mut chart = Chart::new("Identified modulus", "curve", Quantity::new("E0", "Pa"), Legend::UpperLeft);
    let (mut points, mut missed) = (Vec::new(), 0);
    for (k, fit) in fits.iter().enumerate() {
        let fit = fit.as_ref().map_err(|error| format!("curve {k}: {error}"))?;
        let Some(glassy) = fit.estimate("E0") else { continue };
        let truth = if stiff(k) { 8.0e3 } else { 3.0e3 };
        missed += usize::from(!(glassy.interval[0]..=glassy.interval[1]).contains(&truth));
        points.push((k as f64, glassy.value));
    }
    println!("{:.1} % of the 95 % intervals of E0 miss the truth", 100.0 * missed as f64 / count as f64);
    chart.add("glassy modulus", COLORS[0], Style::Dots, points);
    chart.save(args.output.join("map.png"))?;
    println!("the picture is {}", args.output.join("map.png").display());
    Ok(())
}
