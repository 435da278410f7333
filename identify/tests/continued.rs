//! Bands beyond the times of a curve, over random curves of each law. `CONTINUED` (4) chooses their number of each.

use viscocontact::states::ElasticStates;
use viscocontact_identify::{Decade, Experiment, Fit, Identification, Model, Nuisance, Protocol};

use crate::random::{from_environment, generator, logarithmic, named, noisy, normal, uniform};

/// Decades beyond the curve.
const BEYOND: [i32; 3] = [1, 2, 4];
/// Deviations of an interval of 95 %.
const WITHIN_95: f64 = 1.96;

/// A random body of a law, whose times are within the length of a curve, or somewhat beyond.
fn body(law: &str, length: f64, rng: &mut rand_chacha::ChaCha8Rng) -> (Model, Vec<f64>) {
    let modulus = logarithmic(rng, [1e2, 1e7]);
    let (tau, exponent) = (logarithmic(rng, [0.03, 3.0]) * length, uniform(rng, [0.1, 0.8]));
    let staying = uniform(rng, [0.02, 0.6]);
    let cutoff = 1e-5 * length;
    let at_length = modulus * length.powf(exponent);
    match law {
        "Maxwell" => (Model::Maxwell, vec![modulus, tau]),
        "Zener" => (Model::Zener, vec![modulus, staying * modulus, tau]),
        "Prony" => {
            let first = 0.1 * tau.min(length);
            (Model::Prony(2), vec![staying * modulus, 0.7 * modulus, first, modulus, tau])
        }
        "power" => (Model::PowerLaw { cutoff }, vec![at_length, exponent]),
        "power solid" => (Model::PowerLawSolid { cutoff }, vec![at_length, exponent, staying * modulus]),
        "stretched" => (Model::Stretched, vec![modulus, staying * modulus, tau, exponent]),
        _ => (Model::FractionalZener, vec![modulus, staying * modulus, tau, exponent]),
    }
}

/// A fit of a random curve of a law, its parameters, and the length of the curve.
fn fitted(law: &str, seed: u64) -> (Fit, Vec<f64>, f64) {
    let rng = &mut generator(seed);
    let length = logarithmic(rng, [1e-2, 1e3]);
    let ramp = uniform(rng, [0.02, 0.3]) * length;
    let count = logarithmic(rng, [150.0, 600.0]).round();
    let protocol =
        Protocol::ramp_hold_retract(1.0e-6 / ramp, [0.2e-6, 0.8e-6], length - 2.0 * ramp, length / count).unwrap();
    let experiment = Experiment::new(protocol, ElasticStates::sphere(5.0e-6).unwrap());
    let (model, values) = body(law, length, rng);
    let noise = logarithmic(rng, [1e-3, 3e-2]);
    let names = model.parameters();
    let named = named(&names, &values);
    let curve = noisy(&Identification::new(model), experiment, &named, |greatest| noise * greatest * normal(rng));
    (Identification::new(model).contact_point(Nuisance::Fitted).fit(&[curve]).unwrap(), values, length)
}

#[test]
fn bands_beyond_a_curve_hold_the_law_or_say_that_it_is_not_known() {
    let count = from_environment("CONTINUED", 4);
    for law in ["Maxwell", "Zener", "Prony", "power", "power solid", "stretched", "fractional"] {
        if std::env::var("LAW").is_ok_and(|only| only != law) {
            continue;
        }
        let (mut missed, mut unknown, mut determined) = (BEYOND.map(|_| Vec::new()), BEYOND.map(|_| 0), Vec::new());
        for seed in 0..count {
            let (fit, values, length) = fitted(law, seed);
            for (k, decades) in BEYOND.into_iter().enumerate() {
                let t = 10f64.powi(decades) * length;
                let truth = fit.model().modulus(&values, t).unwrap();
                let [found, deviation] = fit.modulus_band(t);
                let distance = (found / truth).ln() / deviation;
                unknown[k] += u64::from(deviation.is_infinite());
                if deviation.is_finite() && (distance.is_nan() || distance.abs() > WITHIN_95) {
                    missed[k].push((seed, distance));
                }
            }
            let far = |decade: &Decade| decade.times[0] > 10.0 * length && decade.is_determined;
            determined.extend(fit.decades().unwrap().into_iter().filter(far).map(|decade| (seed, decade)));
        }
        println!("{law}, of {count}: missed {missed:?}, not known {unknown:?}, determined {determined:?}");
        assert!(missed.iter().all(|missed| 10 * missed.len() as u64 <= count + 10), "{law}: {missed:?}");
        assert!(law == "Maxwell" || 2 * unknown[0] <= count + 2, "{law}: {unknown:?}");
        assert!(determined.is_empty(), "{law}: {determined:?}");
    }
}
