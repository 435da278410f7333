//! Do surfaces that attract each other reach the states of theories and of independent computations? Units E* = R = w = 1.

use std::f64::consts::PI;

use crate::common::refused::not_covered;
use crate::common::sticky::{ball, elastic, least};
use viscocontact::adhesion::{AdhesionError, ExponentialAttraction};
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;

fn law(range: f64) -> ExponentialAttraction {
    ExponentialAttraction::new(1.0, range).unwrap()
}

fn contact(cells: usize, side: f64) -> ViscoelasticContact {
    ball(cells, side, elastic(), law(1.0)).build().unwrap()
}

/// Approaches and forces on the way apart; energy must not rise in any step.
fn pulled(contact: &mut ViscoelasticContact) -> Vec<(f64, f64)> {
    let step = |k: u32| {
        let approach = 0.2 - 0.1 * f64::from(k);
        let report = contact.step(1.0, Load::approach(approach)).unwrap();
        let passes = contact.passes().unwrap();
        assert!(passes.rise < 1e-6, "{approach}: {passes:?}");
        (approach, report.force)
    };
    (0..=16).map(step).collect()
}

/// Exponential law at μ = 1: 0.3 % at 6 cells in the zone, 1e-3 at 12, and of an order of 1.5 or more.
#[test]
fn the_exponential_law_is_reached_as_the_mesh_is_refined() {
    let exact = -1.66407685 * PI;
    let errors = [24, 48, 96].map(|cells| {
        let mut contact = contact(cells, 8.0);
        contact.step(1.0, Load::approach(1.0)).unwrap();
        (least(&pulled(&mut contact)) / exact - 1.0).abs()
    });
    println!("pull-off at 3, 6 and 12 cells in the zone: errors {errors:?}");
    assert!(errors[0] < 1.2e-2 && errors[1] < 3e-3 && errors[2] < 1e-3, "{errors:?}");
    let force = contact(120, 10.0).step(1.0, Load::approach(1.4006335)).unwrap().force;
    println!("force at a = 2: {force}");
    assert!((force + 1.7760281).abs() < 1e-3 * 1.664 * PI, "{force}");
}

/// Under a given force the contact holds until a force that it reports, and goes on apart under a given approach.
#[test]
fn a_force_pulls_the_bodies_off() {
    let mut pressed = contact(48, 8.0);
    let report = pressed.step(1.0, Load::force(0.0)).unwrap();
    assert!(report.contact_cells > 100 && report.force.abs() < 1e-10, "{report}");
    let approach = pressed.approach();
    assert!(contact(48, 8.0).step(1.0, Load::approach(approach)).unwrap().force.abs() < 2e-3);
    pressed.step(1.0, Load::force(-5.15)).unwrap();
    let before = (pressed.time(), pressed.approach(), pressed.pressure().to_vec());
    let refused = pressed.step(1.0, Load::force(-5.35)).unwrap_err();
    assert!(
        matches!(refused, Error::Adhesion(AdhesionError::PulledOff { time, force }) if time == 3.0 && (force + 5.35).abs() < 1e-12),
        "{refused}"
    );
    assert_eq!(before, (pressed.time(), pressed.approach(), pressed.pressure().to_vec()));
    let apart = pressed.step(1.0, Load::approach(-6.0)).unwrap();
    assert!(apart.contact_cells == 0 && (-0.2..0.0).contains(&apart.force), "{apart}");
}

/// A force beside the middle turns a punch: the net traction has its resultant where the force acts.
#[test]
fn a_force_beside_the_middle_turns_a_punch() {
    let at = [0.2, -0.1];
    let mut punch = ball(32, 4.0, elastic(), law(1.0))
        .geometry(&FlatPunch::circular(1.5).unwrap())
        .settings(Settings::default())
        .build()
        .unwrap();
    for force in [3.0, 1.0, -0.5] {
        let report = punch.step(1.0, Load::eccentric_force(force, at)).unwrap();
        let moment = punch.fields().moment();
        assert!((report.force - force).abs() < 1e-9, "{report}");
        assert!((0..2).all(|axis| (moment[axis] - force * at[axis]).abs() < 1e-6), "{force}: {moment:?}");
        assert!(report.tilt[0] * force > 0.0 && report.tilt[1] * force < 0.0, "{report:?}");
    }
}

/// What is not covered, not resolved, or coarse.
#[test]
fn what_is_not_covered_is_refused() {
    let builder = |range: f64| ball(32, 8.0, elastic(), law(range)).settings(Settings::default());
    let set = |settings: Settings| builder(1.0).settings(settings).build().err();
    not_covered(
        [
            set(Settings::default().with_frame(Frame::Indenter)),
            builder(1.0).another_body(&Sphere::new(1.0).unwrap()).build().err(),
            builder(1.0).build().unwrap().fields().stress().err(),
        ]
        .map(|error| (error, "where surfaces attract each other")),
    );
    // cells of 1/4: the zone has 4 ρ² cells
    let Err(Error::Adhesion(AdhesionError::ZoneNotResolved { cells, spacing, range, .. })) = builder(0.5).build()
    else {
        panic!()
    };
    assert!((cells - 1.0).abs() < 1e-12 && (spacing - 0.125).abs() < 1e-12 && (range - 0.5f64.sqrt()).abs() < 1e-12);
    for (range, coarse) in [(0.8, true), (1.1, false)] {
        let report = builder(range).build().unwrap().step(1.0, Load::approach(0.2)).unwrap();
        assert_eq!(report.warnings.contains(Warnings::COARSE_ZONE), coarse);
    }
}
