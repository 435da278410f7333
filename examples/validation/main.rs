//! Every claim against its reference: closed forms, the method of dimensionality reduction, formulations of another kind. Computes
//! all of them, and writes their table and pictures, which docs/maintainers/claims.md shows; fails if an error is greater than
//! allowed.
//!
//! `cargo run --release -p viscocontact --features full --example validation`

mod adhesion;
mod claim;
mod creep;
mod elastic;
mod energies;
mod friction;
mod history;
mod layers;
#[path = "../support/scenes/march.rs"]
mod march;
#[path = "../support/scenes/noise.rs"]
mod noise;
mod published;
#[path = "../support/scenes/rolling.rs"]
mod rolling;
mod sliding;
#[path = "../support/scenes/step_loaded_sphere.rs"]
mod step_loaded_sphere;
#[path = "../support/mod.rs"]
mod support;

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use claim::{Checked, Claim, Outcome};
use clap::Parser;
use step_loaded_sphere::StepLoadedSphere;
use viscocontact::plot::{COLORS, Chart, Legend, Scale, Style};

/// Computes every claim against its reference.
#[derive(Parser)]
struct Args {
    /// Folder for the table and the pictures.
    #[arg(long, default_value = "out/validation")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

fn maxwell() -> Outcome {
    creep::step_loaded(
        &StepLoadedSphere::maxwell(),
        "step-loaded sphere on a Maxwell body, 256² cells, 100 steps to 2 τ",
    )
}

fn zener() -> Outcome {
    let mut checked = creep::step_loaded(
        &StepLoadedSphere::zener(),
        "step-loaded sphere on a Zener body, 256² cells, 100 steps to 2 τ",
    )?;
    checked.curve = None; // it looks like the other
    Ok(checked)
}

const SCENES: [fn() -> Outcome; 44] = [
    elastic::convolution,
    elastic::hertz,
    elastic::hertz_ellipse,
    elastic::punch,
    elastic::wavy,
    elastic::line,
    elastic::stress_below_a_ball,
    maxwell,
    zener,
    creep::order,
    creep::step_loaded_ellipsoid,
    creep::opened_punch,
    creep::loaded_and_unloaded,
    creep::relaxing,
    creep::oscillating,
    creep::power_law,
    creep::elastic_bulk,
    history::many_times,
    history::measured,
    history::direct_sums,
    history::cone,
    creep::rolling,
    sliding::slow,
    sliding::fast,
    sliding::limits,
    sliding::wave,
    sliding::rolling_cylinder,
    sliding::rough_full_contact,
    layers::punch,
    layers::ball,
    adhesion::exponential,
    adhesion::dugdale,
    adhesion::creeping,
    adhesion::opening_edge,
    energies::held,
    energies::loop_of_a_sticking_ball,
    friction::ball,
    friction::punch,
    friction::oblique,
    friction::contact_example,
    friction::torsion,
    published::rolling_polyamide,
    published::rebound,
    published::cartilage,
];

/// The table, in Markdown.
fn table(claims: &[&Claim]) -> Result<String, std::fmt::Error> {
    let mut table = String::from(
        "| | scene | quantity | reference | computed | exact | error | allowed |\n|---|---|---|---|---|---|---|---|\n",
    );
    for (number, claim) in (1..).zip(claims) {
        let Claim { scene, quantity, reference, computed, exact, allowed } = claim;
        writeln!(
            table,
            "| {number} | {scene} | {quantity} | {reference} | {computed:.6e} | {exact:.6e} | {:.1e} | {allowed:.0e} |",
            claim.error()
        )?;
    }
    Ok(table)
}

/// Errors over what is allowed, claim by claim.
fn errors(claims: &[&Claim]) -> Chart {
    let numbered =
        |value: fn(&Claim) -> f64| (1..).map(f64::from).zip(claims.iter().map(|&claim| value(claim))).collect();
    let mut chart = Chart::new(
        "Every claim against its reference",
        "number of the claim",
        "error / allowed error",
        Legend::LowerRight,
    );
    chart.scale = Scale::LogY;
    chart.add("allowed", COLORS[0], Style::Line, numbered(|_| 1.0));
    // errors far below are drawn at the lower end of the axis
    chart.add("error", COLORS[1], Style::Dots, numbered(|claim| (claim.error() / claim.allowed).max(1.0e-4)));
    chart
}

/// Curves on theirs, each in a file.
fn save_curves(checked: &[Checked], folder: &Path) -> Result<(), Box<dyn Error>> {
    let charts: Vec<Chart> = checked.iter().filter_map(Checked::chart).collect();
    (1..).zip(&charts).try_for_each(|(k, chart)| Ok(chart.save(folder.join(format!("validation_{k}.png")))?))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let progress = support::progress(SCENES.len() as u64);
    let mut checked = Vec::new();
    for scene in SCENES {
        checked.push(scene()?);
        progress.inc(1);
    }
    progress.finish_and_clear();
    let claims: Vec<&Claim> = checked.iter().flat_map(|checked| &checked.claims).collect();
    let table = table(&claims)?;
    print!("{table}");
    errors(&claims).save(args.output.join("validation_errors.png"))?;
    save_curves(&checked, &args.output)?;
    fs::write(args.output.join("claims.md"), &table)?;
    support::figures::figure("claims", &table)?;
    let failed: Vec<String> = claims
        .iter()
        .filter(|claim| !claim.holds())
        .map(|claim| {
            format!(
                "{}: {} errs by {:.1e}, {:.0e} is allowed",
                claim.scene,
                claim.quantity,
                claim.error(),
                claim.allowed
            )
        })
        .collect();
    println!(
        "\n{} claims, {} of them fail; table and pictures are in {}",
        claims.len(),
        failed.len(),
        args.output.display()
    );
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n").into()) }
}
