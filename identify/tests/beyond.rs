//! Beyond the times of its curve a fit has the law of its model, and says how little the curve knows there. `BEYOND` (12) chooses the number of random curves.

use viscocontact::Error as ContactError;
use viscocontact::contact::Warnings;
use viscocontact::load::Load;
use viscocontact::states::{ElasticStates, StatesContact};
use viscocontact_identify::{Error, Experiment, Fit, Identification, Model, Nuisance, Protocol};

use crate::random::{from_environment, generator, logarithmic, noisy, normal, uniform};

/// E(t) of a law with powers of time, from its formula.
fn law(model: Model, of: &[f64], t: f64) -> f64 {
    match model {
        Model::PowerLaw { cutoff } => of[0] * (t + cutoff).powf(-of[1]),
        Model::PowerLawSolid { cutoff } => of[2] + of[0] * (t + cutoff).powf(-of[1]),
        Model::Stretched => of[1] + (of[0] - of[1]) * (-(t / of[2]).powf(of[3])).exp(),
        _ => of[1] + (of[0] - of[1]) * (-t / of[2]).exp(),
    }
}

/// A fit of a noisy curve of a second or so, with the length of the curve.
fn fit(truth: Model, model: Model, values: &[(&str, f64)], length: f64, seed: u64) -> Fit {
    let ramp = 0.1 * length;
    let protocol =
        Protocol::ramp_hold_retract(1.0e-6 / ramp, [0.2e-6, 0.8e-6], length - 2.0 * ramp, length / 500.0).unwrap();
    let experiment = Experiment::new(protocol, ElasticStates::sphere(5.0e-6).unwrap());
    let rng = &mut generator(seed);
    let curve = noisy(&Identification::new(truth), experiment, values, |greatest| 1e-3 * greatest * normal(rng));
    Identification::new(model).contact_point(Nuisance::Fitted).fit(&[curve]).unwrap()
}

#[test]
fn the_modulus_of_a_fit_is_that_of_its_law_at_all_times() {
    let count = from_environment("BEYOND", 12);
    for seed in 0..count {
        let rng = &mut generator(seed);
        let length = logarithmic(rng, [1e-2, 1e2]);
        let cutoff = 1e-5 * length;
        let (modulus, tau, exponent) =
            (logarithmic(rng, [1e3, 1e6]), uniform(rng, [0.05, 0.5]) * length, uniform(rng, [0.15, 0.6]));
        let (model, values) = match seed % 4 {
            0 => (Model::PowerLaw { cutoff }, vec![("E1", modulus), ("alpha", exponent)]),
            1 => (
                Model::PowerLawSolid { cutoff },
                vec![("E1", modulus), ("alpha", exponent), ("Einf", 0.3 * modulus * length.powf(-exponent))],
            ),
            2 => (Model::Stretched, vec![("E0", modulus), ("Einf", 0.2 * modulus), ("tau", tau), ("beta", exponent)]),
            _ => (Model::Zener, vec![("E0", modulus), ("Einf", 0.2 * modulus), ("tau", tau)]),
        };
        let fit = fit(model, model, &values, length, seed);
        let found: Vec<f64> =
            fit.estimates().iter().filter(|own| own.name != "contact point").map(|own| own.value).collect();
        let times = fit.curves()[0].experiment().protocol().times();
        let (shortest, longest) = (times[1] - times[0], times[times.len() - 1]);
        for exponent in -8..=10 {
            let t = 10f64.powf(0.5 * f64::from(exponent)) * length;
            let (own, expected) = (fit.modulus(t), law(model, &found, t));
            assert!((own / expected - 1.0).abs() < 1e-5, "seed {seed}, {model}: {own} for {expected} at {t} s");
            let [value, deviation] = fit.modulus_band(t);
            assert!(value == own && deviation > 0.0, "seed {seed}: {value} ± {deviation}");
            let shear = fit.shear_modulus(t, 0.5).unwrap();
            assert!((shear / (0.25 * expected) - 1.0).abs() < 1e-5);
        }
        for t in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(fit.modulus(t).is_nan());
            assert!(matches!(
                fit.shear_modulus(t, 0.5),
                Err(Error::Contact(ContactError::OutOfRange { field: "time", .. }))
            ));
        }
        // a contact on its material warns where the curve has nothing to say
        let material = fit.material().unwrap();
        let [first, last] = material.measured();
        assert!((first / shortest - 1.0).abs() < 1e-6 && (last / longest - 1.0).abs() < 1e-9, "{first} {last}");
        let tip = ElasticStates::sphere(5.0e-6).unwrap();
        let mut contact = StatesContact::new(&tip, &material).unwrap();
        let inside = contact.step(0.5 * length, Load::approach(0.5e-6)).unwrap();
        let beyond = contact.step(1.0e3 * length, Load::approach(0.5e-6)).unwrap();
        assert!(!inside.warnings.contains(Warnings::EXTRAPOLATED) && beyond.warnings.contains(Warnings::EXTRAPOLATED));
    }
}

/// A fractional solid runs away on the curve of a power law: E0 and its time are anything. That makes no decade determined that the curve has not seen.
#[test]
fn what_a_curve_has_not_seen_is_not_determined() {
    let truth = Model::PowerLaw { cutoff: 1e-6 };
    for model in [truth, Model::FractionalZener] {
        let fit = fit(truth, model, &[("E1", 2.0e3), ("alpha", 0.2)], 2.0, 0);
        let decades = fit.decades().unwrap();
        let far: Vec<_> = decades.iter().filter(|decade| decade.times[0] >= 10.0).collect();
        assert!(far.len() >= 2 && far.iter().all(|decade| !decade.is_determined), "{model}: {decades:?}");
        assert!(decades.iter().any(|decade| decade.is_determined), "{model}: {decades:?}");
    }
}
