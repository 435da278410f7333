//! Contacts with friction in space that go on from bytes, files and snapshots as if nothing had happened; what is
//! refused.

use std::time::Duration;

use viscocontact::friction::{Coulomb, FrictionContact, FrictionLimit, Outcome, ShearHistory, ShearLoad, Tresca};
use viscocontact::prelude::*;

use super::dense::relaxation;
use super::space::{Scene, pair};
use crate::common::Temporary;
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::sealed::seal;

/// All that can be seen of it, to the last bit.
fn seen(contact: &FrictionContact) -> String {
    let normal = contact.normal();
    let fields = [contact.traction(), contact.slip()];
    let numbers = (contact.motion(), contact.force(), contact.sticks(), contact.lateral_work(), contact.load_share());
    let pressed = (normal.time(), normal.approach(), normal.pressure(), normal.fields().displacement());
    // f64 prints as many digits as tell it from all others
    format!("{fields:?} {numbers:?} {pressed:?}")
}

#[test]
fn random_contacts_continue_bit_by_bit() {
    let (mut looked_at, mut slid) = (0, 0);
    for seed in 0..from_environment("SAVED_SCENES", 24) {
        let n = 8 + seed as usize % 6;
        let made = || Scene::new(seed, n, 1e-8);
        let mut scene = made();
        let path = Temporary::file("friction-in-space");
        let steps = scene.steps(&mut Draws::new(seed + 9000), 9);
        for saved_after in [0, 1, 5] {
            scene = made();
            let ahead = |contact: &mut FrictionContact, steps: &[(f64, f64, [f64; 3], u8)]| -> Vec<_> {
                let step = |&(dt, force, part, kind): &(f64, f64, [f64; 3], u8)| {
                    let outcome = contact.step(dt, Load::force(force), scene.along(force, part, kind));
                    format!("{:?}", (outcome, seen(contact)))
                };
                steps.iter().map(step).collect()
            };
            let mut contact = made().contact;
            ahead(&mut contact, &steps[..saved_after]);
            let (bytes, snapshot, now) = (contact.to_bytes().unwrap(), contact.snapshot(), seen(&contact));
            contact.save(&path).unwrap();
            assert!(std::fs::read(&path).unwrap() == bytes);
            let exact = ahead(&mut contact, &steps[saved_after..]);
            slid += exact.iter().filter(|step| step.contains("Slides")).count();
            let (mut from_bytes, mut from_file) = (made().contact, made().contact);
            // over a state of its own
            ahead(&mut from_bytes, &steps[..3]);
            from_bytes.resume_bytes(&bytes).unwrap();
            from_file.resume(&path).unwrap();
            contact.restore(&snapshot).unwrap();
            for mut again in [from_bytes, from_file, contact] {
                assert!(seen(&again) == now, "{seed}, saved after {saved_after}");
                assert!(ahead(&mut again, &steps[saved_after..]) == exact, "{seed}, saved after {saved_after}");
            }
            looked_at += exact.len();
        }
        assert_eq!(made().contact.restore(&scene.contact.snapshot()).unwrap_err().code(), "other_contact");
    }
    assert!(looked_at > 400 && slid > 20, "{looked_at} steps, {slid} of them slid");
}

fn ball(nu: f64, cells: usize) -> viscocontact::contact::Builder {
    ViscoelasticContact::builder(Grid::square(cells, 1.0).unwrap())
        .geometry(&Sphere::new(1.0).unwrap())
        .material(pair(&relaxation(1), nu))
        .settings(Settings::default().with_edge(Edge::Allow))
}

fn with(limit: impl FrictionLimit + 'static) -> FrictionContact {
    FrictionContact::new(ball(0.3, 12), limit).unwrap()
}

fn pressed() -> FrictionContact {
    let mut contact = with(Coulomb::new(0.5).unwrap());
    for (dt, shear) in [(0.0, 0.0), (0.0, 0.01), (0.5, 0.012)] {
        let outcome = contact.step(dt, Load::force(0.05), ShearLoad::force([shear, 0.0])).unwrap();
        assert!(matches!(outcome, Outcome::Holds(_)));
    }
    contact
}

/// A run that is cut off goes on from its file, in given steps and adaptive ones.
#[test]
fn runs_go_on_from_their_files() {
    let press = StepLoad::new(Load::force(0.05)).unwrap();
    let ramp = |to: f64| Ramp::new(Load::force(0.0), Load::force(to), 1.0).unwrap();
    let made = || with(Coulomb::new(0.5).unwrap()).sheared_by(ShearHistory::new(ramp(0.015), ramp(-0.01)));
    for stepping in [Stepping::fixed(0.1), Stepping::adaptive(1e-2)] {
        let path = Temporary::file("friction-run-in-space");
        let (mut contact, mut whole) = (made(), Vec::new());
        let mut run = contact.follow(&press, stepping, 2.0);
        while let Some(report) = run.next_step().unwrap() {
            whole.push((report, seen(run.contact())));
        }
        let half = whole.len() / 2;
        let mut contact = made();
        let mut run = contact.follow(&press, stepping, 2.0).autosave_to(&*path, Duration::ZERO);
        (0..half).for_each(|_| _ = run.next_step().unwrap());
        drop(run);
        let mut other = made();
        other.resume(&path).unwrap();
        let mut run = other.follow(&press, stepping, 2.0);
        for (step, state) in &whole[half..] {
            assert!(run.next_step().unwrap().as_ref() == Some(step) && seen(run.contact()) == *state, "{stepping:?}");
        }
        assert!(half > 3 && run.next_step().unwrap().is_none());
    }
}

fn refused(mut contact: FrictionContact, bytes: &[u8]) -> Error {
    let before = format!("{contact:?}");
    let error = contact.resume_bytes(bytes).unwrap_err();
    assert!(matches!(error, Error::Checkpoint { .. }), "{error}");
    assert_eq!(format!("{contact:?}"), before);
    error
}

#[test]
fn other_contacts_are_refused_by_what_differs() {
    let bytes = pressed().to_bytes().unwrap();
    let of = |nu: f64, cells: usize| FrictionContact::new(ball(nu, cells), Coulomb::new(0.5).unwrap()).unwrap();
    let others = [
        (with(Coulomb::new(0.500001).unwrap()), "friction"),
        (with(Tresca::new(0.5).unwrap()), "friction"),
        (of(0.5, 12), "friction"), // of the same compliance
        (of(0.3, 13), "grid"),
    ];
    for (other, differs) in others {
        let error = refused(other, &bytes);
        assert_eq!((error.code(), error.name()), ("checkpoint_other_scene", Some(differs)), "{error}");
    }
    // of a contact without friction, and the other way round
    let mut normal = ball(0.3, 12).build().unwrap();
    let kinds = [refused(pressed(), &normal.to_bytes().unwrap()), normal.resume_bytes(&bytes).unwrap_err()];
    for kind in kinds {
        assert_eq!((kind.code(), kind.name()), ("checkpoint_other_scene", Some("kind of contact")), "{kind}");
    }
    pressed().resume_bytes(&bytes).unwrap();
}

/// A damaged file is refused; one whose checksum belongs to its content never panics, and gives numbers if it is taken.
#[test]
fn damaged_files_are_refused() {
    let bytes = pressed().to_bytes().unwrap();
    let draws = &mut Draws::new(5);
    for _ in 0..60 {
        let mut damaged = bytes.clone();
        let at = draws.below(bytes.len());
        damaged[at] ^= 1 << draws.below(8);
        let cause = refused(pressed(), &damaged);
        let told = ["checkpoint_damaged", "checkpoint_foreign", "checkpoint_format"].contains(&cause.code());
        assert!(told, "{at}: {cause}");
        let cause = refused(pressed(), &bytes[..at]);
        assert!(["checkpoint_damaged", "checkpoint_foreign"].contains(&cause.code()), "{at}: {cause}");
    }
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..from_environment("SEALED_DAMAGES", 400) {
        let mut changed = bytes.clone();
        for _ in 0..1 + draws.below(3) {
            let at = 16 + draws.below(bytes.len() - 16);
            changed[at] ^= 1 << draws.below(8);
        }
        seal(&mut changed);
        let mut contact = pressed();
        match contact.resume_bytes(&changed) {
            Ok(()) => {
                taken += 1;
                if let Ok(outcome) = contact.step(0.1, Load::force(0.05), ShearLoad::force([0.01, 0.0])) {
                    let numbers = contact.traction().concat();
                    assert!(numbers.iter().all(|value| value.is_finite()), "{outcome:?}");
                }
            }
            Err(_) => refused += 1,
        }
    }
    // most bits are digits of numbers: another finite one is a state, too
    println!("{taken} taken, {refused} refused");
    assert!(taken > 20 && refused > 5);
}
