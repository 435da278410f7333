//! Does the length of steps change a state of surfaces that attract each other? Elastic bodies: no; creeping ones: by an order in time.

use crate::common::fields::traction;
use crate::common::sticky::{ball, elastic};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

/// A wavy sphere at Tabor's number 0.8, which never jumps.
fn contact(material: Material) -> ViscoelasticContact {
    let shape = Sum::new(Sphere::new(1.0).unwrap(), Wavy::new(0.03, 2.0).unwrap());
    let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(1e-8);
    let law = ExponentialAttraction::new(1.0, 1.25).unwrap();
    ball(32, 6.0, material, law).geometry(&shape).settings(settings).build().unwrap()
}

/// The net traction after a way down and a way back, of `count` steps each, which take a time of 2 together, after a jump.
fn end(material: Material, count: u32) -> Vec<f64> {
    let mut contact = contact(material);
    let touch = contact.approach();
    // a jump into the attraction, the same for all
    contact.step(1e-9, Load::approach(touch - 0.3)).unwrap();
    for k in 1..=2 * count {
        let course = 1.0 - (f64::from(k) / f64::from(count) - 1.0).abs();
        let approach = touch - 0.3 + 1.2 * course - 0.5 * (f64::from(k) / f64::from(count) - 1.0).max(0.0);
        contact.step(1.0 / f64::from(count), Load::approach(approach)).unwrap();
    }
    traction(contact.fields())
}

/// Greatest difference of two tractions, over the greatest traction of the law.
fn difference(one: &[f64], other: &[f64]) -> f64 {
    1.25 * one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_length_of_steps_changes_no_elastic_state() {
    let best = end(elastic(), 40);
    let errors = [1, 4, 13].map(|count| difference(&end(elastic(), count), &best));
    println!("1, 4 and 13 steps each way in place of 40: {errors:?}");
    assert!(errors.iter().all(|error| *error < 1e-5), "{errors:?}");
}

#[test]
fn creeping_states_converge_with_the_order_of_the_rule() {
    let creeping = || Material::incompressible(GeneralizedMaxwell::new(0.25, &[(0.75, 0.7)]).unwrap());
    let best = end(creeping(), 320);
    let errors = [10, 20, 40, 80].map(|count| difference(&end(creeping(), count), &best));
    let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    println!("10 to 80 steps each way: errors {errors:?}, orders {orders:.2?}");
    assert!((errors[0] / errors[3]).log2() / 3.0 > 1.9 && errors[3] < 3e-5, "{errors:?}");
}

/// Forces are as exact as [`Settings::tolerance`] says, as far as to 3e-4: of a ball that is pressed on and pulled, over the force that pulls it
/// off.
#[test]
fn the_tolerance_is_that_of_the_force() {
    let path = |tolerance: f64| {
        let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(tolerance);
        let law = ExponentialAttraction::new(1.0, 1.0).unwrap();
        let mut contact = ball(48, 8.0, elastic(), law).settings(settings).build().unwrap();
        [0.4, 0.7, 0.2, -0.3, -0.8, -1.2].map(|approach| contact.step(1.0, Load::approach(approach)).unwrap().force)
    };
    let exact = path(1e-10);
    for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let forces = path(tolerance);
        let errors = exact.iter().zip(forces).map(|(exact, force)| (exact - force).abs());
        let error = errors.fold(0.0, f64::max) / (1.5 * std::f64::consts::PI);
        println!("tolerance {tolerance:.0e}: the force errs by {error:.1e}");
        assert!(error <= tolerance.max(3e-4), "{tolerance}: {error}");
    }
}
