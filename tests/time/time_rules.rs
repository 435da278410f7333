//! How each time rule converges, and what it survives.

use crate::common::{StepLoadedSphere, contact_of, maxwell, zener};
use approx::assert_abs_diff_eq;
use viscocontact::prelude::*;

/// Central pressure at the end, solved far below the error in time.
fn central_pressure(scene: &StepLoadedSphere, steps: usize, time_rule: TimeRule) -> f64 {
    let cells = 48;
    let (contact, _) =
        scene.run(cells, steps, Settings::default().with_tolerance(1e-9).with_time_rule(time_rule)).unwrap();
    contact.pressure()[cells / 2 * cells + cells / 2]
}

/// Ratios of the errors with 8, 16 and 32 steps against a far finer run on the same mesh.
fn falls(scene: &StepLoadedSphere, rule: TimeRule) -> [f64; 2] {
    let fine = central_pressure(scene, 1024, TimeRule::Exponential);
    let error = |steps| (central_pressure(scene, steps, rule) - fine).abs();
    let errors = [error(8), error(16), error(32)];
    println!("{} {rule:?}: {errors:?}", scene.name);
    [errors[0] / errors[1], errors[1] / errors[2]]
}

#[test]
fn the_exponential_rule_is_third_order_and_second_without_its_correction() {
    let body = Burgers::new(1.0e6, 2.0e6, 0.5e6, 0.5e6).unwrap();
    let burgers =
        StepLoadedSphere { name: "Burgers", material: Material::incompressible(body), ..StepLoadedSphere::maxwell() };
    for scene in [StepLoadedSphere::maxwell(), StepLoadedSphere::zener(), burgers] {
        for fall in falls(&scene, TimeRule::Exponential) {
            // 2^2.5: cells that join the contact have a kink
            assert!(fall > 5.66, "{}: {fall}", scene.name);
        }
        for fall in falls(&scene, TimeRule::ExponentialLinear) {
            assert!((3.5..4.5).contains(&fall), "{}: {fall}", scene.name);
        }
    }
}

/// Third order for a smooth load on any rheology with an elastic response, once steps resolve its fastest relaxation (a power
/// law resolved from 0.3 s on); first order without. On a punch no cell comes or goes.
#[test]
fn the_order_is_that_of_the_rule_on_every_body() {
    let power = FractionalMaxwell::findley(0.5e-6, 0.5e-6, 0.4).unwrap().series(0.3..=10.0, 1e-2).unwrap();
    let bodies = [
        ("Maxwell", maxwell()),
        ("Zener", zener()),
        ("Kelvin–Voigt", Material::incompressible(KelvinVoigt::with_time(1.0e6, 0.3).unwrap())),
        ("Burgers", Material::incompressible(Burgers::new(1.0e6, 3.0e6, 1.0e6, 0.5e6).unwrap())),
        ("power law", Material::incompressible(power)),
        ("elastic bulk", Material::elastic_bulk(Zener::with_time(2.0e6, 1.0e6, 1.0).unwrap(), 3.0e6).unwrap()),
    ];
    let punch = FlatPunch::circular(0.8e-3).unwrap();
    let force = |t: f64| (0.5 * std::f64::consts::PI * t).sin().powi(2);
    for (name, material) in bodies {
        let approach = |steps: u32| {
            let settings = Settings::default().with_tolerance(1e-12);
            let mut contact = contact_of(&punch, Grid::square(24, 2.2e-3).unwrap(), material.clone(), settings);
            for k in 1..=steps {
                let t = 0.8 * f64::from(k) / f64::from(steps);
                contact.step(0.8 / f64::from(steps), Load::force(force(t))).unwrap();
            }
            contact.approach()
        };
        let fine = approach(8192);
        let errors = [64, 128, 256].map(|steps| (approach(steps) / fine - 1.0).abs());
        let order = (errors[0] / errors[2]).log2() / 2.0;
        println!("{name}: errors {errors:?}, order {order:.2}");
        // an immediate dashpot responds to the slope of u at the end of a step, which a straight line has to first order
        let immediate = material.contact_compliance(0.0) == 0.0;
        assert!(if immediate { order > 0.95 } else { order >= 1.95 }, "{name}: {errors:?}");
    }
}

/// A jump is elastic whatever came before, for every rule.
#[test]
fn a_step_of_length_zero_is_elastic() {
    let scene = StepLoadedSphere::maxwell();
    for time_rule in [TimeRule::Exponential, TimeRule::ExponentialLinear] {
        let settings = Settings::default().with_tolerance(1e-10).with_time_rule(time_rule);
        let mut contact = scene.contact(32, settings).unwrap();
        for load in [0.2, 0.7, 1.0] {
            contact.step(0.0, Load::force(load)).unwrap();
        }
        let mut at_once = scene.contact(32, settings).unwrap();
        at_once.step(0.0, Load::force(1.0)).unwrap();
        assert_eq!(contact.contact_cells(), at_once.contact_cells());
        let difference = contact.approach() / at_once.approach() - 1.0;
        assert!(difference.abs() < 1e-9, "{time_rule:?}: {difference:e}");
        // nothing more happens in no time
        contact.step(0.5, Load::force(1.0)).unwrap();
        let before = contact.approach();
        contact.step(0.0, Load::force(1.0)).unwrap();
        assert_abs_diff_eq!(contact.approach() / before, 1.0, epsilon = 1e-9);
    }
}
