//! The decades that data determine.

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

fn curve(noise: f64) -> Curve {
    let experiment = experiment(&ElasticStates::sphere(9.0 / 16.0).unwrap());
    let rng = &mut generator(5);
    noisy(&Identification::new(Model::Prony(2)), experiment, &TRUTH, |greatest| noise * greatest * normal(rng))
}

/// Relaxation within the times of the data is determined, slower relaxation is not.
#[test]
fn decades_that_the_data_do_not_see_are_named() {
    let fit = Identification::new(Model::Prony(2)).fit(&[curve(0.01)]).unwrap();
    let decades = fit.decades().unwrap();
    for decade in &decades {
        println!("{:?}: {:.3} ± {:.3} {}", decade.times, decade.modulus, decade.deviation, decade.is_determined);
    }
    let at = |time: f64| decades.iter().find(|d| d.times[0] <= time && time < d.times[1]).unwrap();
    assert!(at(0.03).is_determined && at(0.3).is_determined);
    assert!(!at(300.0).is_determined);
    assert!((at(0.03).modulus - 0.45).abs() < 0.05);
}
