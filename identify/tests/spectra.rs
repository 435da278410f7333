//! Spectra without a model.

use std::sync::Arc;

use viscocontact::prelude::*;
use viscocontact_identify::{Curve, Experiment, Identification, Model, Protocol};

use crate::random::{generator, noisy, normal};

const TRUTH: [(&str, f64); 5] = [("Einf", 0.25), ("E1", 0.45), ("tau1", 0.03), ("E2", 0.3), ("tau2", 1.0)];

/// In 0.3 s to a depth of 1, held for 4 s, and out.
fn experiment(tip: &Arc<ElasticStates>) -> Experiment {
    let times: Vec<f64> = (0..1500).map(|k| 5.0 * f64::from(k) / 1499.0).collect();
    let drive = times.iter().map(|&t: &f64| (t / 0.3).min(1.0).min((5.0 - t) / 0.7)).collect();
    Experiment::new(Protocol::new(times, drive).unwrap(), Arc::clone(tip))
}

fn curve(noise: f64, stiffness: f64) -> Curve {
    let mut experiment = experiment(&ElasticStates::sphere(9.0 / 16.0).unwrap());
    if stiffness.is_finite() {
        experiment = experiment.with_spring(stiffness).unwrap();
    }
    let rng = &mut generator(5);
    noisy(&Identification::new(Model::Prony(2)), experiment, &TRUTH, |greatest| noise * greatest * normal(rng))
}

/// The modulus over the times of the data, from a fit that has one relaxation time where there are two.
#[test]
fn a_spectrum_needs_no_model() {
    for (noise, stiffness, tolerance) in [(0.0, f64::INFINITY, 6e-3), (0.01, f64::INFINITY, 0.04), (0.01, 2.0, 0.05)] {
        let fit = Identification::new(Model::Zener).fit(&[curve(noise, stiffness)]).unwrap();
        let spectrum = fit.free_spectrum().unwrap();
        // under noise, the decade up to 0.01 is not determined: the ramp takes 0.3
        let first = if noise > 0.0 { 0.03 } else { 0.01 };
        for t in [first, 0.05, 0.1, 0.3, 1.0, 3.0] {
            let truth = Model::Prony(2).modulus(&TRUTH.map(|(_, value)| value), t).unwrap();
            let error = (spectrum.modulus(t) / truth - 1.0).abs();
            assert!(error < tolerance, "noise {noise}, t = {t}: off by {error:.4} after {} rounds", spectrum.rounds);
        }
        let greatest = spectrum.forces[0].iter().fold(0.0, |most: f64, force| most.max(*force));
        let sigma = spectrum.sigma / greatest;
        assert!(if noise > 0.0 { (sigma / noise - 1.0).abs() < 0.06 } else { sigma < 1e-3 }, "{sigma}");
    }
}

/// Relaxation within the times of the data is determined, slower relaxation is not.
#[test]
fn decades_that_the_data_do_not_see_are_named() {
    let fit = Identification::new(Model::Prony(2)).fit(&[curve(0.01, f64::INFINITY)]).unwrap();
    let decades = fit.decades().unwrap();
    for decade in &decades {
        println!("{:?}: {:.3} ± {:.3} {}", decade.times, decade.modulus, decade.deviation, decade.is_determined);
    }
    let at = |time: f64| decades.iter().find(|d| d.times[0] <= time && time < d.times[1]).unwrap();
    assert!(at(0.03).is_determined && at(0.3).is_determined);
    assert!(!at(300.0).is_determined);
    assert!((at(0.03).modulus - 0.45).abs() < 0.05);
}
