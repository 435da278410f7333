//! Elastic contacts of random scenes: against the dense reference, against a stepper on an elastic body, and cold beside warm.

use super::reference::Reference;
use super::scenes::{Body, Scene};
use super::{distance, errors};
use crate::common::any_scene::shape_on_body;
use crate::common::fields::gap;
use crate::common::{Draws, Ratios, from_environment};
use viscocontact::prelude::*;

/// The elastic contact of a scene, of compliance 1/`modulus`.
fn elastic(scene: &Scene, modulus: f64, settings: Settings) -> ElasticContact {
    let builder = ElasticContact::builder(scene.grid.clone()).modulus(modulus).settings(settings);
    scene.shapes.iter().fold(builder, |builder, shape| builder.another_body(shape)).build().unwrap()
}

/// The load of a spring whose far end is where it carries the force of a body that rests so.
fn spring(load: &Load, state: &BodyState, stiffness: f64) -> Load {
    let tilt = load.tilt();
    let at = tilt.map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 });
    let approach = state.approach + state.tilt[0] * at[0] + state.tilt[1] * at[1];
    Load::Spring { stiffness, drive: approach + state.force / stiffness, tilt }
}

/// Each load of a random scene leads to the pressure, forces and motions of the dense reference: after the load before, and from
/// nothing; on a surface that something has displaced in a third of the scenes; and on springs that carry the same forces.
/// `ELASTIC_SCENES` and `ELASTIC_SEED` choose scenes.
#[test]
fn elastic_contacts_agree_with_a_dense_reference() {
    let (count, first) = (from_environment("ELASTIC_SCENES", 200), from_environment("ELASTIC_SEED", 1));
    let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(1e-10);
    let (mut compared, mut refused, mut unsolved, mut sprung) = (0, 0, 0, 0);
    let (mut worst, mut cost) = (Ratios::default(), [(); 2].map(|()| Ratios::default()));
    for seed in (first * 5_000_000..).take(count as usize) {
        let scene = Scene::any(seed, 6, false);
        if scene.contact(settings).is_err() {
            continue; // no cell's centre lies under a body
        }
        let draws = &mut Draws::new(seed);
        let modulus = draws.scale(1e5, 1e7);
        let body = Body { glassy: 4.0 / modulus, fluidity: 0.0, terms: Vec::new() };
        let mut warm = elastic(&scene, modulus, settings);
        let surface = (seed % 3 == 0).then(|| {
            let [a, b] = [draws.between(0.0, 1e-5), draws.between(-2e3, 2e3)];
            let centre = |k: usize| scene.grid.center(k / scene.grid.cells()[1], k % scene.grid.cells()[1]);
            (0..scene.grid.len()).map(|k| a * (1.0 + (b * centre(k)[0]).sin())).collect::<Vec<f64>>()
        });
        surface.iter().for_each(|u| warm.set_surface(u).unwrap());
        for (step, (_, loads)) in scene.steps.iter().enumerate() {
            let before = warm.fields().pressure().to_vec();
            let report = match warm.solve(loads) {
                Ok(report) => report,
                Err(Error::Step(StepError::LoadOutsideHull { .. })) => {
                    assert_eq!(warm.fields().pressure(), before, "a failure changes nothing");
                    refused += 1;
                    continue;
                }
                Err(error) => panic!("{} step {step}: {error} {loads:?}", scene.name),
            };
            let mut reference = Reference::new(&scene.grid, &scene.shapes, &body, TimeRule::Exponential);
            surface.iter().for_each(|u| reference.displace(u));
            if !reference.step(0.0, loads) {
                unsolved += 1;
                continue;
            }
            let mut cold = elastic(&scene, modulus, settings);
            surface.iter().for_each(|u| cold.set_surface(u).unwrap());
            let afresh = cold.solve(loads).unwrap();
            let own = [&warm, &cold].map(|contact| errors(contact.fields(), &reference));
            let off = own.iter().flatten().copied().fold(0.0, f64::max);
            worst.push(off, &format!("{} step {step}: {own:?} {loads:?}", scene.name));
            cost[0].push(report.convolution_equivalents(), "");
            cost[1].push(afresh.convolution_equivalents(), "");
            compared += 1;
            // one body on a spring that carries what it carries now
            let state = warm.fields().body(0).unwrap();
            if let ([load @ Load::Force { .. }], true) = (&loads[..], state.force > 0.0) {
                let stiffness = state.force / (state.approach.abs() + 1e-6) * draws.scale(0.1, 10.0);
                cold.solve(spring(load, &state, stiffness)).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
                let off = distance(cold.fields().pressure(), warm.fields().pressure());
                assert!(off < 1e-6, "{} step {step}: {off:e} on a spring", scene.name);
                sprung += 1;
            }
        }
    }
    println!("{compared} solutions, {refused} refused, {unsolved} without a reference, {sprung} on springs");
    worst.print("error", 3);
    println!("convolutions warm and cold: {:.1?}", cost.map(|cost| cost.median()));
    assert!(compared as u64 > 2 * count && unsolved < 10 && sprung > 20, "{compared} {unsolved} {sprung}");
    assert!(worst.greatest() < 1e-6, "{:e}", worst.greatest());
}

/// On every kind of body an elastic contact is that of a stepper whose material does not creep, load by load.
#[test]
fn elastic_contacts_are_jumps_of_an_elastic_body() {
    let count = from_environment("ELASTIC_BODIES", 60);
    let (mut compared, mut kinds) = (0, std::collections::BTreeSet::new());
    for seed in 1..=count {
        let draws = &mut Draws::new(77_000 + seed);
        let (grid, kernel, poisson, shape) = shape_on_body(draws, seed % 12);
        let (modulus, kernel) = (draws.scale(1e5, 1e7), std::sync::Arc::new(kernel));
        let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(1e-9);
        let body = Material::constant_poisson(Elastic::new(0.5 * (1.0 - poisson) * modulus).unwrap(), poisson).unwrap();
        let builder =
            ViscoelasticContact::builder(grid.clone()).material(body).settings(settings).kernel(kernel.clone());
        let mut stepper = builder.geometry(&*shape).build().unwrap();
        let builder = ElasticContact::builder(grid.clone()).geometry(&*shape).settings(settings).kernel(kernel.clone());
        let mut contact = builder.modulus(modulus).build().unwrap();
        for _ in 0..4 {
            let load = Load::force(draws.scale(1e-3, 1.0));
            let (found, step) = (contact.solve(load), stepper.step(0.0, load));
            let (Ok(found), Ok(step)) = (&found, &step) else {
                assert!(found.is_err() && step.is_err(), "{kernel}: {found:?} {step:?}");
                continue;
            };
            let name = format!("{seed} on {kernel}: {found} | {step}");
            let off = distance(contact.fields().pressure(), stepper.pressure());
            assert!(off < 1e-7 && found.warnings == step.warnings, "{off:e} {name}");
            assert!((found.approach - step.approach).abs() <= 1e-7 * step.approach.abs(), "{name}");
            assert!(found.convolutions <= step.convolutions + 2, "{name}");
            let [own, other] = [contact.fields(), stepper.fields()].map(|fields| {
                let mut gap = gap(fields);
                gap.retain(|h| h.is_finite());
                gap
            });
            let apart = own.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-6 * step.approach.abs(), "{apart:e} {name}");
            compared += 1;
        }
        kinds.insert(kernel.to_string().split(' ').take(3).collect::<String>());
    }
    println!("{compared} solutions on {kinds:?}");
    assert!(compared as u64 > 2 * count && kinds.len() >= 5, "{compared} {kinds:?}");
}
