//! How each time rule converges, and what it survives.

use crate::common::bodies::{elastic, maxwell};
use crate::common::spheres::sphere_on;
use crate::common::step_loaded_sphere::StepLoadedSphere;
use approx::assert_abs_diff_eq;
use viscocontact::prelude::*;

/// Central pressure at the end, solved far below the error in time.
fn central_pressure(scene: &StepLoadedSphere, steps: usize, time_rule: TimeRule) -> f64 {
    let cells = 48;
    let (contact, _) =
        scene.run(cells, steps, Settings::default().with_tolerance(1e-9).with_time_rule(time_rule)).unwrap();
    contact.pressure()[cells / 2 * cells + cells / 2]
}

/// Ratios of the errors with 8, 16 and 32 steps against a far finer run on the same mesh.
fn falls(scene: &StepLoadedSphere, rule: TimeRule) -> [f64; 2] {
    let fine = central_pressure(scene, 1024, TimeRule::Exponential);
    let error = |steps| (central_pressure(scene, steps, rule) - fine).abs();
    let errors = [error(8), error(16), error(32)];
    println!("{} {rule:?}: {errors:?}", scene.name);
    [errors[0] / errors[1], errors[1] / errors[2]]
}

#[test]
fn the_exponential_rule_is_third_order_and_second_without_its_correction() {
    let body = Burgers::new(1.0e6, 2.0e6, 0.5e6, 0.5e6).unwrap();
    let burgers =
        StepLoadedSphere { name: "Burgers", material: Material::incompressible(body), ..StepLoadedSphere::maxwell() };
    for scene in [StepLoadedSphere::maxwell(), StepLoadedSphere::zener(), burgers] {
        for fall in falls(&scene, TimeRule::Exponential) {
            // 2^2.5: cells that join the contact have a kink
            assert!(fall > 5.66, "{}: {fall}", scene.name);
        }
        for fall in falls(&scene, TimeRule::ExponentialLinear) {
            assert!((3.5..4.5).contains(&fall), "{}: {fall}", scene.name);
        }
    }
}

#[test]
fn the_rectangle_and_backward_rules_are_first_order() {
    for rule in [TimeRule::Rectangle, TimeRule::Backward] {
        for fall in falls(&StepLoadedSphere::maxwell(), rule) {
            assert!((1.8..2.3).contains(&fall), "{rule:?}: {fall}");
        }
    }
}

/// Recursive and direct histories approach the same answer from different sides.
#[test]
fn rules_agree_in_the_limit() {
    let scene = StepLoadedSphere::zener();
    let exponential = central_pressure(&scene, 200, TimeRule::Exponential);
    let mean =
        0.5 * (central_pressure(&scene, 200, TimeRule::Rectangle) + central_pressure(&scene, 200, TimeRule::Backward));
    assert_abs_diff_eq!(mean, exponential, epsilon = 2e-4 * exponential);
}

/// A jump is elastic whatever came before, for every rule.
#[test]
fn a_step_of_length_zero_is_elastic() {
    let scene = StepLoadedSphere::maxwell();
    for time_rule in [TimeRule::Exponential, TimeRule::Rectangle, TimeRule::Backward] {
        let settings = Settings::default().with_tolerance(1e-10).with_time_rule(time_rule);
        let mut contact = scene.contact(32, settings).unwrap();
        for load in [0.2, 0.7, 1.0] {
            contact.step(0.0, Load::force(load)).unwrap();
        }
        let mut at_once = scene.contact(32, settings).unwrap();
        at_once.step(0.0, Load::force(1.0)).unwrap();
        assert_eq!(contact.contact_cells(), at_once.contact_cells());
        let difference = contact.approach() / at_once.approach() - 1.0;
        assert!(difference.abs() < 1e-9, "{time_rule:?}: {difference:e}");
        // nothing more happens in no time
        contact.step(0.5, Load::force(1.0)).unwrap();
        let before = contact.approach();
        contact.step(0.0, Load::force(1.0)).unwrap();
        assert_abs_diff_eq!(contact.approach() / before, 1.0, epsilon = 1e-9);
    }
}

/// One step of any length over the relaxation time: the glassy answer, the relaxed one, and
/// everything between without a sign of oscillation.
#[test]
fn the_default_rule_takes_steps_of_any_length() {
    let scene = StepLoadedSphere::zener();
    let exact = |modulus: f64| viscocontact::analytic::Hertz::new(scene.radius, modulus, scene.force).unwrap();
    let (glassy, relaxed) = (exact(4.0e6).approach, exact(2.0e6).approach);
    let mut last = 0.0;
    for exponent in (-12..=12).step_by(3) {
        let mut contact = scene.contact(64, Settings::default()).unwrap();
        contact.step(0.0, Load::force(scene.force)).unwrap();
        contact.step(10f64.powi(exponent), Load::force(scene.force)).unwrap();
        let approach = contact.approach();
        assert!(approach >= last * (1.0 - 1e-6) && approach > 0.999 * glassy && approach < 1.001 * relaxed);
        last = approach;
        // a second huge step changes nothing: L-stable
        let step = contact.step(1e12, Load::force(scene.force)).unwrap();
        assert!((step.approach / relaxed - 1.0).abs() < 1e-3, "{exponent}: {}", step.approach / relaxed);
        let center = contact.pressure()[32 * 64 + 32];
        contact.step(1e12, Load::force(scene.force)).unwrap();
        assert_abs_diff_eq!(contact.pressure()[32 * 64 + 32] / center, 1.0, epsilon = 1e-4);
    }
    assert_abs_diff_eq!(last / relaxed, 1.0, epsilon = 1e-3);
}

/// Beyond Δ = 2τ the paper's rule loses the very centre of a Maxwell contact, which in truth stays
/// pressed for ever; the other rules keep it and let it decay.
#[test]
fn the_rectangle_rule_is_unstable_for_long_steps() {
    let central = |time_rule| {
        let mut contact =
            sphere_on(Grid::square(48, 6.0e-3).unwrap(), maxwell(), Settings::default().with_time_rule(time_rule));
        contact.step(0.0, Load::force(0.2)).unwrap();
        let mut values = Vec::new();
        for _ in 0..5 {
            contact.step(2.5, Load::force(0.2)).unwrap();
            values.push(contact.pressure()[24 * 48 + 24]);
        }
        values
    };
    assert_eq!(central(TimeRule::Rectangle), [0.0; 5]);
    for rule in [TimeRule::Backward, TimeRule::Exponential] {
        let values = central(rule);
        assert!(values[4] > 0.0 && values.windows(2).all(|pair| pair[1] < pair[0]), "{rule:?}: {values:?}");
    }
}

/// A closure J(t) goes through the direct sum and agrees with the series it samples.
#[test]
fn a_closure_matches_its_series() {
    let scene = StepLoadedSphere::maxwell();
    let run = |material: Material, time_rule| {
        let mut contact = ViscoelasticContact::builder(scene.grid(32).unwrap())
            .geometry(&Sphere::new(scene.radius).unwrap())
            .material(material)
            .times(1e-3..=1e5)
            .settings(Settings::default().with_tolerance(1e-9).with_time_rule(time_rule))
            .build()
            .unwrap();
        contact.step(0.0, Load::force(1.0)).unwrap();
        for _ in 0..10 {
            contact.step(0.1, Load::force(1.0)).unwrap();
        }
        contact.pressure().to_vec()
    };
    for time_rule in [TimeRule::Backward, TimeRule::Exponential] {
        let series = run(scene.material.clone(), time_rule);
        let closure = run(Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 + t))), time_rule);
        let peak = series.iter().copied().fold(0.0, f64::max);
        for (a, b) in closure.iter().zip(&series) {
            assert!((a - b).abs() < 1e-7 * peak, "{time_rule:?}");
        }
    }
}

/// K p is carried along from guess to guess; after thousands of steps it is still K p.
#[test]
fn nothing_drifts_in_five_thousand_steps() {
    let grid = Grid::square(16, 4.0e-3).unwrap();
    let mut contact = sphere_on(grid, elastic(), Settings::default().with_tolerance(1e-8));
    let mut work = contact.kernel().workspace().unwrap();
    let mut fresh = vec![0.0; contact.grid().len()];
    for step in 0..5000 {
        contact.step(0.01, Load::force(0.6 + 0.4 * (0.003 * step as f64).sin())).unwrap();
        let kernel = contact.kernel().clone();
        kernel.convolve(contact.pressure(), &mut fresh, &mut work).unwrap();
        let scale = fresh.iter().copied().fold(0.0, f64::max);
        // u = C K p, C = 1/4G
        for (u, v) in contact.displacement().iter().zip(&fresh) {
            assert!((4.0e6 * u - v).abs() < 1e-11 * scale, "step {step}");
        }
    }
}

/// Loads that fall by halves: the guess by extrapolation cancels, and what is left is noise. K p stays K p.
#[test]
fn falling_by_halves_leaves_no_noise() {
    let shapes: [&dyn Geometry; 2] = [&Sphere::new(10.0e-3).unwrap(), &FlatPunch::circular(1.0e-3).unwrap()];
    for shape in shapes {
        for solver in [Solver::ActiveSet, Solver::PolonskyKeer] {
            let mut contact = ViscoelasticContact::builder(Grid::square(32, 3.0e-3).unwrap())
                .geometry(shape)
                .material(elastic())
                .settings(Settings::default().with_solver(solver))
                .build()
                .unwrap();
            let mut work = contact.kernel().workspace().unwrap();
            let mut fresh = vec![0.0; contact.grid().len()];
            let mut step = |force: f64| {
                contact.step(1.0, Load::force(force)).unwrap();
                contact.kernel().clone().convolve(contact.pressure(), &mut fresh, &mut work).unwrap();
                let scale = fresh.iter().copied().fold(0.0, f64::max);
                for (u, v) in contact.displacement().iter().zip(&fresh) {
                    assert!((4.0e6 * u - v).abs() < 1e-11 * scale, "{solver:?} at {force}");
                }
            };
            (0..40).for_each(|k| step(0.4 * 0.5_f64.powi(k)));
            (0..12).for_each(|k| step(0.4 * 0.65_f64.powi(k)));
            [0.4, 0.2, 1e-3, 1e-6, 0.3, 0.3].into_iter().for_each(&mut step);
        }
    }
}

/// After a long, soft hold a stiff body is jumped at by nothing: the residual of the hold, relative to a
/// displacement a thousand times larger than the jump's, must not come out as pressure.
#[test]
fn a_stiff_step_after_a_soft_one_keeps_the_pressure() {
    for ratio in [1e3, 1e5] {
        let body = Zener::new(1.0e6 * ratio, 1.0e6, 1.0e6).unwrap();
        let mut contact =
            sphere_on(Grid::square(64, 4.0e-3).unwrap(), Material::incompressible(body), Settings::default());
        contact.step(0.0, Load::force(1.0)).unwrap();
        contact.step(10.0, Load::force(1.0)).unwrap();
        let held = contact.pressure().to_vec();
        let peak = held.iter().copied().fold(0.0, f64::max);
        contact.step(0.0, Load::force(1.0)).unwrap();
        let change = contact.pressure().iter().zip(&held).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / peak;
        println!("G/G_K = {ratio:e}: {change:.1e}");
        assert!(change < 1e-4, "G/G_K = {ratio:e}: {change:e}");
    }
}

/// Late times: the ages of the direct sum are differences of large numbers.
#[test]
fn direct_sums_work_at_late_times() {
    let body = Material::incompressible(Maxwell::new(1.0e6, 1.0e4).unwrap());
    let mut contact =
        sphere_on(Grid::square(16, 4.0e-3).unwrap(), body, Settings::default().with_time_rule(TimeRule::Backward));
    contact.step(1.0e3, Load::force(1.0e-6)).unwrap();
    contact.step(0.0, Load::force(2.0e-6)).unwrap();
    for k in 1..40 {
        contact.step(1.0e-3 * (0.37 * k as f64).fract(), Load::force(2.0e-6)).unwrap();
    }
}
