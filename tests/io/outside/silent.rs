//! One table of scenes that leave the model, each in one way: bodies, data, temperatures, runs and steady motions. None is silent: each
//! is refused, or its messages say why.

use super::{Scene, judge_all, told};
use crate::common::{builder_of, builder_on, maxwell, sphere, zener};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::prelude::*;
use viscocontact::rheology::{
    CreepSeries, CreepSpectrum, Experiment, Isotherm, MasterCurve, TemperatureHistory, TimeTemperature, Units,
};
use viscocontact::sliding::SlidingSweep;
use viscocontact::states::{Reach, StatesContact, Sweep};
use viscocontact::{Result, TextFormat};

const REFERENCE: f64 = 300.0;

pub(super) fn grid() -> Grid {
    Grid::square(48, 4.0e-3).unwrap()
}

/// A step under a load.
fn pressed(builder: viscocontact::contact::Builder, load: Load) -> Result<String> {
    builder.build()?.step(0.0, load).map(told)
}

fn periodic(shape: &dyn Geometry, cells: usize, load: Load) -> Result<String> {
    let grid = Grid::square(cells, 1.0e-3)?;
    let kernel = InfluenceKernel::periodic(&grid)?;
    pressed(builder_of(shape, grid, zener()).kernel(kernel), load)
}

/// Balls of one size on a grid of two squares, one pressed hard, the other lightly.
fn two_balls() -> Result<String> {
    let ball = |x1: f64| Shifted::new(Sphere::new(5.0e-3).unwrap(), [x1, 0.0]);
    let builder = builder_of(&ball(-3.0e-3)?, Grid::new([96, 48], [12.0e-3, 6.0e-3])?, zener());
    let mut contact = builder.another_body(&ball(3.0e-3)?).build()?;
    contact.step(0.0, [Load::force(0.5), Load::force(2.0e-5)]).map(told)
}

fn rough(cells: usize) -> Result<String> {
    let spec = RoughSpec::new(1.0e-3, 1.0e-3 / 8.0, Roughness::RmsSlope(0.02)).with_seed(4);
    periodic(&Rough::new(&Grid::square(cells, 1.0e-3)?, spec)?, cells, Load::force(1.0e-3))
}

/// A ring two cells wide.
fn ring() -> Result<String> {
    let face = |x1: f64, x2: f64| {
        let r = x1.hypot(x2);
        if (1.0e-3..1.17e-3).contains(&r) { 0.0 } else { f64::INFINITY }
    };
    pressed(builder_of(&FnGeometry::new(face), grid(), zener()), Load::force(0.1))
}

/// Ridges along x2, three cells wide where they touch.
fn ridges() -> Result<String> {
    periodic(&Wavy::new(1.0e-6, 0.25e-3)?, 64, Load::force(2.0e-4))
}

pub(super) fn far_from_zero() -> FnGeometry<impl Fn(f64, f64) -> f64> {
    FnGeometry::new(|x1: f64, x2: f64| 50.0 * (x1 * x1 + x2 * x2) - 1.0e10)
}

/// Creep from 0.1 s to 1000 s.
pub(super) fn table() -> CreepSeries {
    let row = |t: f64| (t, 1.0e-6 * (1.0 + 0.1 * t.ln_1p()));
    let rows: Vec<_> = (-4..=12).map(|k| row(10f64.powf(0.25 * f64::from(k)))).collect();
    Measurements::creep(&rows).unwrap().fit().unwrap()
}

/// Steps of a contact under a force.
fn stepped(mut contact: impl Contact, lengths: &[f64]) -> Result<String> {
    lengths.iter().map(|dt| contact.step(*dt, Load::force(0.1)).map(told)).collect()
}

fn steps(rheology: impl Rheology + 'static, lengths: &[f64]) -> Result<String> {
    stepped(builder_on(grid(), Material::incompressible(rheology)).build()?, lengths)
}

fn steps_on_states(rheology: impl Rheology + 'static, lengths: &[f64]) -> Result<String> {
    stepped(StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &Material::incompressible(rheology))?, lengths)
}

/// What the steps of a run tell, in turn.
fn followed<C: Contact>(mut run: Run<'_, C>) -> Result<Vec<String>> {
    let mut all = Vec::new();
    while let Some(report) = run.next_step()? {
        all.push(told(report));
    }
    Ok(all)
}

fn space_follows(load: impl LoadHistory + 'static, stepping: Stepping, until: f64) -> Result<String> {
    let rubber = Material::incompressible(Zener::relaxing(1.0e6, 0.1e6, 0.01)?);
    followed(builder_on(grid(), rubber).build()?.follow(&load, stepping, until)).map(|all| all.concat())
}

/// A ramp of a load that never touches, on elastic states.
fn never_on_states(end: Load, start: Load) -> Result<String> {
    let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &zener())?;
    followed(contact.follow(&Ramp::new(start, end, 1.0)?, Stepping::adaptive(1e-2), 2.0)).map(|all| all.concat())
}

/// A run to `until`, and how far it came before it was refused.
fn run(until: f64) -> Result<String> {
    let mut contact = builder_on(grid(), Material::incompressible(table())).build()?;
    let load = StepLoad::new(Load::force(0.1))?;
    let mut run = contact.follow(&load, Stepping::adaptive(1.0e-2), until);
    let first = run.next_step()?; // refused at the start, if at all
    assert!(first.is_some());
    let rest = followed(run);
    assert!(rest.is_ok(), "{rest:?}");
    Ok(rest?.pop().unwrap_or_default())
}

fn run_on_states(until: f64) -> Result<String> {
    let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &Material::incompressible(table()))?;
    let load = StepLoad::new(Load::force(0.1))?;
    let mut run = contact.follow(&load, Stepping::adaptive(1.0e-2), until);
    assert!(run.next_step().is_err() && run.contact().time() == 0.0, "refused at the start");
    run.next_step().map(|_| String::new())
}

/// Creep of one body, the series of another.
#[derive(Debug)]
struct Apart;

impl Rheology for Apart {
    fn creep_compliance(&self, t: f64) -> f64 {
        1.0e-6 * (2.0 - (-t).exp())
    }

    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        CreepSpectrum::new(1.0e-6, 0.0, &[(1.0e-6, 10.0)]).ok()
    }
}

pub(super) fn wlf() -> Result<TimeTemperature> {
    TimeTemperature::wlf(8.61, 200.4, REFERENCE)
}

pub(super) fn rubber() -> GeneralizedMaxwell {
    GeneralizedMaxwell::new(1.0e6, &[(30.0e6, 1.0e-4), (10.0e6, 1.0e-2)]).unwrap()
}

/// A sweep of a body at a temperature.
fn swept(material: Material, law: TimeTemperature, kelvin: f64) -> Result<String> {
    let sweep = SlidingSweep::new([[0.01, 0.0]], [Load::force(0.3)]).at_temperatures(law, [kelvin]);
    builder_on(Grid::square(24, 4.0e-3)?, material).build_sliding()?.sweep(&sweep)?;
    Ok(String::new())
}

/// Isotherms at 290 K and 300 K of a body with moduli in proportion to the temperature.
fn curve() -> Result<MasterCurve> {
    let isotherm = |kelvin: f64, slow: f64| {
        let body = Zener::relaxing(4.0e6, 1.0e6, slow)?.creep_spectrum().unwrap().relaxation();
        let row = |w: f64| (w, kelvin * body.complex_modulus(w).re, kelvin * body.complex_modulus(w).im);
        let rows: Vec<_> = (-20..=20).map(|k| row(10f64.powf(0.1 * f64::from(k)))).collect();
        Isotherm::new(kelvin, Measurements::dynamic(&rows)?)
    };
    MasterCurve::with_vertical_shifts(REFERENCE, vec![isotherm(290.0, 10.0)?, isotherm(REFERENCE, 1.0)?])
}

/// The body of that curve at a temperature.
pub(super) fn of_curve(kelvin: f64) -> Result<impl Rheology> {
    let curve = curve()?;
    curve.shift_table()?.at(curve.fit()?, kelvin)
}

fn sliding_over_steps() -> Result<String> {
    let shape = FnGeometry::new(|x1: f64, _: f64| 1.0e-2 * (x1 + 0.5e-3)); // a ramp that jumps at its period
    let grid = Grid::square(32, 1.0e-3)?;
    let kernel = InfluenceKernel::periodic(&grid)?;
    let builder = builder_of(&shape, grid, Material::incompressible(rubber())).kernel(kernel);
    builder.build_sliding()?.at([0.1, 0.0], Load::force(1.0e-3))?;
    Ok(String::new())
}

fn in_tension() -> Result<String> {
    let text = "t [s],E [MPa]\n0.1,3.0\n1,2.0\n10,1.5\n100,1.4\n1000,1.39\n";
    Measurements::from_csv_reader(Experiment::Relaxation, text.as_bytes(), Units::OF_HEADINGS, TextFormat::default())?
        .fit()?;
    Ok(String::new())
}

fn sticky(work: f64, range: f64) -> Result<String> {
    let attraction = ExponentialAttraction::new(work, range)?;
    pressed(builder_on(grid(), zener()).attraction(attraction), Load::force(0.05))
}

fn states() -> Result<std::sync::Arc<ElasticStates>> {
    Sweep::new(Grid::square(32, 4.0e-3)?, &sphere()).run(Reach::Approach(20.0e-6))
}

#[rustfmt::skip]
const SCENES: &[Scene] = &[
// cells
("a ball on two cells beside a heavy one", two_balls, "fewer than 8 cells across"),
("a rough surface on patches of two cells", || rough(32), "fewer than 8 cells across"),
("a ring two cells wide", ring, "fewer than 8 cells across"),
("ridges three cells wide", ridges, "fewer than 8 cells across"),
("contact at the edge of the grid", || pressed(builder_on(grid(), zener()), Load::force(30.0)), "enlarge the grid"),
("contact beside the edge of the grid", || pressed(builder_on(grid(), Material::incompressible(Elastic::new(1.0e6)?)), Load::approach(0.35e-3)), "enlarge the grid"),
// shapes and layers
("heights far from zero", || pressed(builder_of(&far_from_zero(), grid(), zener()), Load::force(0.1)), "so far are heights from 0"),
("heights far from zero on states",
    || {
        let states = Sweep::new(grid(), &far_from_zero()).run(Reach::Level(1.0e-7))?;
        StatesContact::new(&states, &zener())?.step(0.0, Load::force(0.05)).map(told)
    }, "so far are heights from 0"),
("sides in µm", || pressed(builder_of(&sphere(), Grid::square(48, 4.0e3)?, zener()), Load::force(0.1)), "refine the mesh"),
("a layer of another Poisson's ratio than its material",
    || {
        let kernel = InfluenceKernel::layer(&grid(), Layer::bonded_to_rigid(60.0e-6, 0.3)?)?;
        pressed(builder_on(grid(), zener()).kernel(kernel), Load::approach(3.0e-6))
    }, "Poisson's ratio"),
("thickness and ratio of a layer swapped",
    || InfluenceKernel::layer(&grid(), Layer::bonded_to_rigid(0.45, 20.0e-6)?).and_then(|kernel| {
        pressed(builder_on(grid(), Material::constant_poisson(Elastic::new(1.0e3)?, 0.45)?).kernel(kernel), Load::approach(1.0e-6))
    }), "a layer takes its thickness first, then the ratio"),
("a wave pressed beyond full contact", || periodic(&Wavy::new(1.0e-6, 1.0e-3)?, 48, Load::approach(1.0e-5)), "prescribe the force"),
// units and moduli
("a modulus in MPa", || pressed(builder_on(grid(), Material::incompressible(Elastic::new(1.0)?)), Load::approach(20.0e-6)), "moduli are in Pa"),
("a modulus in µPa", || pressed(builder_on(grid(), Material::incompressible(Elastic::new(1.0e15)?)), Load::approach(20.0e-6)), "moduli are in Pa"),
("a modulus in MPa on states", || steps_on_states(Elastic::new(1.0)?, &[0.0]), "moduli are in Pa"),
("a modulus in µPa on states", || steps_on_states(Elastic::new(1.0e15)?, &[0.0]), "moduli are in Pa"),
("a compliance in 1/GPa",
    || {
        let body = Material::incompressible(PowerLaw::new(1.0, 1.0, 0.2)?);
        builder_on(grid(), body).times(1.0..=1e4).build()?.step(10.0, Load::approach(20.0e-6)).map(told)
    }, "moduli are in Pa"),
("Young's modulus for shear, by its heading", in_tension, "fit_tension"),
("a table that falls where creep rises", || Measurements::creep(&[(0.1, 4.0e-6), (1.0, 3.0e-6), (10.0, 2.0e-6), (100.0, 1.0e-6)])?.fit().map(|_| String::new()), "compliances rise"),
("three rows over six decades",
    || {
        let fit = Measurements::relaxation(&[(1e-3, 4.0e6), (1.0, 2.0e6), (30.0, 1.5e6), (1e3, 1.0e6)])?.fit()?;
        builder_on(grid(), Material::incompressible(fit)).build()?.step(1.0, Load::force(0.1)).map(told)
    }, "leaves its creep uncertain"),
("a series of another body", || pressed(builder_on(grid(), Material::incompressible(Apart)), Load::force(0.1)), "the series of another body"),
("a series of another body on states", || StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &Material::incompressible(Apart)).map(|_| String::new()), "the series of another body"),
// times
("a run beyond the data", || run(3.0e8), "CreepSeries::extrapolated"),
("a run beyond the data on states", || run_on_states(3.0e8), "CreepSeries::extrapolated"),
("a step beyond the data", || steps(table(), &[0.0, 2.0e3]), "CreepSeries::extrapolated"),
("a step to the end of the data", || steps(table(), &[0.0, 900.0]), "take a shorter one"),
("data extrapolated in time", || steps(table().extrapolated(), &[0.0, 2.0e3]), "extrapolated beyond its data"),
("data extrapolated in time, on states", || steps_on_states(table().extrapolated(), &[0.1, 2.0e3]), "measure it longer"),
("steps faster than the data", || steps(table(), &[0.0, 1.0e-3]), "shorter than the material is known for"),
("steps faster than the data, on states", || steps_on_states(table(), &[1.0e-3]), "lengthen it"),
("given steps of a thousand relaxation times", || space_follows(Ramp::new(Load::approach(0.0), Load::approach(30.0e-6), 1.0)?, Stepping::fixed(10.0), 20.0), "take shorter or adaptive steps"),
("given steps that skip a sine", || space_follows(Sinusoid::new(Load::approach(10.0e-6), Load::approach(100.0e-6), 0.2)?, Stepping::fixed(1.6), 20.0), "take shorter or adaptive steps"),
("a run that ends before it begins", || {
    let (mut contact, load) = (builder_on(grid(), maxwell()).build()?, StepLoad::new(Load::force(0.1))?);
    contact.step(1.0, Load::force(0.1))?;
    followed(contact.follow(&load, Stepping::adaptive(1e-2), 0.5)).map(|all| all.concat())
}, "give the time at which the run ends, not its length"),
// temperatures
("degrees Celsius in the law of WLF", || wlf()?.shift_factor(80.0).map(|_| String::new()), "temperatures are in kelvin"),
("a reference of WLF in degrees Celsius", || TimeTemperature::wlf(17.44, 51.6, 20.0).map(|_| String::new()), "temperatures are in kelvin"),
("degrees Celsius in the law of Arrhenius", || TimeTemperature::arrhenius(60.0e3, 293.15)?.shift_factor(80.0).map(|_| String::new()), "temperatures are in kelvin"),
("a reference of Arrhenius in degrees Celsius", || TimeTemperature::arrhenius(60.0e3, 20.0)?.shift_factor(293.15).map(|_| String::new()), "temperatures are in kelvin"),
("a temperature beyond the shifts of a table", || swept(Material::incompressible(rubber()), TimeTemperature::table(&[(290.0, 8.0), (300.0, 1.0)], 300.0)?, 320.0), "in the table of shift factors"),
("a temperature beyond the vertical factors", || swept(Material::incompressible(rubber()), wlf()?.with_vertical_factors(&[(290.0, 0.97), (300.0, 1.0)])?, 320.0), "in the table of vertical factors"),
("a master curve beyond its isotherms", || of_curve(350.0).map(|_| String::new()), "in the table of shift factors"),
("the law of a master curve beyond its vertical factors", || curve()?.arrhenius()?.at(rubber(), 350.0).map(|_| String::new()), "in the table of vertical factors"),
("a history of the temperature with vertical factors", || TemperatureHistory::table(wlf()?.with_entropic_moduli(), &[(0.0, 300.0), (60.0, 330.0)]).map(|_| String::new()), "vertical factors b_T"),
("vertical factors of a rubber on its bulk", || swept(Material::elastic_bulk(rubber(), 2.0e9)?, wlf()?.with_entropic_moduli(), 330.0), "vertical factors b_T"),
("vertical factors of one body of two", || swept(Material::incompressible(rubber()).against(Material::incompressible(Elastic::new(1.0e6)?)), wlf()?.with_entropic_moduli(), 330.0), "vertical factors b_T"),
// loads and runs
("a force too small for numbers", || {
    StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &maxwell())?.step(0.0, Load::force(1.0e-320)).map(told)
}, "is a number"),
("a run under a force too small for numbers", || {
    let (mut contact, load) = (builder_on(grid(), maxwell()).build()?, StepLoad::new(Load::force(1.0e-320))?);
    contact.follow(&load, Stepping::adaptive(1e-2), 1.0).next_step().map(|report| report.map_or_else(String::new, told))
}, "maximum force of the run"),
("an approach that never touches", || space_follows(StepLoad::new(Load::approach(-1.0e-5))?, Stepping::fixed(0.5), 1.0), "raise the approach"),
("a spring that never touches", || space_follows(Ramp::new(Load::spring(1.0e3, 0.0), Load::spring(1.0e3, -20.0e-6), 1.0)?, Stepping::adaptive(1e-2), 2.0), "raise the approach"),
("an approach that never touches, on states", || never_on_states(Load::approach(-20.0e-6), Load::approach(0.0)), "raise the approach"),
("a spring that never touches, on states", || never_on_states(Load::spring(1.0e3, -20.0e-6), Load::spring(1.0e3, 0.0)), "raise the approach"),
("a load beyond a sweep of states", || StatesContact::new(&states()?, &zener())?.step(0.0, Load::approach(50.0e-6)).map(told), "sweep further"),
// steady motions and attraction
("a shape that jumps at its period", sliding_over_steps, "jumps once in the period"),
("a line load whose datum is near", || {
    let grid = Grid::new([64, 1], [4.0e-3, 1.0])?;
    let kernel = InfluenceKernel::line(&grid, 5.0e-3)?;
    let builder = builder_of(&Cylinder::new(10.0e-3)?, grid, Material::incompressible(rubber())).kernel(kernel);
    builder.build_sliding()?.at([1.0, 0.0], Load::approach(20.0e-6)).map(|_| String::new())
}, "datum"),
("a study of surfaces that attract each other, of which no domain is given", || {
    let scene = |grid, settings| Ok(builder_on(grid, zener()).settings(settings).attraction(ExponentialAttraction::new(0.05, 1.0e-6)?));
    Study::new(scene, &StepLoad::new(Load::force(1.0e-3))?, 1.0).accuracy(1e-2).run().map(|_| String::new())
}, "Study::domain"),
("a file of a profilometer", || HeightMap::read("scan.opd").map(|_| String::new()), "exported as GSF by Gwyddion"),
("an attraction over less than a cell", || sticky(0.05, 1.0e-9), "cells"),
];

#[test]
fn no_scene_outside_the_model_is_silent() {
    judge_all(SCENES);
    assert!(SCENES.len() >= 55, "{}", SCENES.len());
}

/// The same, just inside: nothing is said of any of them.
#[test]
fn scenes_inside_are_silent() {
    let inside: [(&str, Result<String>); 6] = [
        ("a run to the end of the data", run(1000.0)),
        (
            "a rubber at another temperature",
            swept(Material::incompressible(rubber()), wlf().unwrap().with_entropic_moduli(), 330.0),
        ),
        ("a curve between its isotherms", of_curve(295.0).map(|_| String::new())),
        ("a rough surface on enough cells", rough(256)),
        (
            "a cold law of Arrhenius",
            TimeTemperature::arrhenius(60.0e3, 293.15).unwrap().shift_factor(220.0).map(|_| String::new()),
        ),
        ("heights not so far from zero", {
            let shape = FnGeometry::new(|x1: f64, x2: f64| 50.0 * (x1 * x1 + x2 * x2) - 1.0);
            pressed(builder_of(&shape, grid(), zener()), Load::force(0.1))
        }),
    ];
    for (name, found) in inside {
        assert_eq!(found.map_err(|error| error.to_string()), Ok(String::new()), "{name}");
    }
}
