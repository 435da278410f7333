//! A ball that sticks under forces, and what attraction does not cover. Units E* = R = w = 1.

use crate::common::refused::not_covered;
use crate::common::sticky::{ball, elastic};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;

fn law(range: f64) -> ExponentialAttraction {
    ExponentialAttraction::new(1.0, range).unwrap()
}

fn contact(cells: usize, side: f64) -> ViscoelasticContact {
    ball(cells, side, elastic(), law(1.0)).build().unwrap()
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
        matches!(refused, Error::PulledOff { time, force } if time == 3.0 && (force + 5.35).abs() < 1e-12),
        "{refused}"
    );
    assert_eq!(before, (pressed.time(), pressed.approach(), pressed.pressure().to_vec()));
    let apart = pressed.step(1.0, Load::approach(-6.0)).unwrap();
    assert!(apart.contact_cells == 0 && (-0.2..0.0).contains(&apart.force), "{apart}");
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
    let Err(Error::ZoneNotResolved { cells, spacing, range, .. }) = builder(0.5).build() else { panic!() };
    assert!((cells - 1.0).abs() < 1e-12 && (spacing - 0.125).abs() < 1e-12 && (range - 0.5f64.sqrt()).abs() < 1e-12);
    for (range, coarse) in [(0.8, true), (1.1, false)] {
        let report = builder(range).build().unwrap().step(1.0, Load::approach(0.2)).unwrap();
        assert_eq!(report.warnings.contains(Warnings::COARSE_ZONE), coarse);
    }
}
