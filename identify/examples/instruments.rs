//! Six instruments: from the file that each of them exports to the material, in a function of a few lines for each. Copy the one of your
//! instrument.
//!
//! The files are computed: curves of one body with 0.5 % of noise, in the layout, the units and with the faults of each instrument. The
//! parameters that are found must be those of the body.
//!
//! `cargo run --release -p viscocontact-identify --example instruments`

mod support;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use viscocontact::TextFormat;
use viscocontact::states::ElasticStates;
use viscocontact_identify::{
    Experiment, Fit, FitWarning, Identification, Model, Nuisance, Protocol, Recording, Result,
};

/// Files of six instruments.
#[derive(Parser)]
struct Args {
    /// As without: it takes a second.
    #[arg(long)]
    quick: bool,
    /// Folder for the files.
    #[arg(long, default_value = "out/instruments")]
    output: PathBuf,
}

/// JPK: names and units stand in comments; the deflection is in metres.
fn jpk(file: &Path) -> Result<Fit> {
    let (bead, stiffness) = (ElasticStates::sphere(5.0e-6)?, 0.05);
    let curve = Recording::from_csv(file, TextFormat::default())?.spring_curve(&bead, stiffness)?;
    Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted).fit(&[curve])
}

/// Chiaro of Optics11: tabs, below 36 lines of settings; load and position are taken, the cantilever is left.
fn chiaro(file: &Path) -> Result<Fit> {
    let (bead, stiffness) = (ElasticStates::sphere(5.0e-6)?, 0.05);
    let curve = Recording::from_csv(file, TextFormat::default())?.spring_curve(&bead, stiffness)?;
    Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted).fit(&[curve])
}

/// A load cell whose program writes decimal commas.
fn load_cell(file: &Path) -> Result<Fit> {
    let (bead, stiffness) = (ElasticStates::sphere(5.0e-6)?, 0.05);
    let format = TextFormat::default().with_decimal_comma(true);
    let curve = Recording::from_csv(file, format)?.spring_curve(&bead, stiffness)?;
    Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted).fit(&[curve])
}

/// A script of one's own: `numpy.savetxt` with a header.
fn numpy(file: &Path) -> Result<Fit> {
    let (bead, stiffness) = (ElasticStates::sphere(5.0e-6)?, 0.05);
    let curve = Recording::from_csv(file, TextFormat::default())?.spring_curve(&bead, stiffness)?;
    Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted).fit(&[curve])
}

/// A nanoindenter of Agilent: units in a row of their own; the depth is measured, so that no spring is between.
fn nanoindenter(file: &Path) -> Result<Fit> {
    let cone = ElasticStates::cone(0.7)?;
    let curve = Recording::from_csv(file, TextFormat::default())?.depth_curve(&cone)?;
    Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted).fit(&[curve])
}

/// Asylum: the position falls toward the sample, interference tilts the base line, and the tip sticks before it leaves. The whole curve
/// warns of the pull-off; until the release there is none.
fn asylum(file: &Path) -> Result<Fit> {
    let (bead, stiffness) = (ElasticStates::sphere(5.0e-6)?, 0.05);
    let curve = Recording::from_csv(file, TextFormat::default())?.flip_drive().spring_curve(&bead, stiffness)?;
    let fitting = Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted);
    let whole = fitting.fit(std::slice::from_ref(&curve))?;
    assert!(whole.warnings().iter().any(|warning| matches!(warning, FitWarning::PullOff { .. })), "{whole}");
    let cut = curve.until_release()?;
    assert!(cut.pull_off().is_none() && cut.force().len() < curve.force().len());
    fitting.tilt(Nuisance::Fitted).fit(&[cut])
}

/// The body, in pascals and seconds.
const BODY: [(&str, f64); 3] = [("E0", 4.0e3), ("Einf", 1.0e3), ("tau", 0.3)];

fn main() {
    support::finish(run(&Args::parse()));
}

fn run(args: &Args) -> std::result::Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    type Instrument = (&'static str, fn(f64, f64, f64) -> String, fn(&Path) -> Result<Fit>);
    let settings: String = (0..36).map(|k| format!("Setting {k}\t{k}\n")).collect();
    let heads = [
        "# data-description: force\n# columns: seriesTime height vDeflection\n# units: s m m\n",
        &(settings + "Time (s)\tLoad (uN)\tCantilever (nm)\tPiezo (nm)\n"),
        "Zeit\nTime (ms);Position (um);Force (nN)\n",
        "# time_s drive_m force_N\n",
        "Displacement Into Surface,Load On Sample,Time On Sample\nnm,mN,s\n",
        "Time_s,ZSnsr_um,Defl_nm\n",
    ];
    // time, drive and force of a row; the spring has 0.05 N/m
    let instruments: [Instrument; 6] = [
        ("jpk", |t, z, f| format!("{t:e} {z:e} {:e}", f / 0.05), jpk),
        ("chiaro", |t, z, f| format!("{t}\t{:e}\t{:e}\t{:e}", 1e6 * f, 1e9 * f / 0.05, 1e9 * z), chiaro),
        ("load cell", |t, z, f| format!("{:e};{:e};{:e}", 1e3 * t, 1e6 * z, 1e9 * f).replace('.', ","), load_cell),
        ("numpy", |t, z, f| format!("{t:.18e} {z:.18e} {f:.18e}"), numpy),
        ("nanoindenter", |t, z, f| format!("{:e},{:e},{t:e}", 1e9 * z, 1e3 * f), nanoindenter),
        ("asylum", |t, z, f| format!("{t:e},{:e},{:e}", -1e6 * z, 1e9 * f / 0.05), asylum),
    ];
    for (seed, ((name, row, program), head)) in (0..).zip(instruments.into_iter().zip(heads)) {
        let mut text = head.to_owned();
        for [time, drive, force] in recorded(name, seed)? {
            text += &row(time, drive, force);
            text += "\n";
        }
        let file = args.output.join(format!("{name}.txt"));
        fs::write(&file, text)?;
        let fit = program(&file).map_err(|error| format!("{name}: {error}"))?;
        println!("{name}: {fit}");
        for (parameter, truth) in BODY {
            let estimate = fit.estimate(parameter).ok_or("a parameter of the model")?;
            let error = (estimate.value / truth).ln().abs();
            if error > 4.0 * estimate.deviation + 1e-3 || error > 0.1 {
                return Err(format!("{name}: {estimate}, but the body has {truth}").into());
            }
        }
    }
    Ok(())
}

/// What an instrument records: time [s], drive or depth [m] and force [N], from 0.4 µm above the body to 1.2 µm, with a hold of 1.5 s.
fn recorded(instrument: &str, seed: u64) -> Result<Vec<[f64; 3]>> {
    let protocol = Protocol::ramp_hold_retract(4.0e-6, [0.4e-6, 1.2e-6], 1.5, 0.005)?;
    let experiment = match instrument {
        "nanoindenter" => Experiment::new(protocol.clone(), ElasticStates::cone(0.7)?),
        _ => Experiment::new(protocol.clone(), ElasticStates::sphere(5.0e-6)?).with_spring(0.05)?,
    };
    let samples = Identification::new(Model::Zener).respond(&experiment, &BODY)?;
    let greatest = samples.iter().fold(0.0, |most: f64, sample| most.max(sample.force));
    let noise = support::noise(samples.len(), 0.005 * greatest, 0.0, seed);
    let row = |(k, noise): (usize, f64)| {
        let (time, drive, mut force) = (protocol.times()[k], protocol.drive()[k], samples[k].force + noise);
        if instrument == "asylum" {
            let pull = if (2.21..2.25).contains(&time) { 0.2 * greatest } else { 0.0 };
            force += 0.02 * greatest * drive / 1.0e-6 - pull;
        }
        [time, drive, force]
    };
    Ok(noise.into_iter().enumerate().map(row).collect())
}
