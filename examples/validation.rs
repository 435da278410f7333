//! Every claim against its reference: closed forms, the method of dimensionality reduction, formulations of another kind. Computes
//! all of them, and writes `validation.md`, of which a copy is kept in `docs`; fails if one errs by more than it may.
//!
//! `cargo run --release --example validation`

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/rolling.rs"]
mod rolling;
mod support;

use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use common::StepLoadedSphere;
use indicatif::ProgressBar;
use rolling::RollingCylinder;
use viscocontact::analytic::{AxisymmetricContact, Hertz, HertzEllipse, Profile, RigidPunch};
use viscocontact::prelude::*;

/// Computes every claim against its reference.
#[derive(Parser)]
struct Args {
    /// Folder for the table.
    #[arg(long, default_value = "out/validation")]
    output: PathBuf,
}

fn main() {
    support::finish(run(&Args::parse()));
}

type Outcome = Result<Vec<Claim>, Box<dyn Error>>;

/// One number beside the one that it should be.
struct Claim {
    scene: &'static str,
    quantity: &'static str,
    reference: &'static str,
    computed: f64,
    exact: f64,
    /// Relative error allowed.
    allowed: f64,
}

impl Claim {
    fn error(&self) -> f64 {
        (self.computed / self.exact - 1.0).abs()
    }
}

/// The claims of a scene: what, computed, exact, allowed.
fn claims(scene: &'static str, reference: &'static str, rows: &[(&'static str, f64, f64, f64)]) -> Vec<Claim> {
    let claim = |&(quantity, computed, exact, allowed)| Claim { scene, quantity, reference, computed, exact, allowed };
    rows.iter().map(claim).collect()
}

const G: f64 = 1.0e6;
const E_STAR: f64 = 4.0 * G;

fn elastic() -> Material {
    Material::incompressible(Elastic::new(G).expect("a modulus"))
}

fn pressed(grid: Grid, shape: &dyn Geometry, load: Load) -> Result<ViscoelasticContact> {
    let mut contact = ViscoelasticContact::builder(grid).geometry(shape).material(elastic()).build()?;
    contact.step(0.0, load)?;
    Ok(contact)
}

fn hertz() -> Outcome {
    let exact = Hertz::new(10.0e-3, E_STAR, 1.0)?;
    let grid = Grid::square(256, 2.6 * exact.contact_radius())?;
    let contact = pressed(grid, &Sphere::new(10.0e-3)?, Load::force(1.0))?;
    let rows = [
        ("approach", contact.approach(), exact.approach(), 1e-4),
        ("greatest pressure", contact.greatest_pressure(), exact.peak_pressure(), 1e-3),
        ("contact area", contact.contact_area(), PI * exact.contact_radius().powi(2), 2e-3),
        ("stiffness over E*", contact.stiffness_over_modulus()?, 2.0 * exact.contact_radius(), 5e-3),
    ];
    Ok(claims("sphere, 256² cells", "Hertz 1882", &rows))
}

fn hertz_ellipse() -> Outcome {
    let exact = HertzEllipse::new([20.0e-3, 5.0e-3], E_STAR, 1.0)?;
    let [a1, a2] = exact.semi_axes();
    let grid = Grid::new([192, 128], [2.5 * a1, 2.5 * a2])?;
    let contact = pressed(grid, &Ellipsoid::new(20.0e-3, 5.0e-3)?, Load::force(1.0))?;
    let rows = [
        ("approach", contact.approach(), exact.approach(), 5e-4),
        ("greatest pressure", contact.greatest_pressure(), exact.peak_pressure(), 1e-3),
        ("contact area", contact.contact_area(), PI * a1 * a2, 5e-3),
    ];
    Ok(claims("ellipsoid 4 : 1, 192 × 128 cells", "Hertz 1882", &rows))
}

fn punch() -> Outcome {
    let exact = RigidPunch::new(1.0e-3, E_STAR, 1.0, 0.3e-3)?;
    let contact =
        pressed(Grid::square(256, 2.1e-3)?, &FlatPunch::circular(1.0e-3)?, Load::eccentric_force(1.0, [0.3e-3, 0.0]))?;
    let rows =
        [("approach", contact.approach(), exact.approach(), 1e-2), ("tilt", contact.tilt()[0], exact.tilt(), 1e-2)];
    Ok(claims("flat punch, force at 0.3 R, 256² cells", "Lur'e 1964", &rows))
}

fn step_loaded(scene: &StepLoadedSphere, name: &'static str) -> Outcome {
    let reference = scene.reference()?;
    let (contact, _) = scene.run(256, 100, Settings::default())?;
    let errors = common::errors(&contact, &reference);
    let t = contact.time();
    let rows = [
        ("central pressure", 1.0 + errors.central_pressure, 1.0, 1e-4),
        ("approach", contact.approach(), reference.approach(t), 1e-4),
        ("contact radius", (contact.contact_area() / PI).sqrt(), reference.contact_radius(t), 3e-3),
    ];
    Ok(claims(name, "Ting 1966; the source paper's Table 1", &rows))
}

fn loaded_and_unloaded() -> Outcome {
    let material = Material::constant_poisson(Zener::new(G, 0.5 * G, 0.5 * G)?, 0.3)?;
    let corners = [(0.0, 0.0), (1.0, 1.0), (1.6, 0.4)].map(|(t, force)| (t, Load::force(force)));
    let history = PiecewiseLinear::new(&corners)?;
    let widest = (0.75 * 10.0e-3 * material.contact_compliance(1e3)).cbrt();
    let mut contact = ViscoelasticContact::builder(Grid::square(128, 2.1 * widest)?)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(material.clone())
        .build()?;
    let mut run = contact.follow(&history, Stepping::fixed(0.02), 1.6);
    while run.next_step()?.is_some() {}
    let mut exact = AxisymmetricContact::new(&Profile::sphere(10.0e-3)?, &material, 4000, 1.1 * widest)?;
    for k in 1..=1600 {
        let t = 1e-3 * f64::from(k);
        exact.press(1e-3, if t <= 1.0 { t } else { 1.0 - (t - 1.0) })?;
    }
    let rows = [
        ("approach", contact.approach(), exact.approach(), 1e-3),
        ("contact radius", (contact.contact_area() / PI).sqrt(), exact.contact_radius(), 1e-2),
    ];
    Ok(claims(
        "sphere on a Zener body, up and down, 128² cells",
        "method of dimensionality reduction (Popov & Heß)",
        &rows,
    ))
}

fn relaxing() -> Outcome {
    // at a constant approach the force follows the relaxation modulus
    let tau = 1.0;
    let mut contact = ViscoelasticContact::builder(Grid::square(128, 4.0e-3)?)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Maxwell::new(G, G * tau)?))
        .build()?;
    contact.step(0.0, Load::approach(1.0e-4))?;
    let start = contact.force();
    for _ in 0..50 {
        contact.step(0.04, Load::approach(1.0e-4))?;
    }
    let rows = [("force after 2 τ over that at once", contact.force() / start, (-2.0_f64).exp(), 1e-4)];
    Ok(claims("sphere held at its approach on a Maxwell body", "Lee & Radok 1960", &rows))
}

fn wavy() -> Outcome {
    let (wavelength, amplitude, share) = (1.0e-3, 1.0e-6, 0.4_f64);
    let grid = Grid::new([512, 1], [wavelength, 1.0])?;
    let mean = share * PI * E_STAR * amplitude / wavelength;
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&Wavy::new(amplitude, wavelength)?)
        .material(elastic())
        .kernel(Arc::new(InfluenceKernel::periodic(&grid)?))
        .build()?;
    contact.step(0.0, Load::force(mean * wavelength))?;
    let rows = [
        ("greatest pressure", contact.greatest_pressure(), 2.0 * mean / share.sqrt(), 5e-3),
        ("contact width", contact.contact_area(), 2.0 * share.sqrt().asin() / PI * wavelength, 5e-3),
    ];
    Ok(claims("wavy surface, periodic, plane strain, 512 cells", "Westergaard 1939", &rows))
}

fn line() -> Outcome {
    let (radius, per_length) = (0.02, 500.0);
    let half_width = (4.0 * per_length * radius / (PI * E_STAR)).sqrt();
    let grid = Grid::new([512, 1], [4.0 * half_width, 1.0])?;
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&Cylinder::new(radius)?)
        .material(elastic())
        .kernel(Arc::new(InfluenceKernel::line(&grid, 1.0)?))
        .build()?;
    contact.step(0.0, Load::force(per_length))?;
    let approach = per_length / (PI * E_STAR) * (2.0 * (2.0 / half_width).ln() + 1.0);
    let rows = [
        ("half-width", 0.5 * contact.contact_area(), half_width, 5e-3),
        ("greatest pressure", contact.greatest_pressure(), 2.0 * per_length / (PI * half_width), 1e-3),
        ("approach to a datum", contact.approach(), approach, 1e-3),
    ];
    Ok(claims("cylinder in line contact, 512 cells", "Hertz; Johnson 1985, 4.2 and 5.6", &rows))
}

fn rolling() -> Outcome {
    let mut scene = RollingCylinder { radius: 0.02, per_length: 500.0, glassy: 0.25 / G, delayed: 0.5 / G, reach: 1.0 };
    let (glassy, relaxed) = (scene.hertz(scene.glassy).0, scene.hertz(scene.glassy + scene.delayed).0);
    scene.reach = 2.0 * glassy;
    let (side, exact) = (glassy / 32.0, scene.steady(500));
    let cells = ((5.0 * scene.reach + 3.0 * relaxed) / side) as usize;
    let grid = Grid::new([cells, 1], [cells as f64 * side, 1.0])?;
    let cylinder = Shifted::new(Cylinder::new(scene.radius)?, [0.5 * grid.lengths()[0] - 2.0 * relaxed, 0.0])?;
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&cylinder)
        .material(Material::incompressible(Zener::new(G, 0.5 * G, 0.5 * G)?))
        .kernel(Arc::new(InfluenceKernel::line(&grid, 1.0e3)?))
        .settings(Settings { frame: Frame::Indenter, ..Settings::default() })
        .build()?;
    let load = Load::force(scene.per_length);
    contact.toward_steady(SteadyMotion { axis: 0, velocity: scene.reach, load, tolerance: 2e-4 })?.run()?;
    let [behind, ahead] = exact.ends();
    let friction = contact.lateral_force(&cylinder)[0] / contact.force();
    let rows = [
        ("greatest pressure", contact.greatest_pressure(), exact.peak(), 1e-2),
        ("contact width", contact.contact_area(), ahead - behind, 1e-2),
        ("hysteretic friction", friction, exact.friction(scene.radius), 2e-2),
    ];
    Ok(claims(
        "cylinder rolling on a Zener body, v τ = 2 a",
        "steady state without steps (exponential integrals)",
        &rows,
    ))
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&args.output)?;
    let scenes: [&dyn Fn() -> Outcome; 10] = [
        &hertz,
        &hertz_ellipse,
        &punch,
        &|| {
            step_loaded(
                &StepLoadedSphere::maxwell(),
                "step-loaded sphere on a Maxwell body, 256² cells, 100 steps to 2 τ",
            )
        },
        &|| step_loaded(&StepLoadedSphere::zener(), "step-loaded sphere on a Zener body, 256² cells, 100 steps to 2 τ"),
        &loaded_and_unloaded,
        &relaxing,
        &wavy,
        &line,
        &rolling,
    ];
    let mut table = String::from(
        "# Validation\n\nWritten by `cargo run --release --example validation`, which fails if an error is greater than allowed.\n\n\
         | scene | quantity | reference | computed | exact | error | allowed |\n|---|---|---|---|---|---|---|\n",
    );
    let (mut failed, mut count) = (Vec::new(), 0);
    let progress = ProgressBar::new(scenes.len() as u64);
    for scene in scenes {
        for claim in scene()? {
            let Claim { scene, quantity, reference, computed, exact, allowed } = claim;
            writeln!(
                table,
                "| {scene} | {quantity} | {reference} | {computed:.6e} | {exact:.6e} | {:.1e} | {allowed:.0e} |",
                claim.error()
            )?;
            count += 1;
            if claim.error() > allowed || claim.error().is_nan() {
                failed.push(format!("{scene}: {quantity} errs by {:.1e}, {allowed:.0e} is allowed", claim.error()));
            }
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let path = args.output.join("validation.md");
    fs::write(&path, &table)?;
    print!("{table}");
    println!("\n{count} claims, {} of them fail; the table is in {}", failed.len(), path.display());
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n").into()) }
}
