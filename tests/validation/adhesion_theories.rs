//! The theories of elastic bodies that stick, against published values, limits and each other. Units E* = R = w = 1.

use std::f64::consts::PI;

use viscocontact::analytic::{AdhesiveCylinder, AdhesivePunch, AdhesiveWave, Dmt, Hertz, Jkr, MaugisDugdale};
use viscocontact::prelude::Error;

fn close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} in place of {expected}");
}

#[test]
fn a_sphere_of_short_range() {
    let sphere = Jkr::new(1.0, 1.0, 1.0).unwrap();
    close(sphere.pull_off_force(), -1.5 * PI, 1e-15);
    close(sphere.radius_at_pull_off(), 1.52323695, 1e-8);
    for (radius, force, approach) in [
        (sphere.radius_at_pull_off(), -1.5 * PI, -0.773416932),
        (sphere.radius_at_least_approach(), -5.0 / 6.0 * PI, -1.60877205),
        (3.0, 9.95035484, 4.65839247),
    ] {
        let state = sphere.state(radius);
        close(state[0], force, 1e-8);
        close(state[1], approach, 1e-8);
    }
    close(sphere.radius_at_least_approach(), 0.732295944, 1e-8);
    let [force, approach] = sphere.state(2.41798793);
    assert!(force.abs() < 1e-7);
    close(approach, 1.94888854, 1e-8);
    // other units: forces scale with w R, radii with (w R²/E*)^⅓
    let other = Jkr::new(2.0, 5.0, 0.3).unwrap();
    let scale = (0.3 * 4.0 / 5.0f64).cbrt();
    close(other.state(3.0 * scale)[0], 0.6 * 9.95035484, 1e-8);
    close(other.state(3.0 * scale)[1], scale * scale / 2.0 * 4.65839247, 1e-8);
}

#[test]
fn a_sphere_of_any_range() {
    // P = W/(πwR), A = a (K/πwR²)^⅓
    for (parameter, force, radius) in
        [(0.1, -1.95059489, 0.199193), (0.5, -1.71824527, 0.678878), (1.0, -1.60073491, 0.903769)]
    {
        let stiffness = 4.0 / 3.0;
        let traction = 0.5 * parameter * (PI * stiffness * stiffness).cbrt();
        let sphere = MaugisDugdale::new(1.0, 1.0, 1.0, traction).unwrap();
        close(sphere.parameter(), parameter, 1e-14);
        let pull_off = sphere.pull_off();
        close(pull_off[0] / PI, force, 1e-8);
        close(pull_off[1] * (stiffness / PI).cbrt(), radius, 2e-5);
    }
}

/// Between both limits, to the order of the range; a strong load is Hertz's.
#[test]
fn long_and_short_ranges_are_limits() {
    let [jkr, dmt] = [Jkr::new(1.0, 1.0, 1.0).unwrap().state(2.0), Dmt::new(1.0, 1.0, 1.0).unwrap().state(2.0)];
    let at = |traction: f64| MaugisDugdale::new(1.0, 1.0, 1.0, traction).unwrap().state(2.0);
    for k in 0..2 {
        let [near, nearer] = [200.0, 400.0].map(|traction| (at(traction)[k] - jkr[k]).abs() / jkr[k].abs());
        assert!(nearer < 0.6 * near && nearer < 0.01, "{near} {nearer}");
        assert!((at(1e-4)[k] - dmt[k]).abs() < 0.02 * dmt[k].abs().max(1.0), "{:?} {dmt:?}", at(1e-4));
    }
    close(MaugisDugdale::new(1.0, 1.0, 1.0, 1e-3).unwrap().pull_off()[0], -2.0 * PI, 1e-2);
    close(MaugisDugdale::new(1.0, 1.0, 1.0, 100.0).unwrap().pull_off()[0], -1.5 * PI, 1e-2);
    let hertz = Hertz::new(1.0, 1.0, 4.0 / 3.0 * 1e3).unwrap();
    close(Dmt::new(1.0, 1.0, 1e-9).unwrap().state(hertz.contact_radius)[0], 4.0 / 3.0 * 1e3, 1e-9);
}

#[test]
fn punch_cylinder_and_wave() {
    let punch = AdhesivePunch::new(1.0, 1.0, 1.0).unwrap();
    close(punch.pull_off_force(), -5.013256549, 1e-9);
    close(punch.approach_at_pull_off(), -5.013256549 / 2.0, 1e-9);
    let cylinder = AdhesiveCylinder::new(1.0, 1.0, 1.0).unwrap();
    close(cylinder.width_at_pull_off(), 0.8602540138, 1e-9);
    close(cylinder.pull_off_force(), -1.743671027, 1e-9);
    // α = 0.3 with D = 1/π, λ = 1, E* = 1/D: p* = π
    let work = 0.5 * 0.09 * PI;
    let wave = AdhesiveWave::new(1.0 / PI, 1.0, PI, work).unwrap();
    close(wave.strength(), 0.3, 1e-14);
    close(wave.width_at_pull_off(), 0.058568879, 1e-7);
    close(wave.pull_off_pressure(), -0.09594402634 * PI, 1e-9);
    assert!(AdhesiveWave::new(1.0, 1.0, 1.0, 20.0).unwrap().pull_off_pressure().is_nan());
    // short contacts of a long wave are cylinders of radius λ²/4π²D
    let long = AdhesiveWave::new(1e-3, 1.0, 1.0, 1e-12).unwrap();
    let one = AdhesiveCylinder::new(1.0 / (4.0 * PI * PI * 1e-3), 1.0, 1e-12).unwrap();
    close(long.pull_off_pressure(), one.pull_off_force(), 1e-3);
}

#[test]
fn scales_out_of_range_are_refused() {
    for [length, modulus, work] in [[0.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, f64::NAN]] {
        let refused = [
            Jkr::new(length, modulus, work).map(drop),
            Dmt::new(length, modulus, work).map(drop),
            AdhesivePunch::new(length, modulus, work).map(drop),
            AdhesiveCylinder::new(length, modulus, work).map(drop),
            AdhesiveWave::new(length, 1.0, modulus, work).map(drop),
            MaugisDugdale::new(length, modulus, work, 1.0).map(drop),
        ];
        assert!(refused.iter().all(|refused| matches!(refused, Err(Error::OutOfRange { .. }))), "{refused:?}");
    }
    assert!(AdhesiveWave::new(1.0, 0.0, 1.0, 1.0).is_err() && MaugisDugdale::new(1.0, 1.0, 1.0, 0.0).is_err());
}
