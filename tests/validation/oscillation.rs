//! The loss of a cycle of an oscillating force on PMMA, against the complex compliance and the one-dimensional foundation.

use crate::common::oscillation::Oscillation;
use viscocontact::analytic::{AxisymmetricContact, Profile};
use viscocontact::prelude::*;
use viscocontact::rheology::library;

fn pmma() -> Material {
    library::find("PMMA").unwrap().material(0.35).unwrap()
}

/// π W_a² C″ / 2a, with 2a as the cells have it, whatever the mean force.
#[test]
fn a_fixed_contact_loses_what_the_complex_compliance_says() {
    let creep = pmma().contact_spectrum().unwrap().unwrap();
    for (frequency, mean) in [(1.0e-6, 1.0), (1.0e-2, 0.5), (10.0, 5.0)] {
        let force = Oscillation { mean, amplitude: 0.5, frequency };
        let mut punch = ViscoelasticContact::builder(Grid::square(32, 1.05e-3).unwrap())
            .geometry(&FlatPunch::circular(0.5e-3).unwrap())
            .material(pmma())
            .build()
            .unwrap();
        let loss = force.follow(&mut punch, 32, 1e-5).unwrap().loss();
        let exact = force.loss_of_fixed_contact(&creep, 0.5 * punch.stiffness_over_modulus().unwrap());
        assert!((loss / exact - 1.0).abs() < 1e-3, "{frequency} Hz: {loss} {exact}");
    }
}

/// Under a ball that of a fixed contact for small amplitudes, and 7 % more when the force falls to zero in each cycle.
#[test]
fn the_contact_of_a_ball_changes_the_loss_of_large_amplitudes() {
    let (material, ball) = (pmma(), 5.0e-3);
    let creep = material.contact_spectrum().unwrap().unwrap();
    for (amplitude, over_fixed, allowed) in [(0.1, 1.0, 2e-3), (1.0, 1.07, 5e-3)] {
        let force = Oscillation { mean: 1.0, amplitude, frequency: 1.0e-3 };
        let radius = force.radius_under_mean(&material, ball);
        let foundation =
            AxisymmetricContact::new(&Profile::sphere(ball).unwrap(), &material, 500, 1.4 * radius).unwrap();
        let exact = force.follow_on(foundation, 256).unwrap().loss();
        assert!((exact / force.loss_of_fixed_contact(&creep, radius) - over_fixed).abs() < allowed);
        let mut contact = ViscoelasticContact::builder(Grid::square(96, 2.7 * radius).unwrap())
            .geometry(&Sphere::new(ball).unwrap())
            .material(material.clone())
            .build()
            .unwrap();
        let computed = force.follow(&mut contact, 32, 1e-5).unwrap().loss();
        assert!((computed / exact - 1.0).abs() < 3e-3, "{amplitude}: {computed} {exact}");
    }
}
