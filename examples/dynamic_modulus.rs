//! From oscillation tests at several temperatures to a contact at any: isotherms of G' and G'' with 1 % noise are
//! shifted to a master curve, which gives the WLF law and a material; a ball is then pressed onto it at three
//! temperatures. The isotherms are made from a published material, so that everything can be compared.
//!
//! `cargo run --release -p viscocontact --features data,plot --example dynamic_modulus`

#[path = "support/scenes/noise.rs"]
mod noise;
mod support;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::Parser;
use noise::noise;
use viscocontact::Result;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSeries, Isotherm, MasterCurve, MaterialFunction, library};

/// A master curve of a real adhesive, and what it means in contact.
#[derive(Parser)]
struct Args {
    /// Relative noise of the moduli.
    #[arg(long, default_value_t = 0.01)]
    noise: f64,
    /// Seed of the noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Force [N].
    #[arg(long, default_value_t = 1.0)]
    load: f64,
    /// Radius of the ball [m].
    #[arg(long, default_value_t = 1.0e-3)]
    radius: f64,
    /// Cells along each side of the grid.
    #[arg(long, default_value_t = 128)]
    cells: usize,
    /// Fewer cells and steps: seconds.
    #[arg(long)]
    quick: bool,
    /// Folder for tables and pictures.
    #[arg(long, default_value = "out/dynamic_modulus")]
    output: PathBuf,
}

fn main() {
    let mut args = Args::parse();
    if args.quick {
        args.cells = 48;
    }
    support::finish(run(&args));
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let published = library::find("adhesive")?;
    println!("{}: {}", published.description, published.reference);
    let law = published.time_temperature().ok_or("the adhesive has a WLF law")?;
    let nu = published.poisson.ok_or("the adhesive has a Poisson's ratio")?;
    let truth = published.rheology(nu)?.creep_spectrum().ok_or("a Prony series has a spectrum")?.relaxation();

    // what a rheometer would give: 0.1 to 100 rad/s at nine temperatures
    let temperatures: Vec<f64> = (0..9).map(|k| 298.0 + 8.0 * f64::from(k)).collect();
    let reference = 330.0;
    let isotherms = temperatures.iter().zip(args.seed..).map(|(&temperature, seed)| {
        let mut noise = noise(seed);
        let slow = law.shift_factor(temperature)?;
        let mut rows: Vec<(f64, f64, f64)> = (0..=30)
            .map(|k| 10f64.powf(-1.0 + f64::from(k) / 10.0))
            .map(|omega| (omega, truth.complex_modulus(omega * slow).re, truth.complex_modulus(omega * slow).im))
            .collect();
        rows.iter_mut().for_each(|row| row.1 *= 1.0 + args.noise * noise());
        rows.iter_mut().for_each(|row| row.2 *= 1.0 + args.noise * noise());
        Isotherm::new(temperature, Measurements::dynamic(&rows)?)
    });
    let master = MasterCurve::new(reference, isotherms.collect::<Result<_>>()?)?;
    let body = master.fit()?;
    println!("master curve at {reference} K: {}", body.report());
    let fitted = master.wlf()?;
    let apart = |(temperature, factor): (f64, f64)| -> Result<f64> {
        let expected = law.shift_factor(temperature)? / law.shift_factor(reference)?;
        Ok((factor / expected).log10().abs())
    };
    let shifts = master.shift_factors().into_iter().map(apart).collect::<Result<Vec<f64>>>()?;
    let farthest = shifts.into_iter().fold(0.0, f64::max);
    println!("shift factors over {:.1} decades, within {farthest:.3} decades of the published law", decades(&master));
    let slow = law.shift_factor(reference)?;
    let mut worst = [0.0_f64; 2];
    let mut table = csv::Writer::from_path(args.output.join("master_curve.csv"))?;
    table.write_record(["angular_frequency_rad_per_s", "quantity", "given_pa", "fitted_pa", "published_pa"])?;
    for sample in body.report().samples() {
        let exact = truth.complex_modulus(sample.x * slow);
        let (index, name, exact) = match sample.function {
            MaterialFunction::Storage => (0, "storage modulus", exact.re),
            _ => (1, "loss modulus", exact.im),
        };
        worst[index] = worst[index].max((sample.fitted / exact - 1.0).abs());
        table.serialize((sample.x, name, sample.given, sample.fitted, exact))?;
    }
    table.flush()?;
    println!("against the published moduli: G' within {:.1} %, G'' within {:.1} %", 100.0 * worst[0], 100.0 * worst[1]);
    plot_master(args, &master, &body, |omega| truth.complex_modulus(omega * slow))?;
    contact_at(args, &body, nu, &fitted, &[310.0, 330.0, 350.0])?;
    println!("tables and pictures are in {}", args.output.display());
    Ok(())
}

/// Decades from the least shift factor to the greatest.
fn decades(master: &MasterCurve) -> f64 {
    let logs = || master.shift_factors().into_iter().map(|(_, factor)| factor.log10());
    logs().fold(f64::NEG_INFINITY, f64::max) - logs().fold(f64::INFINITY, f64::min)
}

/// A ball pressed on for an hour at several temperatures.
fn contact_at(
    args: &Args,
    body: &CreepSeries,
    nu: f64,
    law: &viscocontact::rheology::TimeTemperature,
    temperatures: &[f64],
) -> Result<(), Box<dyn Error>> {
    let (first, last, steps) = (1e-2_f64, 3.6e3_f64, 60);
    let mut chart = Chart::new("Contact radius of a ball", "time [s]", "contact radius [µm]", Legend::UpperLeft);
    chart.scale = Scale::LogX;
    let progress = support::progress((temperatures.len() * steps) as u64);
    let mut lines = Vec::new();
    for (k, &temperature) in temperatures.iter().enumerate() {
        let here = law.at(body.clone(), temperature)?;
        let known = here.known_until();
        let end = last.min(known);
        let material = Material::constant_poisson(here, nu)?;
        let widest = (0.75 * args.radius * args.load * material.contact_compliance(end)).cbrt();
        let mut contact = ViscoelasticContact::builder(Grid::square(args.cells, 2.3 * widest)?)
            .geometry(&Sphere::new(args.radius)?)
            .material(material)
            .build()?;
        contact.step(0.0, Load::force(args.load))?;
        let mut points = Vec::new();
        for step in 0..=steps {
            let time = if step == steps { end } else { first * (end / first).powf(step as f64 / steps as f64) };
            let report = contact.step(time - contact.time(), Load::force(args.load))?;
            points.push((time, 1e6 * (report.approach * args.radius).sqrt()));
            progress.inc(1);
        }
        lines.push(format!(
            "{temperature} K: contact radius {:.1} µm after {} s, {:.1} µm after {end:.0} s",
            points[0].1, points[0].0, points[steps].1
        ));
        chart.add(format!("{temperature} K"), COLORS[k], Style::LineAndDots, points);
    }
    progress.finish_and_clear();
    for line in lines {
        println!("{line}");
    }
    Ok(chart.save(args.output.join("contact_radius.png"))?)
}

fn plot_master(
    args: &Args,
    master: &MasterCurve,
    body: &CreepSeries,
    exact: impl Fn(f64) -> num_complex::Complex64,
) -> Result<(), Box<dyn Error>> {
    let [low, high] = body.report().range().ok_or("the master curve is empty")?;
    let omega: Vec<f64> = (0..=200).map(|k| low * (high / low).powf(f64::from(k) / 200.0)).collect();
    let title = format!("Master curve at {} K", master.reference());
    let mut chart = Chart::new(&title, "angular frequency [rad/s]", "modulus [Pa]", Legend::UpperLeft);
    chart.scale = Scale::LogLog;
    for (function, name, color) in [(MaterialFunction::Storage, "G'", 0), (MaterialFunction::Loss, "G''", 1)] {
        let points = master.points();
        let data = points.iter().filter(|point| point.1 == function).map(|&(x, _, value)| (x, value)).collect();
        chart.add(format!("{name}, isotherms shifted"), COLORS[color + 4], Style::Dots, data);
        let value = |omega: f64| {
            let modulus = body.spectrum().complex_modulus(omega);
            if function == MaterialFunction::Storage { modulus.re } else { modulus.im }
        };
        chart.add(format!("{name}, fit"), COLORS[color], Style::Line, omega.iter().map(|&w| (w, value(w))).collect());
    }
    chart.save(args.output.join("master_curve.png"))?;

    let mut chart = Chart::new("Loss factor", "angular frequency [rad/s]", "tan δ", Legend::UpperRight);
    chart.scale = Scale::LogX;
    let published = omega.iter().map(|&w| (w, exact(w).im / exact(w).re)).collect();
    chart.add("published", COLORS[0], Style::Line, published);
    let fit = omega.iter().step_by(4).map(|&w| (w, body.spectrum().complex_modulus(w).arg().tan())).collect();
    chart.add("from the master curve", COLORS[1], Style::Dots, fit);
    Ok(chart.save(args.output.join("loss_factor.png"))?)
}
