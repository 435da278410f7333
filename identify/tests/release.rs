//! Pull-offs of random curves are told from drag, drift, tilt and noise that are part of the fit. `RELEASES` (60) chooses the number of curves.

use viscocontact::states::ElasticStates;
use viscocontact_identify::{Curve, Experiment, FitWarning, Identification, Model, Noise, Nuisance, Protocol};

use crate::random::{choice, correlated, from_environment, generator, logarithmic, uniform};

/// A random curve, what is to be fitted to it, and its pull over the greatest force and over the noise of a block.
fn curve(seed: u64) -> (Curve, Identification, f64) {
    let rng = &mut generator(seed);
    let radius = logarithmic(rng, [1e-6, 20e-6]);
    let (apart, depth) = (uniform(rng, [0.1, 0.5]) * radius, uniform(rng, [0.05, 0.2]) * radius);
    let (speed, hold) = (logarithmic(rng, [0.1, 10.0]) * radius, uniform(rng, [0.0, 3.0]));
    let ramp = (apart + depth) / speed;
    let duration = 2.0 * ramp + hold * ramp;
    let count = choice(rng, &[300, 500, 1000]);
    let protocol =
        Protocol::ramp_hold_retract(speed, [apart, depth], hold * ramp, duration / f64::from(count)).unwrap();
    let experiment = Experiment::new(protocol, ElasticStates::sphere(radius).unwrap());
    let modulus = logarithmic(rng, [1e2, 1e6]);
    let values =
        [("E0", modulus), ("Einf", uniform(rng, [0.1, 0.6]) * modulus), ("tau", uniform(rng, [0.2, 1.0]) * ramp)];
    let pure = Identification::new(Model::Zener).respond(&experiment, &values).unwrap();
    let greatest = pure.iter().map(|sample| sample.force).fold(0.0, f64::max);
    let (times, drive) = (experiment.protocol().times(), experiment.protocol().drive());
    let (phi, noise) = (choice(rng, &[0.0, 0.0, 0.9]), logarithmic(rng, [1e-3, 2e-2]));
    let scatter: Vec<f64> = {
        let mut scatter = correlated(phi, rng);
        times.iter().map(|_| noise * greatest * scatter()).collect()
    };
    let mut of = Identification::new(Model::Zener).contact_point(Nuisance::Fitted).offset(Nuisance::Fitted);
    let mut size = |fitted: fn(Identification, Nuisance) -> Identification| {
        if choice(rng, &[true, false]) {
            return 0.0;
        }
        of = fitted(of.clone(), Nuisance::Fitted);
        uniform(rng, [-0.1, 0.1]) * greatest
    };
    let (drift, tilt) = (size(Identification::drift), size(Identification::tilt));
    let drag = size(Identification::drag).abs();
    if phi > 0.0 {
        of = of.noise(Noise::Autoregressive);
    }
    let pull = if choice(rng, &[true, false]) { uniform(rng, [0.05, 0.3]).max(10.0 * noise) } else { 0.0 };
    // on the way back the tip adheres from where the contact ends over a part of the approach
    let end = pure.iter().rposition(|sample| sample.contact_depth > 0.0).unwrap();
    let reach = uniform(rng, [0.2, 0.5]) * (times[times.len() - 1] - times[end]);
    let force = (0..times.len()).map(|k| {
        let next = (k + 1).min(times.len() - 1);
        let velocity = (drive[next] - drive[next - 1]) / (times[next] - times[next - 1]);
        let since = (times[k] - times[end]) / reach;
        let adhesion = if (0.0..1.0).contains(&since) { pull * greatest * (1.0 - since) } else { 0.0 };
        let linear = drift * times[k] / duration + tilt * drive[k] / (apart + depth) + drag * velocity / speed;
        pure[k].force + scatter[k] + linear - adhesion
    });
    let force = force.collect();
    (Curve::new(experiment, force).unwrap(), of, pull)
}

#[test]
fn pull_offs_are_told_from_what_the_fit_explains() {
    let curves = from_environment("RELEASES", 60);
    let (mut with, mut without, mut missed, mut wrong) = (0, 0, Vec::new(), Vec::new());
    for seed in 0..curves {
        let (curve, identification, pull) = curve(seed);
        let fit =
            identification.fit(std::slice::from_ref(&curve)).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let told = fit.warnings().iter().any(|warning| matches!(warning, FitWarning::PullOff { .. }));
        *if pull > 0.0 { &mut with } else { &mut without } += 1;
        if told != (pull > 0.0) {
            if told { &mut wrong } else { &mut missed }.push((seed, pull));
        }
    }
    println!("{with} with, {missed:?} missed; {without} without, {wrong:?} wrongly told");
    assert!(with >= curves / 3 && without >= curves / 3, "{with} {without}");
    assert!(50 * missed.len() as u64 <= with && 50 * wrong.len() as u64 <= without, "{missed:?} {wrong:?}");
}
