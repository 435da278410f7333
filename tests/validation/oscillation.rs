//! The loss of a cycle of an oscillating force on PMMA, against the complex compliance and the one-dimensional foundation.

use crate::common::contact_of;
use crate::common::oscillation::{Cycle, Oscillation};
use approx::assert_abs_diff_eq;
use viscocontact::prelude::*;
use viscocontact::rheology::library;

fn pmma() -> Material {
    library::find("PMMA").unwrap().material(0.35).unwrap()
}

fn punch(settings: Settings) -> ViscoelasticContact {
    contact_of(&FlatPunch::circular(0.5e-3).unwrap(), Grid::square(32, 1.05e-3).unwrap(), pmma(), settings)
}

/// π W_a² C″ / 2a, with 2a as the cells have it, whatever the mean force.
#[test]
fn a_fixed_contact_loses_what_the_complex_compliance_says() {
    let creep = pmma().contact_spectrum().unwrap().unwrap();
    for (frequency, mean) in [(1.0e-6, 1.0), (1.0e-2, 0.5), (10.0, 5.0)] {
        let force = Oscillation { mean, amplitude: 0.5, frequency };
        let mut punch = punch(Settings::default());
        let loss = force.follow(&mut punch, 32, 1e-5).unwrap().loss();
        let exact = force.loss_of_fixed_contact(&creep, 0.5 * punch.fields().stiffness_over_modulus().unwrap());
        assert!((loss / exact - 1.0).abs() < 1e-3, "{frequency} Hz: {loss} {exact}");
    }
}

/// Under a ball the loss equals the loss of a fixed contact for small amplitudes; it is 7 % more when the force falls to zero
/// in each cycle.
#[test]
fn the_contact_of_a_ball_changes_the_loss_of_large_amplitudes() {
    let (material, ball) = (pmma(), 5.0e-3);
    let creep = material.contact_spectrum().unwrap().unwrap();
    for (amplitude, over_fixed, allowed) in [(0.1, 1.0, 2e-3), (1.0, 1.07, 5e-3)] {
        let force = Oscillation { mean: 1.0, amplitude, frequency: 1.0e-3 };
        let radius = force.radius_under_mean(&material, ball);
        let foundation = StatesContact::new(&ElasticStates::sphere(ball).unwrap(), &material).unwrap();
        let exact = force.follow_on(foundation, 256).unwrap().loss();
        assert_abs_diff_eq!(exact / force.loss_of_fixed_contact(&creep, radius), over_fixed, epsilon = allowed);
        let mut contact = contact_of(
            &Sphere::new(ball).unwrap(),
            Grid::square(96, 2.7 * radius).unwrap(),
            material.clone(),
            Settings::default(),
        );
        let computed = force.follow(&mut contact, 32, 1e-5).unwrap().loss();
        assert!((computed / exact - 1.0).abs() < 3e-3, "{amplitude}: {computed} {exact}");
    }
}

/// The loss in steps of given length, relative to the exact one: relaxation times far below a step see the mean slope of the
/// displacement only. Where PMMA has many of them the order is 1.5, where it has few it is 3.
#[test]
fn given_steps_lose_order_on_a_broad_spectrum() {
    let creep = pmma().contact_spectrum().unwrap().unwrap();
    let error = |frequency: f64, steps: u32| {
        let force = Oscillation { mean: 1.0, amplitude: 0.5, frequency };
        let mut punch = punch(Settings::default().with_tolerance(1e-9));
        let held = force.next_breakpoint(0.0).unwrap();
        punch.step(0.0, Load::force(force.mean)).unwrap();
        for time in (-288..=0).map(|k| held * 10_f64.powf(f64::from(k) / 48.0)) {
            punch.step(time - punch.time(), Load::force(force.mean)).unwrap();
        }
        let mut cycle = Cycle::default();
        for k in 0..=4 * steps {
            let phase = std::f64::consts::TAU * f64::from(k) / f64::from(steps);
            let dt = if k == 0 { 0.0 } else { 1.0 / f64::from(steps) / frequency };
            punch.step(dt, Load::force(force.mean + force.amplitude * phase.cos())).unwrap();
            if k >= 3 * steps {
                cycle.forces.push(punch.force());
                cycle.approaches.push(punch.approach());
            }
        }
        cycle.loss() / force.loss_of_fixed_contact(&creep, 0.5 * punch.fields().stiffness_over_modulus().unwrap()) - 1.0
    };
    for (frequency, at_64, order) in
        [(1.0e-7, -8.0e-3, 1.4..1.6), (1.0e-3, -1.8e-3, 1.9..2.2), (10.0, -3.3e-5, 2.9..3.3)]
    {
        let [coarse, fine] = [32, 64].map(|steps| error(frequency, steps));
        let found = (coarse / fine).log2();
        println!("{frequency:e} Hz: {coarse:.1e} in 32 steps per cycle, {fine:.1e} in 64, order {found:.2}");
        assert_abs_diff_eq!(fine / at_64, 1.0, epsilon = 0.1);
        assert!(order.contains(&found), "{found}");
    }
}
