//! Deviations and intervals under noise, over many seeds.

use std::sync::Arc;

use viscocontact::states::ElasticStates;
use viscocontact_identify::{Curve, Fit, FitWarning, Identification, Model, Noise, Nuisance};

use crate::coverage::{ZENER, experiment};
use crate::random::{self, correlated, from_environment, generator};

fn seeds() -> u64 {
    from_environment("NOISE_SEEDS", 30)
}

/// A noisy curve of 1000 samples, and the deviation of the independent part of its noise: 1 % of the greatest force without correlation.
fn noisy(tip: &Arc<ElasticStates>, model: Model, truth: &[(&str, f64)], phi: f64, seed: u64) -> (Curve, f64) {
    let (rng, mut sigma) = (&mut generator(seed), 0.0);
    let mut noise = correlated(phi, rng);
    let curve = random::noisy(&Identification::new(model), experiment(Arc::clone(tip), 1000), truth, |greatest| {
        sigma = 0.01 * greatest;
        sigma * noise()
    });
    (curve, sigma * (1.0 - phi * phi).sqrt())
}

/// Bias, spread and coverage of the parameters of a Zener body and the contact point.
fn statistics_under(noise: Noise, phi: f64) {
    let sphere = ElasticStates::sphere(9.0 / 16.0).unwrap();
    let fitting = Identification::new(Model::Zener).contact_point(Nuisance::Fitted).noise(noise);
    let fits: Vec<Fit> =
        (0..seeds()).map(|seed| fitting.fit(&[noisy(&sphere, Model::Zener, &ZENER, phi, seed).0]).unwrap()).collect();
    let sigma = noisy(&sphere, Model::Zener, &ZENER, phi, 0).1;
    let exact = Identification::new(Model::Zener).contact_point(Nuisance::Fitted).noise(Noise::AutoregressiveWith(phi));
    let bounds = exact.bounds(&[experiment(sphere, 1000)], &ZENER, sigma).unwrap();
    let count = seeds() as f64;
    // limits of the asked 300 seeds, and beyond them the scatter of fewer ones: three standard errors
    let more = 3.0 * ((300.0 / count).sqrt() - 1.0).max(0.0);
    for (name, truth) in ZENER.into_iter().chain([("contact point", 0.0)]) {
        let on_scale = |value: f64| if name == "contact point" { value } else { (value / truth).ln() };
        let deviations: Vec<f64> = fits.iter().map(|fit| on_scale(fit.estimate(name).unwrap().value)).collect();
        let bias = deviations.iter().sum::<f64>() / count;
        let spread = (deviations.iter().map(|d| (d - bias) * (d - bias)).sum::<f64>() / (count - 1.0)).sqrt();
        let covered = |fit: &Fit| {
            let [low, high] = fit.estimate(name).unwrap().interval;
            low <= truth && truth <= high
        };
        let coverage = fits.iter().filter(|fit| covered(fit)).count() as f64 / count;
        let bound = bounds.deviation(name).unwrap();
        let stated = fits.iter().map(|fit| fit.estimate(name).unwrap().deviation).sum::<f64>() / count;
        println!(
            "{name}, φ = {phi}: bias {:.3} of the spread, spread {:.3}, stated {:.3} of the bound, coverage {:.3}",
            bias / spread,
            spread / bound,
            stated / bound,
            coverage
        );
        assert!(bias.abs() / spread < 0.1 + more / 300.0_f64.sqrt(), "{name}: bias");
        assert!(spread / bound < 1.2 + more / 600.0_f64.sqrt() && spread / bound > 0.8, "{name}: spread");
        assert!((coverage - 0.95).abs() <= 0.03 + more * 0.0126, "{name}: coverage");
        assert!((stated / bound - 1.0).abs() < 0.1, "{name}: stated deviations");
    }
}

#[test]
fn white_noise_has_the_least_spread_and_true_intervals() {
    statistics_under(Noise::White, 0.0);
}

#[test]
fn autoregressive_noise_has_the_least_spread_and_true_intervals() {
    statistics_under(Noise::Autoregressive, 0.5);
}

/// Models that are wrong, with the share of seeds in which the residuals tell.
#[test]
fn wrong_models_are_flagged() {
    let sphere = ElasticStates::sphere(9.0 / 16.0).unwrap();
    let cone = ElasticStates::cone(1.0).unwrap();
    let two_times = [("Einf", 0.25), ("E1", 0.4), ("tau1", 0.03), ("E2", 0.35), ("tau2", 1.0)];
    let power = [("E1", 0.6), ("alpha", 0.3)];
    let flagged = |fit: &Fit| fit.warnings().iter().any(|warning| matches!(warning, FitWarning::Misfit { .. }));
    let share = |truth: Model, values: &[(&str, f64)], fitted: Model, tip: &Arc<ElasticStates>| {
        let assumed = experiment(Arc::clone(tip), 1000);
        let fitting = Identification::new(fitted).contact_point(Nuisance::Fitted);
        let is_flagged = |seed: u64| {
            let curve = noisy(&sphere, truth, values, 0.0, seed).0;
            flagged(&fitting.fit(&[Curve::new(assumed.clone(), curve.force().to_vec()).unwrap()]).unwrap())
        };
        let seeds = (seeds() / 3).max(10);
        (0..seeds).filter(|&seed| is_flagged(seed)).count() as f64 / seeds as f64
    };
    let right = share(Model::Zener, &ZENER, Model::Zener, &sphere);
    let wrong = [
        ("a cone for a sphere", share(Model::Zener, &ZENER, Model::Zener, &cone)),
        ("an elastic body for a Zener body", share(Model::Zener, &ZENER, Model::Elastic, &sphere)),
        ("a Maxwell body for a Zener body", share(Model::Zener, &ZENER, Model::Maxwell, &sphere)),
        ("one relaxation time for two", share(Model::Prony(2), &two_times, Model::Zener, &sphere)),
        (
            "one relaxation time for a power of time",
            share(Model::PowerLaw { cutoff: 1e-5 }, &power, Model::Zener, &sphere),
        ),
    ];
    println!("the right model is flagged in {right:.2} of the seeds");
    for (name, share) in wrong {
        println!("{name}: flagged in {share:.2}");
        assert!(share >= 0.95, "{name}");
    }
    assert!(right <= 0.05);
}
