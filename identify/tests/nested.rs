//! Models that contain each other, on random curves.

use std::ops::Range;

use viscocontact::states::ElasticStates;
use viscocontact_identify::{Curve, Experiment, Fit, FitWarning, Identification, Model, Nuisance, Protocol};

use crate::random::{choice, from_environment, generator, logarithmic, named, noisy, normal, uniform};

/// Seeds of the curves: `NESTED_CURVES` of them from `NESTED_SEED` on, or fewer.
fn seeds() -> Range<u64> {
    let first = from_environment("NESTED_SEED", 0);
    first..first + from_environment("NESTED_CURVES", 8)
}

const POWER_LAW: Model = Model::PowerLaw { cutoff: 1e-6 };

/// A curve with its material.
struct Case {
    curve: Curve,
    truth: Model,
    values: Vec<f64>,
    text: String,
}

/// A bead that approaches, or is held, or retracts too, through a spring or by its depth; the drive scatters by 1 nm.
fn case(seed: u64) -> Case {
    let rng = &mut generator(seed);
    let (truth, values) = match choice(rng, &[0, 1, 2, 3]) {
        0 => (Model::Elastic, vec![1.0e3]),
        1 => (Model::Maxwell, vec![1.0e3, logarithmic(rng, [0.05, 5.0])]),
        2 => (Model::Zener, vec![1.0e3, 1.0e3 * uniform(rng, [0.1, 0.9]), logarithmic(rng, [0.05, 1.0])]),
        _ => (POWER_LAW, vec![1.0e3, uniform(rng, [0.05, 0.5])]),
    };
    let parts = choice(rng, &["approach", "hold", "whole"]);
    let count = choice(rng, &[150, 300, 600]);
    let end = match parts {
        "approach" => 1.0,
        "hold" => 2.0,
        _ => 3.0,
    };
    let has_spring = choice(rng, &[true, false]);
    let noise = logarithmic(rng, [3e-3, 3e-2]);
    let times: Vec<f64> = (0..count).map(|k| end * f64::from(k) / f64::from(count - 1)).collect();
    let at = |t: f64| 1.2e-6 * t.min(1.0).min(3.0 - t) - 0.2e-6;
    let drive = times.iter().map(|&t| at(t) + 1e-9 * normal(rng)).collect();
    let mut experiment = Experiment::new(Protocol::new(times, drive).unwrap(), ElasticStates::sphere(5e-6).unwrap());
    if has_spring {
        experiment = experiment.with_spring(logarithmic(rng, [5e-3, 5e-2])).unwrap();
    }
    let names = truth.parameters();
    let named = named(&names, &values);
    let curve = noisy(&Identification::new(truth), experiment, &named, |greatest| noise * greatest * normal(rng));
    let text =
        format!("seed {seed}: {truth:?} {values:?}, {parts}, {count} points, spring {has_spring}, noise {noise:.3}");
    Case { curve, truth, values, text }
}

fn sum(fit: &Fit) -> f64 {
    fit.residuals(0).iter().map(|residual| residual * residual).sum()
}

/// No model ends above one that it contains, and a search that starts at the truth ends where the default search does.
#[test]
fn searches_end_at_the_minimum() {
    let contained = [
        (Model::Elastic, Model::Maxwell),
        (Model::Maxwell, Model::Zener),
        (Model::Zener, Model::Prony(2)),
        (Model::Elastic, POWER_LAW),
        (Model::Zener, Model::FractionalZener),
    ];
    let fitting = |model: Model| Identification::new(model).contact_point(Nuisance::Fitted);
    let (mut compared, mut above, mut apart, mut iterations) = (0, Vec::new(), Vec::new(), 0);
    for seed in seeds() {
        let Case { curve, truth, values, text } = case(seed);
        let data = std::slice::from_ref(&curve);
        let fit = |model: Model| fitting(model).fit(data).unwrap_or_else(|error| panic!("{text}: {model:?}: {error}"));
        let models = [Model::Elastic, Model::Maxwell, Model::Zener, Model::Prony(2), POWER_LAW, Model::FractionalZener];
        let fits = models.map(fit);
        let of = |model: Model| fits.iter().find(|fit| fit.model() == model).unwrap();
        for (inner, outer) in contained {
            let ratio = sum(of(outer)) / sum(of(inner)) - 1.0;
            compared += 1;
            if ratio > 1e-6 || of(outer).warnings().iter().any(|w| matches!(w, FitWarning::AboveContained { .. })) {
                above.push(format!("{text}: {outer:?} over {inner:?} by {ratio:.2e}"));
            }
        }
        let mut at_truth = fitting(truth);
        for (name, value) in truth.parameters().iter().zip(&values) {
            at_truth = at_truth.start(name, *value);
        }
        let (default, known) = (sum(of(truth)), at_truth.fit(data).as_ref().map_or(f64::NAN, sum));
        iterations += of(truth).iterations();
        println!("{text}: default over known {:.1e}; {} above so far", default / known - 1.0, above.len());
        if (default / known - 1.0).abs() > 1e-6 || known.is_nan() {
            apart.push(format!("{text}: default start {:.2e} above the start at the truth", default / known - 1.0));
        }
    }
    let (curves, [pairs, starts]) = (seeds().count(), [above.len(), apart.len()]);
    println!("{compared} pairs, {pairs} above; {starts} of {curves} starts apart; {iterations} iterations");
    assert_eq!(compared, 5 * curves);
    println!("{}\n{}", above.join("\n"), apart.join("\n"));
    assert!(above.is_empty());
    assert!(starts <= curves.div_ceil(100));
}
