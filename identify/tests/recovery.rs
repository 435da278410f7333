//! Parameters are found again.

use viscocontact::Error as ContactError;
use viscocontact::load::{Load, LoadHistory};
use viscocontact::states::ElasticStates;
use viscocontact_identify::{Curve, Error, Experiment, Identification, Law, Model, Nuisance, Protocol};

use crate::random::{exact, from_environment, generator, named, normal};
use crate::scenes::scene;

fn scenes() -> u64 {
    from_environment("RECOVERY_SCENES", 40)
}

/// Without noise, each parameter that 1 % of noise would leave known within 30 % is found to 1e-6.
#[test]
fn parameters_are_found_without_noise() {
    let (mut identifiable, mut wrong) = (0, Vec::new());
    for seed in 0..scenes() {
        let scene = scene(seed);
        let known = scene.identification.clone().contact_point(Nuisance::Fixed(scene.contact_point));
        let curve = exact(&known, scene.experiment.clone(), &scene.named());
        let greatest = curve.force().iter().copied().fold(0.0, f64::max);
        let mut expected = scene.named();
        expected.push(("contact point", scene.contact_point));
        let bounds = scene.identification.bounds(std::slice::from_ref(&scene.experiment), &expected, 0.01 * greatest);
        let limits = |name: &str| match name {
            "contact point" => scene.depth,
            _ => 1.0,
        };
        let is_known = |name: &str| {
            bounds.as_ref().is_ok_and(|bounds| bounds.deviation(name).is_some_and(|d| d < 0.3 * limits(name)))
        };
        let names: Vec<&str> = expected.iter().map(|(name, _)| *name).collect();
        let is_free = |name: &str| bounds.as_ref().is_ok_and(|bounds| bounds.deviation(name).is_some());
        if !names.iter().all(|name| is_known(name) || !is_free(name)) || bounds.is_err() {
            continue;
        }
        identifiable += 1;
        let fit = match scene.identification.fit(&[curve]) {
            Ok(fit) => fit,
            Err(error) => {
                wrong.push(format!("scene {seed}, {:?}: {error}", scene.identification.model()));
                continue;
            }
        };
        for (name, truth) in &expected {
            let Some(estimate) = fit.estimate(name) else { continue };
            let error = (estimate.value - truth).abs() / if *name == "contact point" { scene.depth } else { *truth };
            if error > 1e-6 {
                wrong.push(format!("scene {seed}, {:?}: {name} off by {error:e}", scene.identification.model()));
            }
        }
    }
    println!("{identifiable} of {} scenes are identifiable", scenes());
    assert!(wrong.is_empty(), "{} of {identifiable}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(identifiable as u64 > scenes() / 2);
}

/// A soft spring takes most of the drive, and the states of the tip end a little deeper than the tip went.
#[test]
fn states_need_not_reach_as_deep_as_the_drive() {
    let protocol = Protocol::trapezoid(10.0e-6, [0.5, 2.0, 0.5], 0.01).unwrap();
    let zener = Identification::new(Model::Zener);
    let body = [("E0", 4.0e4), ("Einf", 1.0e4), ("tau", 0.5)];
    let force = |tip: &std::sync::Arc<ElasticStates>| {
        let experiment = Experiment::new(protocol.clone(), tip.clone()).with_spring(0.05).unwrap();
        let samples = zener.respond(&experiment, &body).unwrap();
        let deepest = samples.iter().fold(0.0, |most: f64, sample| most.max(sample.depth));
        (Curve::new(experiment, samples.iter().map(|sample| sample.force).collect()).unwrap(), deepest)
    };
    let sphere = ElasticStates::sphere(5.0e-6).unwrap();
    let (_, deepest) = force(&sphere);
    assert!(deepest < 7.0e-6, "{deepest:e}");
    let row = |depth: f64| {
        let level = sphere.level_at(depth);
        (level, depth, sphere.stiffness(level), sphere.area(level))
    };
    let short = ElasticStates::from_table(&[row(1e-3 * deepest), row(1.05 * deepest)]).unwrap();
    let fit = zener.fit(&[force(&short).0]).unwrap();
    for (name, value) in body {
        assert!((fit.estimate(name).unwrap().value / value - 1.0).abs() < 1e-6, "{name}");
    }
}

/// Without noise, through a spring and with 1 nm of scatter of the drive, retraction included: forces are computed on a drive that is sampled 16
/// times as densely, so that errors of the fit are those of its intervals.
#[test]
fn intervals_between_samples_cost_little() {
    let mut rng = generator(11);
    let body = [("E0", 4.0e3), ("Einf", 1.0e3), ("tau", 0.5)];
    let zener = Identification::new(Model::Zener);
    let tips = [
        ("cone", ElasticStates::cone(0.7).unwrap(), 1e-6),
        ("punch", ElasticStates::punch(2.0e-6).unwrap(), 1e-6),
        ("sphere", ElasticStates::sphere(5.0e-6).unwrap(), 1e-5),
    ];
    let mut errors = Vec::new();
    for (name, tip, limit) in tips {
        for count in [250_u32, 500, 1000] {
            let times: Vec<f64> = (0..=count).map(|k| 3.0 * f64::from(k) / f64::from(count)).collect();
            let at = |t: f64| 1.0e-6 * (2.0 * t).min(1.0).min(3.0 - t) - 0.1e-6;
            let drive: Vec<f64> = times.iter().map(|&t| at(t) + 1e-9 * normal(&mut rng)).collect();
            let protocol = Protocol::new(times, drive).unwrap();
            let finer: Vec<f64> = (0..=16 * count).map(|k| 3.0 * f64::from(k) / f64::from(16 * count)).collect();
            let history = Experiment::new(protocol.clone(), tip.clone()).load_history().unwrap();
            let drive =
                |&t: &f64| if let Load::Approach { approach, .. } = history.at(t) { approach } else { f64::NAN };
            let drive = finer.iter().map(drive).collect();
            let fine = Protocol::new(finer, drive).unwrap();
            let experiment = |protocol: Protocol| Experiment::new(protocol, tip.clone()).with_spring(0.05).unwrap();
            let samples = zener.respond(&experiment(fine), &body).unwrap();
            let force = samples.iter().step_by(16).map(|sample| sample.force).collect();
            let fit = zener.fit(&[Curve::new(experiment(protocol), force).unwrap()]).unwrap();
            let error = |(name, truth): (&str, f64)| (fit.estimate(name).unwrap().value / truth - 1.0).abs();
            let worst = body.map(error).into_iter().fold(0.0, f64::max);
            println!("{name}, {count} points: {worst:.1e}");
            errors.push(worst);
            assert!(count < 1000 || worst < limit, "{name}: {worst:e}");
        }
    }
    // of second order in the points
    assert_eq!(errors.len(), 9);
    assert!(errors.chunks(3).all(|of| of[2] < of[0] / 8.0), "{errors:?}");
}

/// Laws that are no sums of few exponentials, one of them the user's.
#[test]
fn laws_of_other_kinds_are_found() {
    let logarithmic = Law {
        name: "logarithmic",
        parameters: &["E0", "tau"],
        modulus: |of, t| of[0] / (1.0 + 0.2 * (t / of[1]).ln_1p()),
    };
    // whatever the order and the names of parameters
    let power = Law { name: "power", parameters: &["alpha", "E1"], modulus: |of, t| of[1] * (t + 1e-4).powf(-of[0]) };
    let solid =
        Law { name: "solid", parameters: &["E1", "Einf", "tau"], modulus: |of, t| of[1] + of[0] * (-t / of[2]).exp() };
    let cases: [(Model, &[f64]); 9] = [
        (Model::Elastic, &[1.0e3]),
        (Model::Maxwell, &[1.0e3, 0.3]),
        (Model::Prony(2), &[5.0e2, 1.0e3, 0.05, 2.0e3, 0.6]),
        (Model::FractionalZener, &[4.0e3, 1.0e3, 0.3, 0.6]),
        (Model::Custom(power), &[0.2, 1.0e3]),
        (Model::Custom(solid), &[5.0e2, 1.0e3, 0.3]),
        (Model::Stretched, &[4.0e3, 1.0e3, 0.3, 0.6]),
        (Model::PowerLawSolid { cutoff: 1e-6 }, &[1.0e3, 0.4, 5.0e2]),
        (Model::Custom(logarithmic), &[4.0e3, 0.05]),
    ];
    let protocol = Protocol::trapezoid(1.0e-6, [0.2, 2.0, 0.3], 0.01).unwrap();
    let experiment = Experiment::new(protocol, ElasticStates::sphere(5.0e-6).unwrap());
    let mut compared = 0;
    for (model, truth) in cases {
        let (fitting, names) = (Identification::new(model), model.parameters());
        let named = named(&names, truth);
        let [first, soon] = [0.0, 1e-9].map(|t| model.modulus(truth, t).unwrap());
        assert!(first.is_finite() && first >= soon && soon > 0.0, "{model}: {first} {soon}");
        if let Model::Stretched | Model::FractionalZener | Model::Custom(_) = model {
            let at_once = if let Model::Custom(law) = model { (law.modulus)(truth, 0.0) } else { truth[0] };
            assert!((first / at_once - 1.0).abs() < 1e-6, "{model}: {first} for {at_once}");
        }
        for time in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(
                matches!(
                    model.modulus(truth, time),
                    Err(Error::Contact(ContactError::OutOfRange { field: "time", .. }))
                ),
                "{model}"
            );
        }
        let fit = fitting.fit(&[exact(&fitting, experiment.clone(), &named)]).unwrap();
        for (name, value) in named {
            let error = fit.estimate(name).unwrap().value / value - 1.0;
            assert!(error.abs() < 1e-6, "{model}: {name} off by {error:e}");
            compared += 1;
        }
    }
    assert_eq!(compared, 26);
}
