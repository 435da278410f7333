//! Every claim against its reference: closed forms, the method of dimensionality reduction, formulations of another kind. Computes
//! all of them, and writes `validation.md` and its pictures, of which copies are kept in `docs`; fails if one errs by more than it may.
//!
//! `cargo run --release --features plot --example validation`

mod claim;
mod creep;
mod elastic;
mod history;
mod layers;
#[path = "../support/scenes/noise.rs"]
mod noise;
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
use indicatif::ProgressBar;
use step_loaded_sphere::StepLoadedSphere;
use viscocontact::plot::{COLORS, Chart, Legend, Picture, Scale, Style};

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

const SCENES: [fn() -> Outcome; 27] = [
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
    sliding::wave,
    layers::punch,
    layers::ball,
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

/// What the references that are derived here state, and for which shapes; the steps are beside the scenes.
const DERIVED: &str = "\
## Derived references

w = K p. An indenter that slides along x1 at v finds the surface at u(x) = C(0) w(x) + ∫ C′(s) w(x + v s) ds, s > 0, and is
resisted by F = −∫ p u′ dA; μ is F over the normal force.

* Slow sliding, v τ ≪ a: u = C∞ w + v m₁ w′ with m₁ = Σ C_k τ_k, and μ = v m₁/(R C∞) for every paraboloid of radius R along
  the motion, whatever its radius across: cylinder, sphere, ellipsoid. For other shapes without an edge, 1/R is the mean of
  ∂²h_i/∂x1², weighted by the pressure. What is left out is of the order v τ/a.
* Fast sliding, a ≪ v τ, after a slide of length L ≪ v τ from where the indenter was put down:
  F = (C′(0)/v) ∫ p(x) [w(x) − w(x + L)] dA with Hertz's p and w for C(0).
  Sphere: μ = (a²/Rv) C′(0)/C(0) [4/5 − (4a/3πL)(1 + a²/5L² + …)].
  Cylinder: μ = (a²/2Rv) C′(0)/C(0) [ln(2L/a) + 1/4 − a²/4L² − …]; steadily, with one
  retardation time, ln(2L/a) becomes ln(2vτ/a) − γ, γ = 0.5772…; with several, ln τ is their mean weighted by C_k/τ_k.
* A wave h cos(q·x) in full contact: F on a unit of area is ¼ |q| q₁ h² Im[1/C*(i q₁ v)], C*(iω) = C(0) + Σ C_k/(1 + iω τ_k).
* A cone on E ∝ t^(−β), approach t up to 1, then 2 − t: with T = t − c (t − 1), c = 2^(1/(1−β)), the radius is that at T, and
  F(t)/F(1) = t^(2−β) − 2 (t − 1)^(1−β) [(1 − β) T + t], as long as T ≥ 0.
* A step-loaded ellipsoid: the contact grows, and W = ∫ E(t − s) df(s), f being the elastic force over E* of the ellipse at s.
  Hence f = C(t) W: ω and the area follow C^(2/3).
* An opened flat punch: h = C K p − ω − α x1 on its face keeps its sign when C, ω and α grow alike.

";

/// Errors and allowed errors, claim by claim.
fn errors(claims: &[&Claim]) -> Chart {
    let numbered =
        |value: fn(&Claim) -> f64| (1..).map(f64::from).zip(claims.iter().map(|&claim| value(claim))).collect();
    let mut chart =
        Chart::new("Every claim against its reference", "number of the claim", "relative error", Legend::LowerRight);
    chart.scale = Scale::LogY;
    chart.add("allowed", COLORS[0], Style::LineAndDots, numbered(|claim| claim.allowed));
    // what agrees to the last bit has no place on a logarithmic axis
    chart.add("error", COLORS[1], Style::Dots, numbered(|claim| claim.error().max(f64::EPSILON)));
    chart
}

/// Curves beside theirs, two in a row.
fn save_rows(checked: &[Checked], folder: &Path) -> Result<usize, Box<dyn Error>> {
    let charts: Vec<Chart> = checked.iter().filter_map(Checked::chart).collect();
    for (row, charts) in (1..).zip(charts.chunks(2)) {
        let pictures = charts.iter().map(Chart::draw).collect::<Result<Vec<Picture>, _>>()?;
        Picture::beside(&pictures)?.save(folder.join(format!("validation_{row}.png")))?;
    }
    Ok(charts.len().div_ceil(2))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let progress = ProgressBar::new(SCENES.len() as u64);
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
    let rows = save_rows(&checked, &args.output)?;
    let mut text = format!(
        "# Validation\n\nWritten by `cargo run --release --features plot --example validation`, pictures included; it \
         fails if an error is greater than allowed.\n\n{table}\n{DERIVED}![Errors of all claims beside what is allowed](pictures/validation_errors.png)\n"
    );
    for row in 1..=rows {
        write!(text, "\n![Computed values on their references](pictures/validation_{row}.png)\n")?;
    }
    let path = args.output.join("validation.md");
    fs::write(&path, text)?;
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
