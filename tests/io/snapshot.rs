//! States kept in memory and restored: the same steps again, to the last bit.

use crate::common::watched_runs::seen;
use crate::common::{Temporary, sphere_on, three_times};
use std::path::Path;
use viscocontact::ErrorKind;
use viscocontact::prelude::*;

/// One operation on a contact, by four random numbers; whether it succeeded.
fn operate(contact: &mut ViscoelasticContact, [kind, a, b, c]: [f64; 4]) -> bool {
    let (dt, force) = (0.2 * a, 0.2 + b);
    let eccentric = || Load::eccentric_force(force, [1.0e-4 * (c - 0.5), 0.0]);
    match (contact.fields().settings().frame(), (8.0 * kind) as usize) {
        (_, 0) => contact.step(0.0, Load::force(force)).is_ok(),
        (_, 1) => contact.step(dt, eccentric()).is_ok(),
        (_, 2) => contact.step(dt, Load::approach(2.0e-5 * b)).is_ok(),
        (Frame::Indenter, 3 | 4) => contact.step_over([1, 0], dt, Load::force(force)).is_ok(),
        (_, 3) => {
            let path = Straight::new([1.0e-4 * (c - 0.5), 0.0], [1.0e-4, 0.0]).unwrap();
            contact.step_along(&Travel::new(Sphere::new(10.0e-3).unwrap(), path), dt, Load::force(force)).is_ok()
        }
        (_, 4) => {
            let moved = Shifted::new(Sphere::new(8.0e-3 + 4.0e-3 * a).unwrap(), [0.0, 2.0e-4 * (c - 0.5)]).unwrap();
            contact.set_geometries(&[&moved]).is_ok()
        }
        (_, 5) => contact.step(dt, Load::spring(3.0e4, 4.0e-5 * b)).is_ok(),
        _ => contact.step(dt, Load::force(force)).is_ok(),
    }
}

/// Something that must leave no trace: steps that fail in every way, on a larger region or with the indenter elsewhere, and
/// states that are restored, or resumed from a file.
fn disturb(contact: &mut ViscoelasticContact, path: &Path, [kind, a, b, c]: [f64; 4]) {
    let (dt, too_much) = (0.2 * a, 1.0e3 * (1.0 + b));
    match (9.0 * kind) as usize {
        0 => assert_eq!(
            contact.step(dt, Load::force(too_much)).unwrap_err().kind(),
            ErrorKind::Value,
            "contact at the edge"
        ),
        4 => assert_eq!(
            contact.step(dt, Load::force([1e200, 1e305][(2.0 * b) as usize])).unwrap_err().kind(),
            ErrorKind::Value,
            "beyond numbers"
        ),
        5 => assert_eq!(contact.step(-dt, Load::force(0.1)).unwrap_err().kind(), ErrorKind::Value),
        1 => assert_eq!(contact.step(dt, Load::force(f64::NAN)).unwrap_err().kind(), ErrorKind::Value),
        2 => assert_eq!(
            contact.step(dt, Load::eccentric_force(0.5, [1.0, 0.0])).unwrap_err().kind(),
            ErrorKind::Value,
            "outside the hull"
        ),
        3 => {
            let path = Straight::new([3.0e-4 * (c - 0.5), 1.0e-4], [1.0e-4, 0.0]).unwrap();
            let travel = Travel::new(Sphere::new(10.0e-3).unwrap(), path);
            let error = contact.step_along(&travel, dt, Load::force(too_much)).unwrap_err();
            // tyres roll, and take no step along a path
            assert!(matches!(error.kind(), ErrorKind::Value | ErrorKind::Unsupported), "{error}");
        }
        6 => {
            contact.save(path).unwrap();
            (0..3).for_each(|k| _ = operate(contact, [(kind * 7.0 + f64::from(k) * 0.37).fract(), b, c, a]));
            contact.resume(path).unwrap();
        }
        7 if contact.fields().settings().frame() == Frame::Indenter => assert_eq!(
            contact.step_over([2, 0], dt, Load::force(too_much)).unwrap_err().kind(),
            ErrorKind::Value,
            "the indenter is elsewhere"
        ),
        _ => {
            let snapshot = contact.snapshot();
            (0..3).for_each(|k| _ = operate(contact, [(kind * 7.0 + f64::from(k) * 0.37).fract(), b, c, a]));
            contact.restore(&snapshot).unwrap();
        }
    }
}

/// Two contacts take the same random steps, one of them disturbed in between: bitwise the same, whatever moves, grows, unfolds
/// or fails.
#[test]
fn failed_steps_and_restored_states_leave_no_trace() {
    let (mut taken, path) = (0, Temporary::file("disturbed"));
    for seed in 0..120 {
        let mut uniform = crate::common::noise::uniform(seed);
        let mut random = move || [0; 4].map(|_| uniform());
        let [frame, window, symmetry, cells] = random();
        let settings = Settings::default()
            .with_frame(if frame < 0.25 { Frame::Indenter } else { Frame::Bodies })
            .with_window(window < 0.7)
            .with_symmetry(symmetry < 0.7);
        let grid = Grid::square(2 * (8.0 + 12.0 * cells) as usize, 4.0e-3).unwrap();
        let mut plain = sphere_on(grid, three_times(), settings);
        let mut disturbed = plain.clone();
        for step in 0..10 {
            let (operation, disturbance) = (random(), random());
            disturb(&mut disturbed, &path, disturbance);
            assert!(seen(&plain) == seen(&disturbed), "seed {seed}, step {step}: after {disturbance:?}");
            let done = [operate(&mut plain, operation), operate(&mut disturbed, operation)];
            assert_eq!(done[0], done[1], "seed {seed}, step {step}: {operation:?} after {disturbance:?}");
            taken += usize::from(done[0]);
            assert!(seen(&plain) == seen(&disturbed), "seed {seed}, step {step}: {operation:?} after {disturbance:?}");
        }
    }
    assert!(taken > 900, "{taken}");
}
