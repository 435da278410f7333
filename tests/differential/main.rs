//! The whole stepper on random scenes, against a dense reference that shares no code with it.

#[path = "../common/noise.rs"]
mod noise;
mod quadratic;
mod reference;
mod scenes;

use reference::Reference;
use scenes::Scene;
use viscocontact::prelude::*;

/// A number from the environment, for longer runs by hand.
fn wanted(variable: &str, usual: usize) -> usize {
    std::env::var(variable).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

/// Steps of one scene.
const STEPS: usize = 8;

#[test]
fn eccentric_loads_may_jump() {
    let (count, first) = (wanted("ECCENTRIC_STEPS", 2000), wanted("ECCENTRIC_SEED", 1));
    let settings = Settings { edge: Edge::Allow, ..Settings::default() };
    let (mut taken, mut refused, mut failed, mut warm, mut work, mut fallback) = (0, 0, 0, 0, 0.0, 0);
    let mut seed = first as u64 * 1_000_000;
    let mut costs = Vec::new();
    while taken < count {
        seed += 1;
        let scene = Scene::eccentric(seed, STEPS);
        let mut contact = scene.contact(settings).unwrap();
        for (step, (dt, loads)) in scene.steps.iter().enumerate() {
            match contact.step_each(*dt, loads) {
                Ok(report) => {
                    taken += 1;
                    let cost = report.convolutions as f64 + 0.25 * report.preconditioner_applications as f64;
                    costs.push(cost);
                    fallback += usize::from(report.fallback_iterations > 0);
                    if step > 0 {
                        warm += 1;
                        work += cost;
                    }
                }
                Err(Error::LoadOutsideHull { .. }) => refused += 1,
                Err(error) => {
                    taken += 1;
                    failed += 1;
                    let mut fresh = scene.contact(settings).unwrap();
                    let fresh =
                        if scene.rheology.is_elastic_at_first() { fresh.step_each(0.0, loads).is_ok() } else { false };
                    println!("{} step {step} dt {dt:.2e}: {error} (elastic fresh {fresh}) {loads:?}", scene.name);
                }
            }
        }
    }
    costs.sort_by(f64::total_cmp);
    let at = |share: f64| costs[((costs.len() - 1) as f64 * share) as usize];
    println!(
        "{taken} steps, {refused} refused, {failed} failed, {fallback} with the fall-back, {:.2} equivalents a warm step; median {} p99 {} p999 {} max {}",
        work / warm as f64,
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
    assert_eq!(failed, 0);
}

/// Sums of differences over sums.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = b.iter().map(|b| b.abs()).sum();
    let difference: f64 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
    if sum > 0.0 { difference / sum } else { difference }
}

#[test]
fn a_dense_reference_agrees() {
    let (count, first) = (wanted("DIFFERENTIAL_SCENES", 500), wanted("DIFFERENTIAL_SEED", 1));
    let (mut steps, mut refused, mut unsolved, mut worst) = (0, 0, 0, [0.0_f64; 3]);
    for seed in (first as u64 * 1_000_000..).take(count) {
        let scene = Scene::any(seed, 6);
        let settings = Settings { edge: Edge::Allow, tolerance: 1e-10, ..Settings::default() };
        let mut contact = scene.contact(settings).unwrap();
        let mut reference = Reference::new(&scene.grid, &scene.shapes, &scene.rheology);
        for (step, (dt, loads)) in scene.steps.iter().enumerate() {
            match contact.step_each(*dt, loads) {
                Ok(_) => {}
                Err(Error::LoadOutsideHull { .. }) => {
                    refused += 1;
                    continue;
                }
                Err(error) => panic!("{} step {step}: {error} {loads:?}", scene.name),
            }
            if !reference.step(*dt, loads) {
                unsolved += 1;
                println!("unsolved {} step {step} {loads:?}", scene.name);
                break; // what follows would start from elsewhere
            }
            steps += 1;
            let mut errors = [distance(contact.pressure(), &reference.pressure), 0.0, 0.0];
            for (body, &motion) in reference.motions.iter().enumerate() {
                let state = contact.body(body).unwrap();
                let force = reference.force(body);
                errors[1] += (state.force - force).abs() / reference.total_force().max(1e-12);
                if motion[0].is_finite() && force > 0.0 {
                    let size = reference.deepest();
                    errors[2] += (state.approach - motion[0]).abs() / size;
                    errors[2] += 1e-3 * (state.tilt[0] - motion[1]).abs().max((state.tilt[1] - motion[2]).abs()) / size;
                }
            }
            if errors.iter().any(|e| *e > 1e-6) {
                println!("{} step {step}: {errors:?} {dt:.2e} {loads:?} {:?}", scene.name, scene.rheology);
            }
            (0..3).for_each(|k| worst[k] = worst[k].max(errors[k]));
        }
    }
    println!(
        "{steps} steps agree to {worst:?} in pressure, force, motion; {refused} refused, {unsolved} unsolved by the reference"
    );
    assert!(worst.iter().all(|worst| *worst < 1e-5), "{worst:?}");
    assert!(unsolved * 100 < steps);
}
