//! Does a changing temperature act by the reduced time alone?

use approx::{assert_abs_diff_eq, relative_eq};
use viscocontact::ErrorKind;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};

use crate::common::random_bodies::random_body;
use crate::common::refused::{field, refused};
use crate::common::{Draws, builder_on, figures};

const REFERENCE: f64 = 300.0;

fn wlf() -> TimeTemperature {
    TimeTemperature::wlf(10.0, 60.0, REFERENCE).unwrap()
}

fn grid(cells: usize) -> Grid {
    Grid::square(cells, 4.0e-3).unwrap()
}

fn zener() -> Zener {
    Zener::with_time(1.0e6, 0.25e6, 1.0).unwrap()
}

fn settings() -> Settings {
    Settings::default().with_tolerance(1e-12)
}

fn close(value: f64, expected: f64, within: f64, what: &str) {
    let equal = relative_eq!(value, expected, epsilon = 0.0, max_relative = within);
    assert!(equal, "{what}: {value:e}, expected {expected:e}");
}

/// Each Arrhenius law continues the one above it, and the law is 1 at its reference.
#[test]
fn arrhenius_laws_continue_one_another() {
    let [first, second] = [(REFERENCE - 20.0, 2.0e5), (REFERENCE - 40.0, 5.0e4)];
    let one = wlf().with_arrhenius_below(first.0, first.1).unwrap();
    let two = one.clone().with_arrhenius_below(second.0, second.1).unwrap();
    for off in [0.0, 5.0, 19.9, 20.0, 30.0, 40.0] {
        let temperature = REFERENCE - off;
        assert_eq!(two.shift_factor(temperature).unwrap(), one.shift_factor(temperature).unwrap(), "{temperature} K");
    }
    let slower = 5.0e4 / 8.314_462_618 * (1.0 / (second.0 - 5.0) - 1.0 / second.0);
    let expected = one.shift_factor(second.0).unwrap() * slower.exp();
    close(two.shift_factor(second.0 - 5.0).unwrap(), expected, 1e-9, "the second");
}

#[test]
fn reduced_times_are_exact() {
    // 1/T linear in t: the exponent of Arrhenius' law is too
    let (energy, gas) = (60.0e3, 8.314_462_618_153_24);
    let arrhenius = TimeTemperature::arrhenius(energy, REFERENCE).unwrap();
    let inverse = |t: f64| 1.0 / 280.0 - 2.0e-6 * t;
    let history = TemperatureHistory::function(arrhenius, move |t| 1.0 / inverse(t), &[]).unwrap();
    let integral = |t: f64| {
        let exponent = -energy / gas * (inverse(t) - 1.0 / REFERENCE);
        exponent.exp() / (energy / gas * 2.0e-6)
    };
    for (from, to) in [(0.0, 1.0e-9), (0.0, 1.0), (3.0, 300.0), (0.0, 1000.0)] {
        let expected = if to < 1e-6 {
            to * (-energy / gas * (inverse(0.5 * to) - 1.0 / REFERENCE)).exp()
        } else {
            integral(to) - integral(from)
        };
        close(history.reduced_time(from, to).unwrap(), expected, 1e-12, &format!("{from} to {to}"));
    }
    // constant, a jump, constant
    let table = [(1.0, 290.0), (2.0, 290.0), (2.0, 330.0), (3.0, 330.0)];
    let jump = TemperatureHistory::table(wlf(), &table).unwrap();
    let factors = [290.0, 330.0].map(|t| wlf().shift_factor(t).unwrap());
    close(jump.reduced_time(0.0, 5.0).unwrap(), 2.0 / factors[0] + 3.0 / factors[1], 1e-14, "a jump");
    assert_eq!([jump.at(1.5), jump.at(2.0), jump.at(9.0)], [290.0, 330.0, 330.0]);
    // a ramp through 13 decades of the shift factor, against the trapezium rule with an end correction of zero order
    let ramp = TemperatureHistory::table(wlf(), &[(0.0, 262.0), (10.0, 340.0)]).unwrap();
    let rate = |t: f64| 1.0 / wlf().shift_factor(262.0 + 7.8 * t).unwrap();
    let parts = 200_000;
    let h = 10.0 / f64::from(parts);
    let simpson: f64 = (0..parts)
        .map(|k| {
            let t = h * f64::from(k);
            h / 6.0 * (rate(t) + 4.0 * rate(t + 0.5 * h) + rate(t + h))
        })
        .sum();
    close(ramp.reduced_time(0.0, 10.0).unwrap(), simpson, 1e-11, "a ramp");
    let parts: f64 = (0..100).map(|k| ramp.reduced_time(0.1 * f64::from(k), 0.1 * f64::from(k + 1)).unwrap()).sum();
    close(parts, simpson, 1e-11, "a ramp in parts");
}

/// A scene in t equals the one without temperature whose steps are those of the reduced time, exactly.
#[test]
fn steps_are_those_of_the_reduced_time_on_random_scenes() {
    let mut draws = Draws::new(11);
    for scene in 0..60 {
        let body = random_body(&mut draws);
        // times of the body pass in a run of 1 s, however the temperature goes
        let (mut time, mut table) = (0.0, Vec::new());
        for _ in 0..1 + draws.below(5) {
            table.push((time, draws.between(285.0, 330.0)));
            time += if draws.chance(0.2) { 0.0 } else { draws.between(0.05, 0.5) };
        }
        let law = if draws.chance(0.5) { wlf() } else { TimeTemperature::arrhenius(80.0e3, REFERENCE).unwrap() };
        let history = TemperatureHistory::table(law.clone(), &table).unwrap();
        let scale = body.until / history.reduced_time(0.0, 1.0).unwrap();
        let stretched: Vec<(f64, f64)> = table.iter().map(|&(time, kelvin)| (scale * time, kelvin)).collect();
        let history = TemperatureHistory::table(law, &stretched).unwrap();
        let build = || builder_on(grid(16), body.material.clone()).times(1e-9 * body.until..=2.0 * body.until);
        let rule = if draws.chance(0.2) { TimeRule::ExponentialLinear } else { TimeRule::Exponential };
        let settings = settings().with_edge(Edge::Allow).with_time_rule(rule);
        let mut own = build().temperature(history.clone()).settings(settings).build().unwrap();
        let mut plain = build().settings(settings).build().unwrap();
        if body.is_elastic_at_once() {
            own.step(0.0, Load::force(0.1)).unwrap();
            plain.step(0.0, Load::force(0.1)).unwrap();
        }
        let mut cuts: Vec<f64> = (0..8).map(|_| draws.between(0.0, scale)).collect();
        cuts.sort_by(f64::total_cmp);
        for end in cuts {
            let force = draws.between(0.0, 0.3);
            let (from, length) = (own.time(), end - own.time());
            let reduced = history.reduced_time(from, from + length).unwrap();
            let [a, b] = [(&mut own, length), (&mut plain, reduced)].map(|(contact, dt)| {
                contact.step(dt, Load::force(force)).unwrap_or_else(|error| panic!("scene {scene}: {error}"))
            });
            let what = format!("scene {scene}, {}", body.name);
            close(a.approach, b.approach, 1e-9, &what);
            assert_eq!(a.contact_cells, b.contact_cells, "{what}");
            close(own.reduced_time(), plain.time(), 1e-12, &what);
            assert_abs_diff_eq!(a.dt, length, epsilon = 1e-15 * end);
        }
    }
}

#[test]
fn adaptive_steps_end_on_corners_and_keep_their_error() {
    let table = [(0.0, 290.0), (1.0, 290.0), (1.0, 325.0), (2.0, 325.0), (3.0, 295.0)];
    let history = TemperatureHistory::table(wlf(), &table).unwrap();
    let load = FnHistory::new(|t: f64| Load::force(0.3 + 0.25 * (3.0 * t).sin()));
    let run = |tolerance: f64| {
        let scene = builder_on(grid(32), Material::incompressible(zener())).temperature(history.clone());
        let mut contact = scene.settings(Settings::default().with_tolerance(1e-10)).build().unwrap();
        let stops = [0.7, 1.0, 1.3, 2.0, 2.6, 3.0, 4.0];
        let mut run = contact.follow(&load, Stepping::adaptive(tolerance), 4.0).stop_at(stops).unwrap();
        let (mut answers, mut ends) = (Vec::new(), Vec::new());
        while let Some(report) = run.next_step().unwrap() {
            ends.push(report.time);
            if report.dt > 0.0 && stops.contains(&report.time) {
                answers.push(report.approach);
            }
        }
        assert!([1.0, 2.0, 3.0].iter().all(|corner| ends.contains(corner)), "{ends:?}");
        (answers, ends.len())
    };
    let (truth, _) = run(1e-8);
    let ratios = [1e-3, 1e-4, 1e-5].map(|tolerance| {
        let (answers, steps) = run(tolerance);
        assert_eq!(answers.len(), truth.len());
        let error = answers.iter().zip(&truth).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("{tolerance:e}: error {error:.1e} in {steps} steps");
        assert!(error < 2.0 * tolerance, "{tolerance:e}: error {error:.1e} in {steps} steps");
        format!("{:.2}", error / tolerance)
    });
    figures::figure("errors at changing temperatures", &ratios.join(", ")).unwrap();
}

#[test]
fn temperatures_beyond_the_law_are_refused() {
    let table = |rows: &[(f64, f64)]| TemperatureHistory::table(wlf(), rows).err();
    let corner = TemperatureHistory::function(wlf(), |_| 300.0, &[f64::NAN]).err();
    refused([
        (table(&[]), "temperature table"),
        (table(&[(1.0, 300.0), (0.0, 300.0)]), "must"),
        (corner, "corner of the temperature"),
    ]);
    // a closure that cools below T_ref − C2 after 2 s
    let cooling = TemperatureHistory::function(wlf(), |t| 300.0 - 30.0 * t, &[]).unwrap();
    let mut contact = builder_on(grid(16), Material::incompressible(zener())).temperature(cooling).build().unwrap();
    contact.step(0.0, Load::force(0.1)).unwrap();
    contact.step(1.0, Load::force(0.1)).unwrap();
    let before = (contact.time(), contact.reduced_time(), contact.approach(), contact.pressure().to_vec());
    for length in [1.5, 10.0, f64::INFINITY, f64::NAN, -1.0] {
        field(contact.step(length, Load::force(0.2)));
        assert_eq!(before, (contact.time(), contact.reduced_time(), contact.approach(), contact.pressure().to_vec()));
    }
    contact.step(0.5, Load::force(0.2)).unwrap();
}

/// Lengths in t from lengths in ξ, with a step that would end beyond the law.
#[test]
fn a_run_reaches_the_end_of_the_law() {
    let cooling = TemperatureHistory::function(wlf(), |t| 300.0 - 20.0 * t, &[]).unwrap();
    let mut contact = builder_on(grid(16), Material::incompressible(zener())).temperature(cooling).build().unwrap();
    let load = StepLoad::new(Load::force(0.1)).unwrap();
    let mut run = contact.follow(&load, Stepping::adaptive(1e-3), 2.0);
    while run.next_step().unwrap().is_some() {}
    assert_eq!(contact.time(), 2.0);
    // the whole of a run is looked at when it begins
    assert_eq!(contact.follow(&load, Stepping::adaptive(1e-3), 4.0).next_step().unwrap_err().kind(), ErrorKind::Value);
}

/// In 10 s of warming from 285 K to 330 K the body creeps as in more than an hour at the reference temperature.
#[test]
fn series_are_fitted_over_the_reduced_times_of_a_run() {
    let history = TemperatureHistory::table(wlf(), &[(0.0, 285.0), (10.0, 330.0)]).unwrap();
    assert!(history.reduced_time(0.0, 10.0).unwrap() > 1000.0);
    let power_law = Material::incompressible(PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap());
    let ramp = Ramp::new(Load::force(0.0), Load::force(0.05), 1.0).unwrap();
    let mut contact = builder_on(grid(32), power_law).times_of(&ramp, 10.0).temperature(history).build().unwrap();
    let mut run = contact.follow(&ramp, Stepping::adaptive(1e-3), 10.0);
    while run.next_step().unwrap().is_some() {}
    assert_eq!(
        contact.step(1.0, Load::force(0.05)).unwrap_err().kind(),
        ErrorKind::Value,
        "the series ends with the run"
    );
}

#[test]
fn metadata_contain_the_temperature() {
    use viscocontact::output::Metadata;

    let table = [(0.0, 290.0), (2.0, 310.5)];
    let scene = || builder_on(grid(8), Material::incompressible(zener()));
    let warming = scene().temperature(TemperatureHistory::table(wlf(), &table).unwrap()).build().unwrap();
    let json = Metadata::new("warming").json(&warming);
    assert!(json.contains("\"temperature\": ") && json.contains("\"table\": [[0.0, 290.0], [2.0, 310.5]]"), "{json}");
    assert!(json.contains("\"c1\": ") && json.contains("\"c2\": "), "{json}");
    assert!(!Metadata::new("constant").json(&scene().build().unwrap()).contains("\"temperature\""));
}

/// Noise, steps and bends in a closure cost a bounded number of evaluations; what they leave open is said, and what overflows
/// ends at once.
#[test]
fn rough_temperatures_cost_little() {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    use viscocontact::Error;

    type Closure = fn(f64) -> f64;
    let noise: Closure = |t| ((t * 1e9).sin() * 43758.5453).fract();
    let knots: Closure = |t| {
        let (k, share) = ((1000.0 * t).floor(), (1000.0 * t).fract());
        let knot = |k: f64| 0.3 * ((k * 7919.0) % 13.0);
        knot(k) + share * (knot(k + 1.0) - knot(k))
    };
    let cases: [(&str, Closure, usize, Option<f64>); 7] = [
        ("smooth", |t| 10.0 * t, 200, Some(1e-13)),
        ("single precision", |t| f64::from(10.0_f32 * t as f32), 500_000, Some(1e-8)),
        ("stairs", |t| 0.1 * (100.0 * t).floor(), 500_000, Some(1e-12)),
        ("bends", knots, 500_000, Some(1e-12)),
        ("little noise", |t| 10.0 * t + 1e-6 * ((t * 1e9).sin() * 43758.5453).fract(), 100_000, Some(1e-6)),
        ("noise", noise, 100_000, None),
        ("overflow", |_| 1e4, 100, None),
    ];
    for (name, closure, most, accuracy) in cases {
        let calls = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&calls);
        let at = move |t: f64| {
            counted.fetch_add(1, Relaxed);
            REFERENCE + closure(t)
        };
        let history = TemperatureHistory::function(wlf(), at, &[]).unwrap();
        let until = if name == "overflow" { 1e308 } else { 1.0 };
        let found = history.reduced_time(0.0, until);
        println!("{name}: {found:?} after {} calls", calls.load(Relaxed));
        assert!(calls.load(Relaxed) < most, "{name}: {}", calls.load(Relaxed));
        match accuracy {
            // the mean over a million points, which meets every knot and stair
            Some(within) => {
                let exact = |t: f64| 1.0 / wlf().shift_factor(REFERENCE + closure(t)).unwrap();
                let points = 1_000_000;
                let nodes = [0.5 - 0.5 / 3_f64.sqrt(), 0.5 + 0.5 / 3_f64.sqrt()];
                let mean: f64 = (0..points)
                    .map(|k| {
                        nodes.iter().map(|node| 0.5 * exact((f64::from(k) + node) / f64::from(points))).sum::<f64>()
                    })
                    .sum();
                close(found.unwrap(), mean / f64::from(points), within.max(1e-11), name);
            }
            None if name == "overflow" => assert!(matches!(found, Err(Error::OutOfRange { .. })), "{found:?}"),
            None => {
                let error = found.unwrap_err();
                assert!(error.code() == "material_rough_temperature" && error.value().unwrap() > 1e-5, "{error}");
            }
        }
    }
}
