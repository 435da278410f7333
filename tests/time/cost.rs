//! How many convolutions steps take.

use crate::common::StepLoadedSphere;

use viscocontact::prelude::*;

/// By the rules of the source paper, whose past convolutions are kept: two in each iteration, and one in each step.
#[test]
fn the_paper_takes_two_convolutions_per_iteration() {
    let scene = StepLoadedSphere::maxwell();
    let mut contact = scene.contact(24, Settings::paper()).unwrap();
    contact.step(0.0, Load::force(0.5)).unwrap();
    for _ in 0..40 {
        let report = contact.step(0.025, Load::force(0.5)).unwrap();
        assert_eq!(report.convolutions, 2 * report.iterations + 1);
    }
}

/// Twice the steps take twice the convolutions by the default rule, once they are so short that shorter ones take no less work.
#[test]
fn convolutions_grow_with_the_steps() {
    let scene = StepLoadedSphere::maxwell();
    let [few, many] = [800, 3200].map(|steps| scene.run(32, steps, Settings::default()).unwrap().1 * steps as f64);
    let exponent = (many / few).log2() / 2.0;
    println!("exponent {exponent}");
    assert!((exponent - 1.0).abs() < 0.05, "{exponent}");
}
