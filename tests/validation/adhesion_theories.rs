//! The theories of elastic bodies that stick, against published values, limits and each other. Units E* = R = w = 1.

use std::f64::consts::PI;

use viscocontact::analytic::{
    AdhesiveCylinder, AdhesivePunch, AdhesiveWave, Dmt, Hertz, Jkr, MaugisDugdale, OpeningEdge,
};
use viscocontact::prelude::{Error, GeneralizedMaxwell, Material, Maxwell};

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
        (sphere.radius_at_min_approach(), -5.0 / 6.0 * PI, -1.60877205),
        (3.0, 9.95035484, 4.65839247),
    ] {
        let state = sphere.state(radius);
        close(state[0], force, 1e-8);
        close(state[1], approach, 1e-8);
    }
    close(sphere.radius_at_min_approach(), 0.732295944, 1e-8);
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
    assert!(matches!(AdhesiveWave::new(1.0, 0.0, 1.0, 1.0), Err(Error::OutOfRange { .. })));
    assert!(matches!(MaugisDugdale::new(1.0, 1.0, 1.0, 0.0), Err(Error::OutOfRange { .. })));
}

/// The edge of a body that is ten times as stiff at once, with the range ρ.
fn edge(range: f64) -> OpeningEdge {
    let body = GeneralizedMaxwell::new(0.25, &[(2.25, 1.0)]).unwrap();
    OpeningEdge::new(&Material::incompressible(body), 1.0, range).unwrap()
}

/// Against an independent program: a table of the integral, explicit steps of 2e-4 of the approach, l = 1/4 and 1/9.
#[test]
fn a_sphere_is_pulled_off_a_creeping_body() {
    for (speed, work) in [(1e-3, 1.036421), (1e-2, 1.239672), (0.1, 2.226101), (1.0, 4.892816), (10.0, 8.375654)] {
        close(edge(1.0).work(speed).unwrap(), work, 1e-5);
    }
    for (tabor, speed, pull, approach, edge_speed, work) in [
        (2.0, 0.01, 6.36742, -1.1860, 0.0042917, 1.363912),
        (2.0, 1.0, 21.52608, -3.6936, 0.2592502, 4.949113),
        (3.0, 0.01, 7.54744, -1.4084, 0.0040032, 1.627207),
        (3.0, 1.0, 26.01365, -4.4208, 0.2376845, 6.115631),
    ] {
        let found = edge(1.0 / tabor).pull_off(1.0, 3.0, speed).unwrap();
        close(-found.force, pull, 1e-3);
        close(found.approach, approach, 5e-3);
        close(found.edge_speed, edge_speed, 2e-2);
        close(found.work, work, 1e-2);
    }
}

#[test]
fn a_slow_and_a_fast_edge_are_limits() {
    let edge = edge(0.5);
    close(edge.length(), 0.25, 1e-14);
    close(edge.work(0.0).unwrap(), 1.0, 1e-9);
    close(edge.work(1e9).unwrap(), 10.0, 1e-9);
    // Schapery's third: 1/y − 1/k = (1 − 1/k) α/3vθ, θ the retardation time
    let (work, speed) = (edge.work(1e4).unwrap(), 1e4);
    let passage = 0.25 * PI * work * 0.25 / speed;
    close(1.0 / work - 0.1, 0.9 * passage / 3.0 / 10.0, 1e-3);
    let slow = edge.pull_off(1.0, 3.0, 1e-7).unwrap();
    close(slow.force, -1.5 * PI, 1e-3);
    close(slow.contact_radius, Jkr::new(1.0, 1.0, 1.0).unwrap().radius_at_pull_off(), 1e-2);
    // at once a contact wider than JKR has at pull-off with 10 w holds as long as 10 w do
    let fast = edge.pull_off(1.0, 20.0, 1e9).unwrap();
    close(fast.force, -15.0 * PI, 1e-3);
    // other units
    let body = Material::incompressible(GeneralizedMaxwell::new(0.25e5, &[(2.25e5, 3.0)]).unwrap());
    let (radius, work) = (2e-3, 0.1);
    let width = (radius * radius * work / 1e5f64).cbrt();
    let depth = width * width / radius;
    let other = OpeningEdge::new(&body, work, 0.5 * depth).unwrap();
    let [one, same] =
        [edge.pull_off(1.0, 3.0, 0.1), other.pull_off(radius, 3.0 * depth, 0.1 * depth / 3.0)].map(Result::unwrap);
    close(same.force / (work * radius), one.force, 1e-9);
    close(same.edge_speed / width * 3.0, one.edge_speed, 1e-9);
}

#[test]
fn an_opening_edge_needs_a_body_that_answers_and_ends() {
    let fluid = Material::incompressible(Maxwell::with_time(1.0, 1.0).unwrap());
    let refused = OpeningEdge::new(&fluid, 1.0, 1.0).unwrap_err().to_string();
    assert!(refused.contains("fluidity of the body"), "{refused}");
    let edge = edge(1.0);
    for refused in [edge.work(-1.0).err(), edge.pull_off(1.0, -1.7, 1.0).err(), edge.clone().with_zone(0.0).err()] {
        assert!(matches!(refused, Some(Error::OutOfRange { .. })), "{refused:?}");
    }
}

/// A contact of no cells is the limit of small ones, whatever λ.
#[test]
fn points_are_the_limit_of_small_contacts() {
    for (energy, stress) in [(0.05, 1.0e2), (0.05, 1.0e4), (0.05, 1.0e5), (1.0, 1.0e6)] {
        let theory = MaugisDugdale::new(1.0e-3, 1.0e5, energy, stress).unwrap();
        let ([force, approach], [near_force, near_approach]) = (theory.state(0.0), theory.state(1.0e-12));
        assert!(
            (force / near_force - 1.0).abs() < 1e-5 && force >= theory.pull_off()[0] * (1.0 + 1e-9),
            "{stress:e}: {force:e} {near_force:e}"
        );
        assert!(
            (approach - near_approach).abs() <= 1e-5 * near_approach.abs(),
            "{stress:e}: {approach:e} {near_approach:e}"
        );
    }
}
