//! Intervals over many seeds: correlated noise, curves of unequal noise, outliers.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;
use viscocontact::states::ElasticStates;
use viscocontact_identify::{Curve, Experiment, Fit, Identification, Model, Noise, Nuisance, Protocol};

use crate::random::{self, correlated, from_environment, generator, named, normal};

pub const ZENER: [(&str, f64); 3] = [("E0", 1.0), ("Einf", 0.25), ("tau", 1.0)];

fn seeds() -> u64 {
    from_environment("COVERAGE_SEEDS", 12)
}

/// Depth 1 in unit time, held to 2, and out at unit speed.
pub fn experiment(tip: std::sync::Arc<ElasticStates>, count: u32) -> Experiment {
    let times: Vec<f64> = (0..count).map(|k| 3.2 * f64::from(k) / f64::from(count - 1) - 0.2).collect();
    let drive = times.iter().map(|&t: &f64| t.min(1.0).min(3.0 - t)).collect();
    Experiment::new(Protocol::new(times, drive).unwrap(), tip)
}

/// A curve with noise of standard deviation `sigma`, each deviation `phi` times the one before plus an independent part.
fn noisy(experiment: &Experiment, sigma: f64, phi: f64, rng: &mut ChaCha8Rng) -> Curve {
    let mut noise = correlated(phi, rng);
    random::noisy(&Identification::new(Model::Zener), experiment.clone(), &ZENER, |_| sigma * noise())
}

/// Share of the fits whose 95 % interval of a parameter contains the truth, and the root of the mean squared error of its logarithm.
fn coverage(fits: &[Fit], name: &str, truth: f64) -> [f64; 2] {
    let inside = |fit: &&Fit| {
        let [low, high] = fit.estimate(name).unwrap().interval;
        low <= truth && truth <= high
    };
    let count = fits.len() as f64;
    let square: f64 = fits.iter().map(|fit| (fit.estimate(name).unwrap().value / truth).ln().powi(2)).sum();
    [fits.iter().filter(inside).count() as f64 / count, (square / count).sqrt()]
}

/// The range of a coverage of 92 to 98 %, and beyond by three standard errors of fewer than 1000 seeds.
fn assert_covers(covered: f64, text: &str) {
    let more = 3.0 * (0.95_f64 * 0.05).sqrt() * ((1.0 / seeds() as f64).sqrt() - (1.0 / 1000.0_f64).sqrt()).max(0.0);
    assert!(covered > 0.92 - more && covered < 0.98 + more, "{text}: {covered}");
}

#[test]
fn correlated_noise_of_any_strength_has_true_intervals() {
    let fitting = Identification::new(Model::Zener).contact_point(Nuisance::Fitted).noise(Noise::Autoregressive);
    for (count, phi) in [86, 300, 1000].into_iter().flat_map(|count| [0.3, 0.7, 0.9].map(|phi| (count, phi))) {
        if count == 1000 && std::env::var("COVERAGE_SEEDS").is_err() {
            continue;
        }
        let experiment = experiment(ElasticStates::sphere(9.0 / 16.0).unwrap(), count);
        let fits: Vec<Fit> = (0..seeds())
            .map(|seed| {
                let curve = noisy(&experiment, 0.008, phi, &mut generator(seed));
                fitting.fit(&[curve]).unwrap()
            })
            .collect();
        let mean = fits.iter().map(|fit| fit.autoregression_of(0).unwrap_or_default()).sum::<f64>() / fits.len() as f64;
        for (name, truth) in ZENER {
            let [covered, error] = coverage(&fits, name, truth);
            println!("{count} points, φ {phi} (found {mean:.3}), {name}: covers {covered:.3}, error {error:.4}");
            // 86 points of this correlation are about five independent ones
            if (count, phi) != (86, 0.9) {
                assert_covers(covered, name);
            }
        }
    }
}

/// Noise 1 : 20 in two curves: together they are no worse than the better one.
#[test]
fn curves_of_unequal_noise_are_weighed() {
    let tips = [ElasticStates::sphere(9.0 / 16.0).unwrap(), ElasticStates::cone(1.0).unwrap()];
    let experiments = tips.map(|tip| experiment(tip, 300));
    let fitting = Identification::new(Model::Zener).contact_point(Nuisance::Fitted);
    let (mut joint, mut alone) = (Vec::new(), Vec::new());
    for seed in 0..seeds() {
        let rng = &mut generator(seed);
        let curves = [noisy(&experiments[0], 0.004, 0.0, rng), noisy(&experiments[1], 0.08, 0.0, rng)];
        alone.push(fitting.fit(&curves[..1]).unwrap());
        joint.push(fitting.fit(&curves).unwrap());
    }
    let ratio = joint.iter().map(|fit| fit.sigma_of(1) / fit.sigma_of(0)).sum::<f64>() / joint.len() as f64;
    assert!((ratio / 20.0 - 1.0).abs() < 0.1, "{ratio}");
    for (name, truth) in ZENER {
        let ([covered, together], [_, best]) = (coverage(&joint, name, truth), coverage(&alone, name, truth));
        println!("{name}: joint covers {covered:.3}, error {together:.4}, the better curve alone {best:.4}");
        assert_covers(covered, name);
        assert!(together < 1.02 * best, "{name}: {together} {best}");
    }
}

/// 0.5 % outliers of 30 standard deviations.
#[test]
fn outliers_have_no_weight() {
    let experiment = experiment(ElasticStates::sphere(9.0 / 16.0).unwrap(), 600);
    let fitting = Identification::new(Model::Zener).contact_point(Nuisance::Fitted);
    let (mut plain, mut robust, mut clean) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..seeds() {
        let rng = &mut generator(seed);
        let curve = noisy(&experiment, 0.008, 0.0, rng);
        let mut force = curve.force().to_vec();
        for value in &mut force {
            if rng.next_u32().is_multiple_of(200) {
                *value += 30.0 * 0.008;
            }
        }
        clean.push(fitting.fit(std::slice::from_ref(&curve)).unwrap());
        let curve = [Curve::new(experiment.clone(), force).unwrap()];
        plain.push(fitting.fit(&curve).unwrap());
        robust.push(fitting.clone().robust().fit(&curve).unwrap());
    }
    for (name, truth) in ZENER {
        let [covered, error] = coverage(&robust, name, truth);
        let ([_, plain], [clean_covered, clean]) = (coverage(&plain, name, truth), coverage(&clean, name, truth));
        println!(
            "{name}: covers {covered:.3}, error {error:.4}, least squares {plain:.4}, without outliers {clean:.4} and {clean_covered:.3}"
        );
        assert_covers(covered, name);
        assert!(error < 1.3 * clean && error < plain, "{name}");
    }
}

/// Curves of 1000 samples whose drive scatters by 1 nm, `WORK_SEEDS` of them or fewer: the work of a search, of which 8 million and more are a second of one core.
#[test]
fn searches_take_little_work() {
    const POWER_LAW: Model = Model::PowerLaw { cutoff: 1e-6 };
    let models: [(Model, &[f64], usize); 10] = [
        (Model::Zener, &[4.0e3, 1.0e3, 0.5], 1),
        (POWER_LAW, &[1.0e3, 0.02], 2),
        (POWER_LAW, &[1.0e3, 0.3], 2),
        (POWER_LAW, &[1.0e3, 0.9], 2),
        (Model::FractionalZener, &[4.0e3, 1.0e3, 0.3, 0.02], 9),
        (Model::FractionalZener, &[4.0e3, 1.0e3, 0.3, 0.05], 9),
        (Model::FractionalZener, &[4.0e3, 1.0e3, 0.3, 0.15], 9),
        (Model::FractionalZener, &[4.0e3, 1.0e3, 0.3, 0.3], 9),
        (Model::FractionalZener, &[4.0e3, 1.0e3, 0.3, 0.6], 4),
        (Model::FractionalZener, &[4.0e3, 1.0e3, 0.3, 0.98], 3),
    ];
    let seeds = from_environment("WORK_SEEDS", 2);
    for (model, values, millions) in models {
        let work = |seed: u64| {
            let rng = &mut generator(seed);
            let times: Vec<f64> = (0..1000).map(|k| 2.0 * f64::from(k) / 999.0).collect();
            let drive = times.iter().map(|&t: &f64| 1.2e-6 * t.min(1.0) - 0.2e-6 + 1e-9 * normal(rng)).collect();
            let sphere = ElasticStates::sphere(5e-6).unwrap();
            let experiment = Experiment::new(Protocol::new(times, drive).unwrap(), sphere).with_spring(0.05).unwrap();
            let names = model.parameters();
            let named = named(&names, values);
            let of = Identification::new(model);
            let curve = random::noisy(&of, experiment, &named, |greatest| 0.01 * greatest * normal(rng));
            let fit = of.contact_point(Nuisance::Fitted).fit(&[curve]).unwrap();
            println!("{seed} {model:?} {values:?}: {:.2} million, {}", fit.work() as f64 * 1e-6, fit.iterations());
            fit.work()
        };
        let all: Vec<usize> = (0..seeds).map(work).collect();
        let most = all.iter().copied().max().unwrap_or_default();
        println!("{model:?} {values:?}: {:.2} million at most", most as f64 * 1e-6);
        assert!(most > 50_000 && most < millions * 1_000_000, "{model:?} {values:?}: {all:?}");
    }
}
