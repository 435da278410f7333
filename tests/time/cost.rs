//! How many convolutions steps take.

use crate::common::StepLoadedSphere;

use viscocontact::prelude::*;

/// Twice the steps take twice the convolutions by the default rule, once they are so short that shorter ones take no less work.
#[test]
fn convolutions_grow_with_the_steps() {
    let scene = StepLoadedSphere::maxwell();
    let [few, many] = [800, 3200].map(|steps| scene.run(32, steps, Settings::default()).unwrap().1 * steps as f64);
    let exponent = (many / few).log2() / 2.0;
    println!("exponent {exponent}");
    assert!((exponent - 1.0).abs() < 0.05, "{exponent}");
}
