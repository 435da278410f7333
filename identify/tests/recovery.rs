//! Parameters are found again.

use viscocontact_identify::{Curve, Nuisance};

use crate::scenes::scene;

/// Number of random scenes: `RECOVERY_SCENES`, or fewer.
fn scenes() -> u64 {
    std::env::var("RECOVERY_SCENES").ok().and_then(|text| text.parse().ok()).unwrap_or(40)
}

/// Without noise, each parameter that 1 % of noise would leave known within 30 % is found to 1e-6.
#[test]
fn parameters_are_found_without_noise() {
    let (mut identifiable, mut wrong) = (0, Vec::new());
    for seed in 0..scenes() {
        let scene = scene(seed);
        let known = scene.identification.clone().contact_point(Nuisance::Fixed(scene.contact_point));
        let samples = match known.respond(&scene.experiment, &scene.named()) {
            Ok(samples) => samples,
            Err(error) => panic!("scene {seed}: {error}"),
        };
        let force: Vec<f64> = samples.iter().map(|sample| sample.force).collect();
        let greatest = force.iter().copied().fold(0.0, f64::max);
        let mut expected = scene.named();
        expected.push(("contact point", scene.contact_point));
        let bounds = scene.identification.bounds(std::slice::from_ref(&scene.experiment), &expected, 0.01 * greatest);
        let limits = |name: &str| match name {
            "contact point" => scene.depth,
            _ => 1.0,
        };
        let is_known = |name: &str| {
            bounds.as_ref().is_ok_and(|bounds| bounds.deviation(name).is_some_and(|d| d < 0.3 * limits(name)))
        };
        let names: Vec<&str> = expected.iter().map(|(name, _)| *name).collect();
        let is_free = |name: &str| bounds.as_ref().is_ok_and(|bounds| bounds.deviation(name).is_some());
        if !names.iter().all(|name| is_known(name) || !is_free(name)) || bounds.is_err() {
            continue;
        }
        identifiable += 1;
        let fit = match scene.identification.fit(&[Curve::new(scene.experiment.clone(), force).unwrap()]) {
            Ok(fit) => fit,
            Err(error) => {
                wrong.push(format!("scene {seed}, {:?}: {error}", scene.identification.model()));
                continue;
            }
        };
        for (name, truth) in &expected {
            let Some(estimate) = fit.estimate(name) else { continue };
            let error = (estimate.value - truth).abs() / if *name == "contact point" { scene.depth } else { *truth };
            if error > 1e-6 {
                wrong.push(format!("scene {seed}, {:?}: {name} off by {error:e}", scene.identification.model()));
            }
        }
    }
    println!("{identifiable} of {} scenes are identifiable", scenes());
    assert!(wrong.is_empty(), "{} of {identifiable}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(identifiable as u64 > scenes() / 2);
}
