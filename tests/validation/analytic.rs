//! The reference solutions against each other and against textbook forms.

use crate::common::{RADIUS, maxwell, zener};
use approx::assert_abs_diff_eq;
use std::f64::consts::PI;

use viscocontact::analytic::{GrowingSphere, Hertz, HertzEllipse, RigidPunch};
use viscocontact::prelude::*;

/// Table 1 of the source paper with its integral by the midpoint rule on a fine raster.
fn table_1(g: f64, exponent: f64, creep: impl Fn(f64) -> f64, r: f64, t: f64) -> f64 {
    let depth = |s: f64| {
        let a = (3.0 / 16.0 * RADIUS * creep(s)).cbrt();
        (a * a - r * r).max(0.0).sqrt()
    };
    let panels = 400_000;
    let h = t / panels as f64;
    let integral: f64 = (0..panels).map(|k| (k as f64 + 0.5) * h).map(|s| (exponent * (s - t)).exp() * depth(s)).sum();
    8.0 * g / (PI * RADIUS) * (depth(t) - h * integral)
}

#[test]
fn growing_sphere_is_table_1() {
    let scene = GrowingSphere::step(RADIUS, &maxwell(), 1.0).unwrap();
    let zener = zener();
    let zener = GrowingSphere::step(RADIUS, &zener, 1.0).unwrap();
    for t in [0.0, 0.5, 1.0, 2.0] {
        for r in [0.0, 0.4e-3, 1.0e-3, 1.25e-3, 1.4e-3, 1.7e-3] {
            let exact = table_1(1.0e6, 1.0, |s| 1e-6 * (1.0 + s), r, t);
            assert!(
                (scene.pressure(r, t) - exact).abs() < 1.0,
                "Maxwell r {r} t {t}: {} {exact}",
                scene.pressure(r, t)
            );
            let exact = table_1(1.0e6, 2.0, |s| 1e-6 * (2.0 - (-s).exp()), r, t);
            assert!((zener.pressure(r, t) - exact).abs() < 1.0, "Zener r {r} t {t}: {} {exact}", zener.pressure(r, t));
        }
    }
}

/// ∫ p dA = W at every time, for bodies with several times.
#[test]
fn pressures_carry_the_force() {
    let prony = GeneralizedMaxwell::new(0.2e6, &[(1.0e6, 0.01), (0.5e6, 1.0), (0.3e6, 30.0)]).unwrap();
    let prony = Material::constant_poisson(prony, 0.3).unwrap();
    let ramp = Ramp::new(Load::force(0.0), Load::force(1.0), 2.0).unwrap();
    let scenes = [
        GrowingSphere::step(RADIUS, &maxwell(), 1.0).unwrap(),
        GrowingSphere::step(RADIUS, &prony, 1.0).unwrap(),
        GrowingSphere::new(RADIUS, &prony, ramp).unwrap(),
    ];
    for (scene, times) in scenes.iter().zip([[0.3, 5.0], [0.0, 100.0], [2.0, 50.0]]) {
        for t in times {
            let a = scene.contact_radius(t);
            // r = a sin θ smooths the rim, and Simpson's rule takes few of the pressures, which are integrals of integrals;
            // nothing is left at either end
            let n = 60;
            let step = 0.5 * PI / f64::from(n);
            let sum: f64 = (1..n)
                .map(|k| (if k % 2 == 1 { 4.0 } else { 2.0 }, f64::from(k) * step))
                .map(|(weight, angle)| weight * scene.pressure(a * angle.sin(), t) * a * a * angle.sin() * angle.cos())
                .sum();
            let force = 2.0 * PI * sum * step / 3.0;
            assert!((force - 1.0).abs() < 1e-5, "t = {t}: {force}");
        }
    }
}

#[test]
fn lee_radok_for_a_step_is_ting() {
    let step = GrowingSphere::step(RADIUS, &maxwell(), 1.0).unwrap();
    let history = GrowingSphere::new(RADIUS, &maxwell(), StepLoad::new(Load::force(1.0)).unwrap()).unwrap();
    for t in [0.0, 0.1, 1.0, 20.0] {
        assert_abs_diff_eq!(history.contact_radius(t) / step.contact_radius(t), 1.0, epsilon = 1e-12);
    }
    assert_abs_diff_eq!(history.pressure(1.3e-3, 1.0) / step.pressure(1.3e-3, 1.0), 1.0, epsilon = 1e-8);
}

/// A ramp on a Maxwell body in closed form: a³ = (3R/4)(W′/4G)(t + t²/2τ).
#[test]
fn lee_radok_for_a_ramp() {
    let ramp = Ramp::new(Load::force(0.0), Load::force(5.0), 5.0).unwrap();
    let scene = GrowingSphere::new(RADIUS, &maxwell(), ramp).unwrap();
    for t in [0.1_f64, 1.0, 4.0] {
        let exact = (0.75 * RADIUS * 0.25e-6 * (t + 0.5 * t * t)).cbrt();
        assert!((scene.contact_radius(t) / exact - 1.0).abs() < 1e-12, "{t}");
    }
}

/// Radius of a circular contact.
fn radius(contact: &StatesContact) -> f64 {
    (contact.contact_area() / PI).sqrt()
}

/// Closed elastic states of a sphere against Ting: third order in time.
#[test]
fn states_of_a_sphere_converge_to_ting() {
    let exact = GrowingSphere::step(RADIUS, &maxwell(), 1.0).unwrap();
    let errors = |steps: usize| {
        let mut contact = StatesContact::new(&ElasticStates::sphere(RADIUS).unwrap(), &maxwell()).unwrap();
        contact.step(0.0, Load::force(1.0)).unwrap();
        for _ in 0..steps {
            contact.step(2.0 / steps as f64, Load::force(1.0)).unwrap();
        }
        assert_abs_diff_eq!(contact.force(), 1.0, epsilon = 1e-12);
        let elastic = |level| Hertz::new(RADIUS, 1.0, level).unwrap().pressure(0.5e-3);
        [
            contact.approach() / exact.approach(2.0) - 1.0,
            radius(&contact) / exact.contact_radius(2.0) - 1.0,
            contact.superposed(elastic) / exact.pressure(0.5e-3, 2.0) - 1.0,
        ]
    };
    let [approach, radius, pressure] = errors(400);
    println!("approach {approach:.1e}, radius {radius:.1e}, pressure {pressure:.1e}");
    assert!(
        approach.abs() < 1e-7 && radius.abs() < 1e-6 && pressure.abs() < 2e-6,
        "{approach:e} {radius:e} {pressure:e}"
    );
    let [coarse, fine] = [10, 40].map(|steps| errors(steps)[2].abs());
    assert!(coarse / fine > 12.0, "order in time: {coarse:e} {fine:e}");
}

/// A cone on a power law, E ∝ t^(−β), in at a constant velocity up to t = 1 and out as fast: with T = t − c (t − 1), c =
/// 2^(1/(1−β)), F(t)/F(1) = t^(2−β) − 2 (t − 1)^(1−β) [(1 − β) T + t] (Ting 1966), and the radius equals the radius at the time
/// T on the way in.
#[test]
fn states_retract_a_cone_as_ting() {
    for beta in [0.2_f64, 0.5] {
        let body =
            Material::incompressible(PowerLaw::new(1.0e-6, 1.0, beta).unwrap().series(1e-6..=2.0, 1e-6).unwrap());
        let (slope, velocity, steps) = (0.05, 1.0e-5, 1000);
        let expected = |t: f64| 2.0 * velocity * t / (PI * slope);
        let mut contact = StatesContact::new(&ElasticStates::cone(slope).unwrap(), &body).unwrap();
        let (mut greatest, mut worst) = (0.0, [0.0_f64; 2]);
        for step in 1..=steps + steps / 4 {
            let t = f64::from(step) / f64::from(steps);
            contact.step(1.0 / f64::from(steps), Load::approach(velocity * t.min(2.0 - t))).unwrap();
            if step <= steps {
                greatest = contact.force();
                continue;
            }
            let back = t - 2_f64.powf(1.0 / (1.0 - beta)) * (t - 1.0);
            // at the turn the force falls by (t − 1)^(1−β), faster than the first steps follow
            if t > 1.01 && back > 0.1 {
                let factor = 2.0 * (t - 1.0).powf(1.0 - beta) * ((1.0 - beta) * back + t);
                let force = contact.force() / greatest - (t.powf(2.0 - beta) - factor);
                let found = radius(&contact) / expected(1.0) - back;
                worst = [worst[0].max(force.abs()), worst[1].max(found.abs())];
            }
        }
        println!("β = {beta}: force {:.1e} of the greatest, radius {:.1e}", worst[0], worst[1]);
        assert!(worst[0] < 2e-4 && worst[1] < 2e-4, "{beta}: {worst:?}");
    }
}

#[test]
fn ellipses_tend_to_the_circle_and_the_line() {
    let circle = Hertz::new(RADIUS, 4.0e6, 1.0).unwrap();
    let nearly = HertzEllipse::new([RADIUS, RADIUS * (1.0 + 1e-9)], 4.0e6, 1.0).unwrap();
    assert_abs_diff_eq!(nearly.max_pressure / circle.max_pressure, 1.0, epsilon = 1e-8);
    assert!(nearly.semi_axes[1] > nearly.semi_axes[0]);
    // Johnson 1985, eq. 4.28: for moderate ratios a/b ≈ (R_long/R_short)^(2/3)
    let moderate = HertzEllipse::new([2.0 * RADIUS, RADIUS], 4.0e6, 1.0).unwrap();
    let [a, b] = moderate.semi_axes;
    assert_abs_diff_eq!((a / b) / 2f64.powf(2.0 / 3.0), 1.0, epsilon = 2e-2);
    // W = (2π/3) p0 a b, and p(0) = p0
    assert_abs_diff_eq!(2.0 * PI / 3.0 * moderate.max_pressure * a * b, 1.0, epsilon = 1e-12);
    assert_eq!(moderate.pressure(0.0, 0.0), moderate.max_pressure);
    // very slender: the short axis is the half-width of a line contact under the peak line load, b = 2 p0 R/E*
    let slender = HertzEllipse::new([1e8 * RADIUS, RADIUS], 4.0e6, 1.0).unwrap();
    let line = 2.0 * slender.max_pressure * RADIUS / 4.0e6;
    assert_abs_diff_eq!(slender.semi_axes[1] / line, 1.0, epsilon = 1e-4);
}

/// Force and moment of the punch by quadrature over its face.
#[test]
fn punch_carries_force_and_moment() {
    let (radius, e) = (1.0e-3, 0.25e-3);
    let punch = RigidPunch::new(radius, 4.0e6, 3.0, e).unwrap();
    let (n, m) = (400, 64);
    let (mut force, mut moment) = (0.0, 0.0);
    for k in 0..n {
        // r = R sin θ cancels the singular rim
        let angle = (k as f64 + 0.5) / n as f64 * PI / 2.0;
        let r = radius * angle.sin();
        for l in 0..m {
            let turn = 2.0 * PI * l as f64 / m as f64;
            let weight = radius * angle.cos() * (PI / 2.0 / n as f64) * r * (2.0 * PI / m as f64);
            let p = punch.pressure(r * turn.cos(), r * turn.sin());
            force += p * weight;
            moment += p * weight * r * turn.cos();
        }
    }
    assert_abs_diff_eq!(force, 3.0, epsilon = 1e-5 * 3.0);
    assert_abs_diff_eq!(moment, 3.0 * e, epsilon = 1e-5 * 3.0 * e);
    assert!(matches!(
        RigidPunch::new(radius, 4.0e6, 3.0, 0.34e-3),
        Err(Error::OutOfRange { field: "eccentricity", .. })
    ));
}
