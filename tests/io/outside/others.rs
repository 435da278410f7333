//! Materials, steps, runs, studies and files.

use std::sync::Arc;

use super::End::{self, Refused, Warned};
use super::judge_all;
use crate::common::{builder_of, builder_on, maxwell, zener};
use viscocontact::Error;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::contact::{StepReport, Warnings};
use viscocontact::prelude::*;
use viscocontact::rheology::TimeTemperature;
use viscocontact::states::StatesContact;

/// The last report of a run.
fn last(mut run: Run<'_>) -> Result<StepReport, Error> {
    let mut last = None;
    while let Some(report) = run.next_step()? {
        last = Some(report);
    }
    Ok(last.unwrap())
}

/// Materials, steps, runs, studies and files.
#[test]
fn everything_else_outside_the_model_is_warned_of_or_refused() {
    type Scene = Box<dyn Fn() -> Result<StepReport, Error>>;
    let grid = || Grid::square(48, 4.0e-3).unwrap();
    let pressed = |material: Material| -> Scene {
        Box::new(move || {
            // as deep whatever the modulus
            let force = 0.2 / (4.0e6 * material.contact_compliance(0.1));
            builder_on(grid(), material.clone()).build()?.step(0.1, Load::force(force))
        })
    };
    let on_states = |material: Material| -> Scene {
        Box::new(move || StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &material)?.step(0.1, Load::force(0.1)))
    };
    let table = || {
        let rows = [0.3, 1.0, 3.0, 10.0].map(|t: f64| (t, 1.0e-6 * (1.0 + 0.1 * t.ln_1p())));
        Measurements::creep(&rows).unwrap().fit().unwrap()
    };
    let modulus = |pascal: f64| Material::incompressible(Maxwell::with_time(pascal, 1.0).unwrap());
    let fixed = |load: Arc<dyn LoadHistory>, dt: f64, until: f64| -> Scene {
        Box::new(move || {
            let rubber = Material::incompressible(Zener::relaxing(1.0e6, 0.1e6, 0.01)?);
            let mut contact = builder_on(grid(), rubber).build()?;
            let mut run = contact.follow(&*load, Stepping::fixed(dt), until);
            let mut worst: Option<StepReport> = None;
            while let Some(report) = run.next_step()? {
                worst = worst.filter(|worst| worst.time_error > report.time_error).or(Some(report));
            }
            Ok(worst.unwrap())
        })
    };
    let never = |load: fn(f64) -> Load| -> Scene {
        Box::new(move || {
            let history = Ramp::new(load(0.0), load(1.0), 1.0)?;
            let mut contact = builder_on(grid(), zener()).build()?;
            last(contact.follow(&history, Stepping::adaptive(1e-2), 2.0))
        })
    };
    let never_on_states = |load: fn(f64) -> Load| -> Scene {
        Box::new(move || {
            let history = Ramp::new(load(0.0), load(1.0), 1.0)?;
            let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &zener())?;
            let (mut run, mut last) = (contact.follow(&history, Stepping::adaptive(1e-2), 2.0), None);
            while let Some(report) = run.next_step()? {
                last = Some(report);
            }
            Ok(last.unwrap())
        })
    };
    let refused = |error: fn() -> Error| -> Scene { Box::new(move || Err(error())) };
    let extension = |name: &'static str| -> Scene { Box::new(move || Err(HeightMap::read(name).unwrap_err())) };
    let [away, spring]: [fn(f64) -> Load; 2] =
        [|t| Load::approach(-20.0e-6 * t), |t| Load::spring(1.0e3, -20.0e-6 * t)];
    let ramp = |load: fn(f64) -> Load, end: f64| -> Arc<dyn LoadHistory> {
        Arc::new(Ramp::new(load(0.0), load(1.0), end).unwrap())
    };
    let sine: Arc<dyn LoadHistory> =
        Arc::new(Sinusoid::new(Load::approach(10.0e-6), Load::approach(100.0e-6), 0.2).unwrap());
    let long = Warned(Warnings::LONG_STEP, "take shorter or adaptive steps");
    let never_touched = Warned(Warnings::NO_CONTACT, "raise the approach");
    let units = Warned(Warnings::MODULUS, "moduli are in Pa");
    let export = Refused("exported as GSF by Gwyddion");
    let longer = |material: &Material| -> [Scene; 2] {
        let (space, states) = (material.clone(), material.clone());
        let run = |contact: &mut dyn FnMut(f64) -> Result<StepReport, Error>| {
            [0.1, 20.0].map(contact).into_iter().last().unwrap()
        };
        [
            Box::new(move || {
                let mut contact = builder_on(grid(), space.clone()).build()?;
                run(&mut |dt| contact.step(dt, Load::force(0.1)))
            }),
            Box::new(move || {
                let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &states)?;
                run(&mut |dt| contact.step(dt, Load::force(0.1)))
            }),
        ]
    };
    let [far, far_on_states] = longer(&Material::incompressible(table().extrapolated()));
    let extrapolated = Warned(Warnings::EXTRAPOLATED, "measure it longer");
    let faster = Warned(Warnings::FASTER_THAN_MATERIAL, "lengthen it");
    let scenes: Vec<(&str, Scene, End)> = vec![
        ("a modulus in MPa", pressed(modulus(1.0)), units),
        ("a modulus in MPa on states", on_states(modulus(1.0)), units),
        ("a modulus in µPa", pressed(modulus(1.0e15)), units),
        ("a modulus in µPa on states", on_states(modulus(1.0e15)), units),
        ("a table extrapolated", far, extrapolated),
        ("a table extrapolated on states", far_on_states, extrapolated),
        ("steps faster than a table", pressed(Material::incompressible(table())), faster),
        ("steps faster than a table on states", on_states(Material::incompressible(table())), faster),
        (
            "fixed steps of a thousand relaxation times",
            fixed(ramp(|t| Load::approach(30.0e-6 * t), 1.0), 10.0, 20.0),
            long,
        ),
        ("fixed steps that skip a sine", fixed(sine, 1.6, 20.0), long),
        ("an approach that never touches", never(away), never_touched),
        ("a spring that never touches", never(spring), never_touched),
        ("an approach that never touches on states", never_on_states(away), never_touched),
        ("a spring that never touches on states", never_on_states(spring), never_touched),
        (
            "degrees Celsius as kelvin",
            refused(|| TimeTemperature::arrhenius(100.0e3, 293.15).unwrap().shift_factor(20.0).unwrap_err()),
            Refused("temperatures are in kelvin (20 °C is 293.15)"),
        ),
        (
            "a reference in Celsius",
            refused(|| TimeTemperature::arrhenius(100.0e3, 20.0).unwrap().shift_factor(293.15).unwrap_err()),
            Refused("temperatures are in kelvin (20 °C is 293.15)"),
        ),
        (
            "thickness and ratio of a layer swapped",
            Box::new(move || {
                let kernel = InfluenceKernel::layer(&grid(), Layer::bonded_to_rigid(0.45, 20.0e-6)?)?;
                let gel = Material::constant_poisson(Elastic::new(1.0e3)?, 0.45)?;
                builder_on(grid(), gel).kernel(kernel).build()?.step(0.0, Load::approach(1.0e-6))
            }),
            Refused("a layer takes its thickness first, then the ratio"),
        ),
        (
            "a run that ends before it begins",
            Box::new(move || {
                let mut contact = builder_on(grid(), maxwell()).build()?;
                contact.step(1.0, Load::force(0.1))?;
                let load = StepLoad::new(Load::force(0.1))?;
                last(contact.follow(&load, Stepping::adaptive(1e-2), 0.5))
            }),
            Refused("give the time at which the run ends, not its length"),
        ),
        (
            "a study of surfaces that attract each other, of which no domain is given",
            Box::new(|| {
                let (ball, load) = (Sphere::new(1.0e-3)?, StepLoad::new(Load::force(1.0e-3))?);
                let scene = |grid, settings| {
                    let law = ExponentialAttraction::new(0.05, 1.0e-6)?;
                    Ok(builder_of(&ball, grid, zener()).settings(settings).attraction(law))
                };
                let study = Study::new(scene, &load, 1.0).accuracy(Accuracy::COARSE).run()?;
                study.into_contact().step(0.1, Load::force(1.0e-3))
            }),
            Refused("Study::domain"),
        ),
        ("a file of a profilometer", extension("scan.opd"), export),
        ("a file of a microscope", extension("scan.ibw"), export),
        ("a picture", extension("scan.tif"), export),
    ];
    judge_all(scenes.into_iter().map(|(name, scene, end)| (name.to_owned(), end, scene())), 22);
}
