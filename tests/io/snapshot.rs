//! States kept in memory and restored: the same steps again, to the last bit.

use crate::common::bodies::{maxwell, three_times};
use crate::common::runs::{scenes, wandering};
use crate::common::spheres::sphere_on;
use viscocontact::prelude::*;

/// Every scene, back and forth in between: into new memory and into old, from its own contact and from a clone.
#[test]
fn restored_states_take_the_same_steps_again() {
    for (name, build, step) in scenes() {
        let mut contact = build();
        let mut snapshot = contact.snapshot();
        for steps in [0, 1, 2, 9, 30] {
            let mut fresh = build();
            (0..steps).for_each(|k| _ = step(&mut fresh, k));
            contact = fresh;
            contact.snapshot_into(&mut snapshot);
            let ahead = |contact: &mut ViscoelasticContact| {
                let reports: Vec<_> = (steps..steps + 6).map(|k| step(contact, k)).collect();
                (reports, contact.pressure().to_vec(), contact.displacement().to_vec())
            };
            let mut clone = contact.clone();
            let exact = ahead(&mut contact);
            for _ in 0..2 {
                contact.restore(&snapshot).unwrap();
                assert!(ahead(&mut contact) == exact, "{name}, after {steps}");
            }
            // a state ahead, and one behind
            clone.restore(&snapshot).unwrap();
            assert!(ahead(&mut clone) == exact, "{name}, after {steps}, a clone");
            contact.snapshot_into(&mut snapshot);
            contact.restore(&snapshot).unwrap();
            assert!(contact.pressure() == exact.1, "{name}, after {steps}");
        }
    }
}

#[test]
fn snapshots_of_other_contacts_are_refused() {
    let build = || sphere_on(Grid::square(16, 4.0e-3).unwrap(), three_times(), Settings::default());
    let (mut one, mut other) = (build(), build());
    wandering(&mut one, 1);
    let before = one.pressure().to_vec();
    assert_eq!(one.restore(&other.snapshot()), Err(Error::OtherContact));
    assert_eq!(one.pressure(), before);
    // but may be made one's own
    let mut snapshot = other.snapshot();
    one.snapshot_into(&mut snapshot);
    assert_eq!(other.restore(&snapshot), Err(Error::OtherContact));
    one.restore(&snapshot).unwrap();
}

/// What is seen after going back to a smaller contact is what was seen then, and stays so.
#[test]
fn nothing_is_left_of_a_larger_contact() {
    let mut contact = sphere_on(Grid::square(64, 4.0e-3).unwrap(), maxwell(), Settings::default());
    contact.step(0.0, Load::force(0.01)).unwrap();
    let (snapshot, twin) = (contact.snapshot(), contact.clone());
    contact.step(0.0, Load::force(1.0)).unwrap();
    contact.restore(&snapshot).unwrap();
    let seen = |contact: &ViscoelasticContact| {
        let (body, patches) = (contact.body(0).unwrap(), contact.patches().unwrap());
        let fields = (contact.pressure().to_vec(), contact.displacement().to_vec());
        (
            fields,
            format!("{body:?}"),
            patches.count(),
            contact.contact_area(),
            contact.moment(),
            contact.greatest_pressure(),
        )
    };
    assert_eq!(seen(&contact), seen(&twin));
    let mut twin = twin;
    for contact in [&mut contact, &mut twin] {
        contact.step(0.1, Load::force(0.01)).unwrap();
    }
    assert_eq!(seen(&contact), seen(&twin));
}
