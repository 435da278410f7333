//! What a fit states of its parameters.

use viscocontact::Error as ContactError;
use viscocontact::prelude::*;
use viscocontact::states::{ElasticStates, Reach, Sweep};
use viscocontact_identify::{Curve, Error, Experiment, FitWarning, Identification, Model, Nuisance, Protocol, ranked};

use crate::random::{exact, generator, noisy, normal};

const BODY: [(&str, f64); 3] = [("E0", 1.0), ("Einf", 0.25), ("tau", 1.0)];

/// A ball pressed to a depth of 1 in `rise`, held until 2, and drawn back, in `count` samples; 1 % of noise.
fn curve(rise: f64, count: usize, noise: f64, seed: u64) -> Curve {
    let times: Vec<f64> = (0..count).map(|k| 2.6 * k as f64 / (count - 1) as f64).collect();
    let drive = times.iter().map(|&t: &f64| (t / rise).min(1.0).min(3.0 - t)).collect();
    let sphere = ElasticStates::sphere(9.0 / 16.0).unwrap();
    let experiment = Experiment::new(Protocol::new(times, drive).unwrap(), sphere);
    let rng = &mut generator(seed);
    noisy(&Identification::new(Model::Zener), experiment, &BODY, |greatest| noise * greatest * normal(rng))
}

/// Many samples make the sum of squares a parabola: both intervals agree. Few make it a valley that is open to one side, and the
/// profile is longer there.
#[test]
fn profile_intervals_are_the_others_where_the_sum_of_squares_is_a_parabola() {
    let fit = Identification::new(Model::Zener).fit(&[curve(1.0, 1000, 0.01, 1)]).unwrap();
    for name in ["E0", "Einf", "tau"] {
        let (profile, plain) = (fit.profile_interval(name, 0.95).unwrap(), fit.estimate(name).unwrap().interval);
        let width = (plain[1] / plain[0]).ln();
        for (a, b) in profile.iter().zip(plain) {
            assert!((a / b).ln().abs() < 0.1 * width, "{name}: {profile:?} {plain:?}");
        }
    }
    let fit = Identification::new(Model::Zener).fit(&[curve(1.0, 40, 0.05, 2)]).unwrap();
    let (profile, plain) = (fit.profile_interval("Einf", 0.95).unwrap(), fit.estimate("Einf").unwrap().interval);
    assert!(profile[0] < 0.8 * plain[0] && profile[1] < plain[1], "{profile:?} {plain:?}");
    assert!(matches!(fit.profile_interval("alpha", 0.95), Err(Error::UnknownParameter { .. })));
    assert!(matches!(fit.profile_interval("tau", 1.0), Err(Error::Contact(ContactError::OutOfRange { .. }))));
}

/// Two curves of other speeds leave less doubt than either, as their information adds up.
#[test]
fn curves_are_fitted_together() {
    let curves = [curve(1.0, 400, 0.01, 3), curve(0.05, 400, 0.01, 4)];
    let zener = Identification::new(Model::Zener).contact_point(Nuisance::Fitted);
    let both = zener.fit(&curves).unwrap();
    let each = curves.each_ref().map(|curve| zener.fit(std::slice::from_ref(curve)).unwrap());
    for name in ["E0", "Einf", "tau"] {
        let deviation = both.estimate(name).unwrap().deviation;
        assert!(each.iter().all(|fit| deviation < fit.estimate(name).unwrap().deviation), "{name}");
    }
    assert!(both.estimate("contact point 1").is_some() && both.estimate("contact point").is_none());
    // the scene has no units: only its slope of 1.3 and its modulus of 1 Pa are warned of
    let of_contact = |warning: &FitWarning| matches!(warning, FitWarning::Contact { .. });
    assert!(both.warnings().iter().all(of_contact), "{:?}", both.warnings());
}

/// A curve of an elastic body, fitted by models that contain it at the limit E0 = Einf: their modulus is as uncertain as that of the elastic model, and
/// a parameter next to the limit, the other one known, is not certain.
#[test]
fn nothing_is_certain_at_a_limit() {
    let times: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
    let drive = times.iter().map(|t| t.min(1.0)).collect();
    let experiment = Experiment::new(Protocol::new(times, drive).unwrap(), ElasticStates::sphere(9.0 / 16.0).unwrap());
    let of = Identification::new(Model::Elastic);
    let mut at_limit = [0; 2];
    for seed in 0..6 {
        let rng = &mut generator(seed);
        let curve = [noisy(&of, experiment.clone(), &[("E", 1.0)], |_| 0.01 * normal(rng))];
        let elastic = Identification::new(Model::Elastic).fit(&curve).unwrap().estimates()[0].deviation;
        for (model, exponent) in [(Model::Zener, ""), (Model::Stretched, "beta"), (Model::FractionalZener, "alpha")] {
            let mut fitting = Identification::new(model).fix("tau", 0.3);
            if !exponent.is_empty() {
                fitting = fitting.fix(exponent, 0.5);
            }
            let fit = fitting.fit(&curve).unwrap();
            let is_at_limit = fit.estimate("E0").unwrap().limit.is_some();
            at_limit[0] += usize::from(is_at_limit);
            for time in [0.01, 0.1, 1.0] {
                let ratio = fit.modulus_band(time)[1] / elastic;
                assert!((0.9..10.0).contains(&ratio), "{model}, {seed}: {ratio} at {time}, at the limit {is_at_limit}");
            }
            for (known, other) in [("E0", "Einf"), ("Einf", "E0")] {
                let fit = fitting.clone().fix(known, 1.0).fit(&curve).unwrap();
                let estimate = fit.estimate(other).unwrap();
                let [low, high] = estimate.interval;
                at_limit[1] += usize::from(estimate.limit.is_some());
                assert!(estimate.deviation > 1e-4 && low < 0.9999 * high, "{model}, {seed}: {estimate:?}");
                assert!(estimate.limit.is_none_or(|limit| limit.ends_with("no relaxation")), "{estimate}");
                let [low, high] = fit.profile_interval(other, 0.95).unwrap();
                assert!(low > 0.8 && high < 1.25 && low < 0.9999 * high, "{model}, {seed}: {low} to {high}");
            }
        }
    }
    println!("at the limit: {at_limit:?} of 18 and 36");
    assert!(at_limit[0] > 3 && at_limit[1] > 6);
}

/// As many parameters as samples are no good model, however small the sum of squares.
#[test]
fn a_saturated_model_is_not_ranked_first() {
    for count in [4, 5] {
        let times: Vec<f64> = (0..count).map(f64::from).collect();
        let drive = times.iter().map(|t| 1.0 + t).collect();
        let force = times.iter().map(|t| 1.0 + t - 0.02 * t * t).collect();
        let experiment = Experiment::new(Protocol::new(times, drive).unwrap(), ElasticStates::punch(0.5).unwrap());
        let curve = Curve::new(experiment, force).unwrap();
        let fit = |model: Model| Identification::new(model).fit(std::slice::from_ref(&curve));
        let best = ranked([fit(Model::Zener), fit(Model::Elastic)]).unwrap();
        let found: Vec<_> = best.iter().map(|(fit, more, weight)| (fit.model(), *more, *weight)).collect();
        assert_eq!(found, [(Model::Elastic, 0.0, 1.0), (Model::Zener, f64::INFINITY, 0.0)]);
        let alone = ranked([fit(Model::Zener), fit(Model::Zener)]).unwrap();
        assert!(alone.iter().all(|(fit, more, weight)| (fit.aicc(), *more, *weight) == (f64::INFINITY, 0.0, 0.5)));
    }
}

/// A loading that is short against the relaxation time does not determine it, and a fit says so.
#[test]
fn data_that_do_not_contain_a_time_are_named() {
    let times: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k) / 299.0).collect();
    let drive = times.iter().map(|t| 100.0 * t).collect();
    let experiment = Experiment::new(Protocol::new(times, drive).unwrap(), ElasticStates::sphere(9.0 / 16.0).unwrap());
    let rng = &mut generator(6);
    let curve = noisy(&Identification::new(Model::Zener), experiment, &BODY, |_| 0.01 * normal(rng));
    let fit = |model: Model| Identification::new(model).fit(std::slice::from_ref(&curve));
    match fit(Model::Zener) {
        Ok(fit) => {
            let is_about = |warning: &FitWarning| {
                matches!(
                    warning,
                    FitWarning::Undetermined { .. } | FitWarning::TimeOutside { .. } | FitWarning::Correlated { .. }
                )
            };
            assert!(fit.warnings().iter().any(is_about), "{:?} {:?}", fit.warnings(), fit.estimates());
            let best =
                ranked([Ok(fit), Identification::new(Model::Elastic).fit(std::slice::from_ref(&curve))]).unwrap();
            assert_eq!(best[0].0.model(), Model::Elastic);
        }
        Err(error) => assert!(matches!(error, Error::NotConverged { .. }), "{error}"),
    }
}

/// A fit warns of what is outside the model at the deepest contact of a curve, as a step there does: a pyramid of 35 degrees, a ball pressed
/// in by half its radius, a thin gel, a modulus in MPa; and of nothing else.
#[test]
fn fits_warn_of_contacts_outside_the_model() {
    let (depth, cells) = (1.0e-6, 48);
    let gel = |thickness: f64, cells: usize| {
        let grid = Grid::square(cells, 16.0e-6).unwrap();
        let layer = Layer::bonded_to_rigid(thickness, 0.45).unwrap();
        let sweep = Sweep::new(grid.clone(), &Sphere::new(20.0e-6).unwrap());
        sweep
            .kernel(InfluenceKernel::layer(&grid, layer).unwrap())
            .accuracy(1e-3)
            .run(Reach::Approach(1.1 * depth))
            .unwrap()
    };
    let tips = [
        (
            "steeper than 0.5 in contact",
            ElasticStates::cone(1.0 / 35.0_f64.to_radians().tan()).unwrap(),
            2.0e3,
            "(maximum slope 1.428)",
        ),
        ("steeper than 0.5 in contact", ElasticStates::sphere(2.0e-6).unwrap(), 2.0e3, "(maximum slope 0.7071)"),
        ("pressed in by over a fifth of its thickness", gel(4.0e-6, cells), 2.0e3, "(depth over thickness 0.2"),
        ("fewer than 8 cells across", gel(100.0e-6, 13), 2.0e3, "(cells across: "),
        ("no solid has such a modulus", ElasticStates::sphere(20.0e-6).unwrap(), 2.0e-3, "(E* in Pa: 0.002)"),
        ("", gel(100.0e-6, cells), 2.0e3, ""),
        ("", ElasticStates::sphere(20.0e-6).unwrap(), 2.0e3, ""),
    ];
    for (expected, tip, modulus, number) in tips {
        let protocol = Protocol::trapezoid(depth, [0.2, 1.0, 0.2], 0.02).unwrap();
        let experiment = Experiment::new(protocol, tip);
        let zener = Identification::new(Model::Zener);
        let body = [("E0", modulus), ("Einf", 0.25 * modulus), ("tau", 0.3)];
        let fit = zener.fit(&[exact(&zener, experiment, &body)]).unwrap();
        let texts: Vec<String> =
            fit.warnings().iter().map(ToString::to_string).filter(|text| text.starts_with("curve 0")).collect();
        if expected.is_empty() {
            assert!(texts.is_empty(), "{texts:?}");
        } else {
            assert!(texts.iter().any(|text| text.contains(expected) && text.contains(number)), "{expected}: {texts:?}");
            assert!(texts.len() == 1, "{texts:?}");
        }
    }
    // an error that ends a program says what to do
    let error = Error::BeyondStates { curve: 0, depth: 1.0e-6 };
    assert_eq!(format!("{error:?}"), error.to_string());
}
