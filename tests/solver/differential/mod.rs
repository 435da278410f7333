//! The whole stepper on random scenes, against a dense reference that shares no code with it.

mod elastic;
mod hereditary_integral;
mod reference;
pub(super) mod scenes;

use super::conditions::{assert_contact_conditions, moved};
use crate::common::{Ratios, from_environment};
use reference::Reference;
use scenes::Scene;
use viscocontact::fields::Fields;
use viscocontact::prelude::*;

/// Steps of one scene.
const STEPS: usize = 8;

/// Loads of every kind jump from place to place, on meshes finer than the dense reference could follow: each is carried, by few
/// convolutions. `JUMPING_STEPS` and `JUMPING_SEED` choose how many steps, and which.
#[test]
fn loads_of_every_kind_may_jump() {
    let (count, first) = (from_environment("JUMPING_STEPS", 1000), from_environment("JUMPING_SEED", 1));
    let settings = Settings::default().with_edge(Edge::Allow);
    let (mut taken, mut refused, mut failed, mut warm, mut work, mut fallback) = (0, 0, 0, 0, 0.0, 0);
    let mut seed = first * 1_000_000;
    let mut costs = Ratios::default();
    while taken < count {
        seed += 1;
        let scene = Scene::any(seed, STEPS, true);
        let Ok(mut contact) = scene.contact(settings) else { continue };
        for (step, (dt, loads)) in scene.steps.iter().enumerate() {
            match contact.step(*dt, loads) {
                Ok(report) => {
                    taken += 1;
                    assert!(contact.pressure().iter().all(|&p| p >= 0.0), "{} step {step}", scene.name);
                    for (body, load) in loads.iter().enumerate() {
                        let Load::Force { normal, .. } = load else { continue };
                        let force = contact.fields().body(body).unwrap().force;
                        assert!((force - normal).abs() <= 1e-9 * normal, "{} step {step}: {force} {load}", scene.name);
                    }
                    let cost = report.convolution_equivalents();
                    costs.push(cost, &scene.name);
                    fallback += usize::from(report.fallback_iterations > 0);
                    if step > 0 {
                        warm += 1;
                        work += cost;
                    }
                }
                Err(Error::Step(StepError::LoadOutsideHull { .. })) => refused += 1,
                Err(error) => {
                    taken += 1;
                    failed += 1;
                    println!("{} step {step} dt {dt:.2e}: {error} {loads:?}", scene.name);
                }
            }
        }
    }
    let mean = work / warm as f64;
    println!("{taken} steps, {refused} refused, {failed} failed, {fallback} with the fall-back, seed {first}");
    println!("{mean:.2} equivalents a warm step");
    costs.print("equivalents", 3);
    assert_eq!(failed, 0);
    assert!(mean < 15.0, "{mean}");
}

/// Every step under one body satisfies the conditions of contact, which have one solution. `CONDITIONS_SCENES` (160) chooses how many seeds
/// are looked at, and `CONDITIONS_SEED` (1) which.
#[test]
fn steps_satisfy_the_conditions_of_contact() {
    const TOLERANCE: f64 = 1e-9;
    let (scenes, first) = (from_environment("CONDITIONS_SCENES", 160), from_environment("CONDITIONS_SEED", 1));
    let (mut steps, mut open, mut fallback) = (0, 0, 0);
    for seed in (first * 3_000_000..).take(scenes as usize) {
        let scene = Scene::any(seed, STEPS, true);
        if scene.shapes.len() > 1 {
            continue;
        }
        let settings = Settings::default().with_tolerance(TOLERANCE).with_edge(Edge::Allow).with_max_iterations(5000);
        let Ok(mut ours) = scene.contact(settings) else { continue };
        let mut far = 0.0_f64;
        for (step, (dt, loads)) in scene.steps.iter().enumerate() {
            let name = format!("{} step {step}, {loads:?}", scene.name);
            match ours.step(*dt, loads) {
                Ok(report) => fallback += usize::from(report.fallback_iterations > 0),
                // the load acts on the rim of the face
                Err(Error::Step(StepError::LoadOutsideHull { .. })) => continue,
                Err(error) => panic!("{name}: {error}"),
            }
            steps += 1;
            open += usize::from(ours.contact_cells() < ours.grid().len());
            // the greatest lengths so far: after a release, rounding of them remains
            far = far.max(moved(&ours, loads.len()));
            assert_contact_conditions(&ours, loads, TOLERANCE, far, &name);
        }
    }
    println!("{steps} steps, {open} of them with cells out of contact, {fallback} with the fall-back");
    assert!(steps as u64 > 3 * scenes && open > 0 && 100 * fallback <= steps, "{steps} {open} {fallback}");
}

/// Advice that is followed helps: a step that ran out of iterations is done with more of them.
#[test]
fn more_iterations_help_where_the_error_advises_them() {
    let (mut short, mut solved) = (0, 0);
    for seed in 1..from_environment("ADVICE_SCENES", 60) {
        let scene = Scene::any(seed, STEPS, true);
        let settings = Settings::default().with_edge(Edge::Allow);
        let [hasty, patient] = [settings.with_max_iterations(6), settings].map(|settings| scene.contact(settings));
        let (Ok(mut hasty), Ok(mut patient)) = (hasty, patient) else { continue };
        for (dt, loads) in &scene.steps {
            if let Err(error) = hasty.step(*dt, loads)
                && let Error::Step(StepError::NotConverged { iterations, stagnated, .. }) = &error
            {
                short += 1;
                assert!(!stagnated && *iterations == 6, "{}: {error}", scene.name);
                assert_eq!(
                    error.remedy().as_deref(),
                    Some("raise Settings::max_iterations"),
                    "{}: {error}",
                    scene.name
                );
            }
            solved += usize::from(patient.step(*dt, loads).is_ok());
            if hasty.time() != patient.time() {
                break; // the histories part
            }
        }
    }
    assert!(short > 20 && solved > short, "{short} {solved}");
}

/// Sums of differences over sums.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = b.iter().map(|b| b.abs()).sum();
    let difference: f64 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
    if sum > 0.0 { difference / sum } else { difference }
}

/// Pressure, forces and motions of a contact beside those of the reference, over their sizes.
fn errors(contact: Fields<'_>, reference: &Reference) -> [f64; 3] {
    let mut errors = [distance(contact.pressure(), &reference.pressure), 0.0, 0.0];
    for (body, &motion) in reference.motions.iter().enumerate() {
        let (state, force) = (contact.body(body).unwrap(), reference.force(body));
        errors[1] += (state.force - force).abs() / reference.total_force().max(1e-12);
        if motion[0].is_finite() && force > 0.0 {
            let size = reference.deepest();
            errors[2] += (state.approach - motion[0]).abs() / size;
            errors[2] += 1e-3 * (state.tilt[0] - motion[1]).abs().max((state.tilt[1] - motion[2]).abs()) / size;
        }
    }
    errors
}

#[test]
fn a_dense_reference_agrees() {
    agrees_with_a_dense_reference(TimeRule::Exponential);
}

#[test]
fn a_dense_reference_of_the_linear_rule_agrees() {
    agrees_with_a_dense_reference(TimeRule::ExponentialLinear);
}

fn agrees_with_a_dense_reference(time_rule: TimeRule) {
    let (count, first) =
        (from_environment("DIFFERENTIAL_SCENES", 300) as usize, from_environment("DIFFERENTIAL_SEED", 1));
    let (mut steps, mut refused, mut unsolved, mut worst) = (0, 0, 0, [0.0_f64; 3]);
    for seed in (first * 1_000_000..).take(count) {
        let scene = Scene::any(seed, 6, false);
        let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(1e-10).with_time_rule(time_rule);
        let mut contact = match scene.contact(settings) {
            Err(Error::NothingToTouch { .. }) => continue, // no cell's centre lies under a body
            contact => contact.unwrap(),
        };
        let mut reference = Reference::new(&scene.grid, &scene.shapes, &scene.rheology, time_rule);
        for (step, (dt, loads)) in scene.steps.iter().enumerate() {
            match contact.step(*dt, loads) {
                Ok(_) => {}
                Err(Error::Step(StepError::LoadOutsideHull { .. })) => {
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
            let errors = errors(contact.fields(), &reference);
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
