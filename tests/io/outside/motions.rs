//! Steady motions, sweeps over patches, and fits that leave the model, each in one way: each is refused, or its messages say why.

use super::silent::{far_from_zero, grid, of_curve, rubber, table, wlf};
use super::{Scene, judge_all};
use crate::common::{Draws, Temporary, builder_of, builder_on, zener};
use viscocontact::num_complex::Complex64;
use viscocontact::prelude::*;
use viscocontact::sliding::{SlidingReport, SlidingSweep};
use viscocontact::states::{Reach, StatesContact, Sweep};
use viscocontact::{Layer, Result};
use viscocontact_identify::{self as id, Identification, Model, tips};

fn body() -> Material {
    Material::incompressible(rubber())
}

/// What a state tells of its warnings.
fn told(report: SlidingReport) -> String {
    report.messages().collect::<Vec<_>>().join("; ")
}

/// A steady motion under a load.
fn slid(builder: Builder, speed: f64, load: Load) -> Result<String> {
    builder.build_sliding()?.at([speed, 0.0], load).map(told)
}

fn periodic(shape: &dyn Geometry, cells: usize, load: Load) -> Result<String> {
    let grid = Grid::square(cells, 1.0e-3)?;
    let kernel = InfluenceKernel::periodic(&grid)?;
    slid(builder_of(shape, grid, body()).kernel(kernel), 0.01, load)
}

fn rough(cells: usize) -> Result<Rough> {
    let spec = RoughSpec::new(1.0e-3, 1.0e-3 / 8.0, Roughness::RmsSlope(0.02)).with_seed(4);
    Rough::new(&Grid::square(cells, 1.0e-3)?, spec)
}

/// Patches of two cells, on elastic states.
fn patches_of_a_sweep() -> Result<String> {
    let grid = Grid::square(32, 1.0e-3)?;
    let sweep = Sweep::new(grid.clone(), &rough(32)?).kernel(InfluenceKernel::periodic(&grid)?);
    let states = sweep.run(Reach::Level(1.0e-9))?;
    let mut contact = StatesContact::new(&states, &zener())?;
    Ok(contact.step(0.0, Load::force(1.0e-3))?.messages().collect::<Vec<_>>().join("; "))
}

/// What the file of a sweep says.
fn swept(sweep: &SlidingSweep, material: Material) -> Result<String> {
    let table = builder_on(grid(), material).build_sliding()?.sweep(sweep)?;
    let file = Temporary::file("a-sweep.csv");
    table.write_csv(&*file)?;
    Ok(std::fs::read_to_string(&*file).unwrap())
}

fn saw_tooth_from(origin: f64) -> Result<String> {
    let shape = FnGeometry::new(move |x1: f64, _: f64| 1.0e-2 * (x1 - origin).rem_euclid(1.0e-3));
    periodic(&shape, 32, Load::force(1.0e-3))
}

fn on_layer(thickness: f64, nu: f64, approach: f64) -> Result<String> {
    let kernel = InfluenceKernel::layer(&grid(), Layer::bonded_to_rigid(thickness, nu)?)?;
    slid(builder_on(grid(), body()).kernel(kernel), 0.1, Load::approach(approach))
}

/// What the last step over the bodies tells, once the grid is twice behind.
fn stepped(builder: Builder, velocity: f64, load: Load) -> Result<String> {
    let mut contact = builder.settings(Settings::default().with_frame(Frame::Indenter)).build()?;
    let mut report = contact.step(0.0, load)?;
    let [cells, _] = contact.grid().cells();
    for _ in 0..2 * cells {
        report = contact.step_over([1, 0], contact.grid().spacing()[0] / velocity, load)?;
    }
    Ok(report.messages().collect::<Vec<_>>().join("; "))
}

fn stepped_in_line(velocity: f64) -> Result<String> {
    let grid = Grid::new([128, 1], [8.0e-3, 1.0])?;
    let kernel = InfluenceKernel::line(&grid, 1.0)?;
    stepped(builder_of(&Cylinder::new(10.0e-3)?, grid, zener()).kernel(kernel), velocity, Load::force(50.0))
}

/// An elastic contact under a load.
fn elastic(shape: &dyn Geometry, modulus: f64, kernel: Option<InfluenceKernel>, load: Load) -> Result<String> {
    let grid = kernel.as_ref().map_or_else(grid, |kernel| kernel.grid().clone());
    let builder = ElasticContact::builder(grid).geometry(shape).modulus(modulus);
    let builder = kernel.into_iter().fold(builder, |builder, kernel| builder.kernel(kernel));
    Ok(builder.build()?.solve(load)?.messages().collect::<Vec<_>>().join("; "))
}

fn periodic_kernel(cells: usize) -> Result<Option<InfluenceKernel>> {
    InfluenceKernel::periodic(&Grid::square(cells, 1.0e-3)?).map(Some)
}

fn ball() -> Sphere {
    Sphere::new(10.0e-3).unwrap()
}

/// A fit of a model to a curve of a ball of `radius` that is pressed in by `depth`; `changed`: what happens to its forces.
fn fitted(radius: f64, depth: f64, values: &[(&str, f64)], changed: impl Fn(usize, f64) -> f64) -> String {
    let of = || -> id::Result<String> {
        let protocol = id::Protocol::ramp_hold_retract(2.0 * depth, [depth, depth], 1.0, 0.01)?;
        let experiment = id::Experiment::new(protocol, tips::sphere(radius)?);
        let zener = Identification::new(Model::Zener);
        let (mut draws, exact) = (Draws::new(5), zener.respond(&experiment, values)?);
        let most = exact.iter().map(|sample| sample.force).fold(0.0, f64::max);
        let mut force =
            |(k, sample): (usize, &id::Sample)| changed(k, sample.force) + 1e-3 * most * draws.between(-1.0, 1.0);
        let force = exact.iter().enumerate().map(&mut force).collect();
        let fit = zener.fit(&[id::Curve::new(experiment, force)?])?;
        Ok(fit.warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))
    };
    of().unwrap_or_else(|error| error.to_string())
}

const ZENER: [(&str, f64); 3] = [("E0", 2.0e3), ("Einf", 5.0e2), ("tau", 0.2)];

#[rustfmt::skip]
const MOTIONS: &[Scene] = &[
// cells and shapes
("a ball that slides on two cells", || slid(builder_on(grid(), body()), 0.1, Load::force(2.0e-5)), "fewer than 8 cells across"),
("a rough surface that slides on patches of two cells", || periodic(&rough(32)?, 32, Load::force(1.0e-3)), "fewer than 8 cells across"),
("a sliding rough surface of three cells in its shortest wave", || periodic(&rough(24)?, 24, Load::force(1.0e-3)), "fewer than 4 cells"),
("a sliding wave of another period", || periodic(&Wavy::new(1.0e-6, 0.4e-3)?, 48, Load::force(1.0e-3)), "make the grid as long"),
("a steep cone that slides", || slid(builder_of(&Cone::new(0.8)?, grid(), body()), 0.1, Load::approach(1.0e-3)), "check that lengths are in m"),
("a slide at the edge of the grid", || slid(builder_on(grid(), body()), 0.1, Load::force(30.0)), "enlarge the grid"),
("a slide beside the edge of the grid", || slid(builder_on(grid(), body()), 0.0, Load::approach(0.35e-3)), "enlarge the grid"),
("a sliding shape far from zero", || slid(builder_of(&far_from_zero(), grid(), body()), 0.1, Load::force(0.1)), "so far are heights from 0"),
("a saw-tooth that begins at its step", || saw_tooth_from(-0.5e-3), "jumps once in the period"),
("a saw-tooth that begins elsewhere", || saw_tooth_from(0.17e-3), "jumps once in the period"),
("a sliding wave beyond full contact", || periodic(&Wavy::new(1.0e-6, 1.0e-3)?, 48, Load::approach(1.0e-5)), "prescribe the force"),
("a layer that slides by half of its thickness deep", || on_layer(60.0e-6, 0.5, 30.0e-6), "check the thickness"),
("a sliding layer of another Poisson's ratio", || on_layer(60.0e-6, 0.3, 3.0e-6), "Poisson's ratio"),
// materials
("a modulus in MPa that slides", || slid(builder_on(grid(), Material::incompressible(Zener::relaxing(2.0, 1.0, 0.1)?)), 0.1, Load::approach(20.0e-6)), "moduli are in Pa"),
("a slide faster than the data", || slid(builder_on(grid(), Material::incompressible(table())), 0.1, Load::force(0.1)), "was not measured"),
("a slide slower than the data", || slid(builder_on(grid(), Material::incompressible(table())), 3e-7, Load::force(2.0e-5)), "was not measured"),
("a slide on three rows over six decades",
    || {
        let fit = Measurements::relaxation(&[(1e-3, 4.0e6), (1.0, 2.0e6), (30.0, 1.5e6), (1e3, 1.0e6)])?.fit()?;
        slid(builder_on(grid(), Material::incompressible(fit)), 1e-3, Load::force(0.1))
    }, "leaves its creep uncertain"),
("a modulus of the other convention",
    || {
        let grid = Grid::square(16, 1.0e-3)?;
        let kernel = InfluenceKernel::periodic(&grid)?;
        let builder = builder_of(&Wavy::new(1.0e-6, 1.0e-3)?, grid, body()).kernel(kernel);
        let mut sliding = builder.build_sliding_by(|w| Complex64::new(1.0e6, -1.0e3 * w))?;
        sliding.at([0.01, 0.0], Load::force(1.0e-3)).map(told)
    }, "E'' >= 0"),
("a counter-body that creeps", || slid(builder_on(grid(), body()).counter_body(body()), 0.1, Load::force(0.1)), "Builder::counter_motion"),
("steps over a body that recovers behind the grid", || stepped(builder_on(grid(), zener()), 3.0e-3, Load::force(0.5)), "lengthen it behind the contact"),
("steps in line contact that leave the grid too soon", || stepped_in_line(3.0e-3), "lengthen it behind the contact"),
// elastic contacts
("an elastic contact on two cells", || elastic(&ball(), 4.0e6, None, Load::force(2.0e-5)), "fewer than 8 cells across"),
("a steep cone on an elastic body", || elastic(&Cone::new(0.8)?, 4.0e6, None, Load::approach(1.0e-3)), "check that lengths are in m"),
("an elastic modulus in MPa", || elastic(&ball(), 4.0, None, Load::approach(20.0e-6)), "moduli are in Pa"),
("an elastic contact at the edge of the grid", || elastic(&ball(), 4.0e6, None, Load::force(30.0)), "enlarge the grid"),
("an elastic contact beside the edge of the grid", || elastic(&ball(), 4.0e6, None, Load::approach(0.35e-3)), "enlarge the grid"),
("an elastic contact of a shape far from zero", || elastic(&far_from_zero(), 4.0e6, None, Load::force(0.1)), "so far are heights from 0"),
("an elastic layer that is pressed by half of its thickness",
    || {
        let layer = Layer::bonded_to_rigid(60.0e-6, 0.5)?;
        elastic(&ball(), 4.0e6, Some(InfluenceKernel::layer(&grid(), layer)?), Load::approach(30.0e-6))
    }, "check the thickness"),
("an elastic rough surface of three cells in its shortest wave", || elastic(&rough(24)?, 4.0e6, periodic_kernel(24)?, Load::force(1.0e-3)), "fewer than 4 cells"),
("an elastic wave of another period", || elastic(&Wavy::new(1.0e-6, 0.4e-3)?, 4.0e6, periodic_kernel(48)?, Load::force(1.0e-3)), "make the grid as long"),
("an elastic wave beyond full contact", || elastic(&Wavy::new(1.0e-6, 1.0e-3)?, 4.0e6, periodic_kernel(48)?, Load::approach(1.0e-5)), "prescribe the force"),
// sweeps
("a sweep on few cells", || swept(&SlidingSweep::new([[0.01, 0.0], [0.1, 0.0]], [Load::force(2.0e-5)]), body()), "fewer than 8 cells across"),
("a sweep beyond the data", || swept(&SlidingSweep::new([[0.1, 0.0]], [Load::force(0.1)]), Material::incompressible(table())), "was not measured"),
("a sweep too cold for the data",
    || {
        let sweep = SlidingSweep::new([[1e-5, 0.0]], [Load::force(0.1)]).at_temperatures(wlf()?, [240.0]);
        swept(&sweep, Material::incompressible(table()))
    }, "was not measured"),
("patches of two cells on states", patches_of_a_sweep, "fewer than 8 cells across"),
// fits
("a fit with a pull-off", || Ok(fitted(5e-6, 0.2e-6, &ZENER, |k, force| if k > 250 { force - 1e-10 } else { force })), "pull-off"),
("a fit of another body", || Ok(fitted(5e-6, 0.2e-6, &ZENER, |k, force| force * (1.0 + 0.3 * (0.05 * k as f64).sin()))), "not independent"),
("a fit of a steep contact", || Ok(fitted(5e-6, 4e-6, &ZENER, |_, force| force)), "check that lengths are in m"),
("a fit of forces in nN", || Ok(fitted(5e-6, 0.2e-6, &ZENER, |_, force| 1e12 * force)), "moduli are in Pa"),
("a fit of a time beyond the data", || Ok(fitted(5e-6, 0.2e-6, &[ZENER[0], ZENER[1], ("tau", 40.0)], |_, force| force)), "outside the times of the data"),
("a fit of a pull for a push", || Ok(fitted(5e-6, 0.2e-6, &ZENER, |_, force| -force)), "check the sign"),
];

#[test]
fn no_motion_sweep_or_fit_outside_the_model_is_silent() {
    judge_all(MOTIONS);
    assert!(MOTIONS.len() >= 35, "{}", MOTIONS.len());
}

/// The same, just inside: nothing is said of any of them.
#[test]
fn motions_and_fits_inside_are_silent() {
    let waves = || Wavy::new(1.0e-6, 1.0e-3);
    let inside: [(&str, Result<String>); 7] = [
        ("steps over a body that recovers on the grid", stepped_in_line(0.2e-3)),
        ("a ball on an elastic body", elastic(&ball(), 4.0e6, None, Load::force(0.5))),
        ("a ball", slid(builder_on(grid(), body()), 0.1, Load::force(0.5))),
        ("a wave", periodic(&waves().unwrap(), 48, Load::force(1.0e-2))),
        (
            "a slide within the data",
            slid(builder_on(grid(), Material::incompressible(table())), 1e-4, Load::force(0.15)),
        ),
        ("a curve between its isotherms", {
            let material = of_curve(295.0).map(Material::incompressible);
            material.and_then(|material| slid(builder_on(grid(), material), 1e-3, Load::approach(40.0e-6)))
        }),
        ("a fit", Ok(fitted(5e-6, 0.2e-6, &ZENER, |_, force| force))),
    ];
    for (name, found) in inside {
        assert_eq!(found.map_err(|error| error.to_string()), Ok(String::new()), "{name}");
    }
}
