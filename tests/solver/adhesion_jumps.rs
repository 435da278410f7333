//! Every step beside a jump ends, however fine its tolerance and however short it is: random scenes are led up to each of their jumps by steps
//! that are halved, and through it by a step of the least length. `ADHESION_JUMPS` (6) chooses the number of scenes, `ADHESION_SEED` (1) others.

use std::sync::Arc;

use super::adhesion_population::{check, law, material};
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use viscocontact::adhesion::AdhesionError;
use viscocontact::contact::Warnings;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

const SIDE: f64 = 4.0;
/// Steps tried on a way down or back, at most.
const MOST_STEPS: usize = 400;

#[test]
fn every_step_beside_a_jump_ends() {
    let (scenes, seed) = (from_environment("ADHESION_JUMPS", 6), from_environment("ADHESION_SEED", 1));
    let (mut steps, mut passes, mut most, mut jumps) = (0, 0, 0, 0);
    for number in 0..scenes {
        let mut draws = Draws::new(1000 * (seed - 1) + number);
        let mu = draws.scale(0.8, 2.2);
        let law = law(&mut draws, 1.0 / mu);
        let sphere = Sphere::new(1.0).unwrap();
        let wavy = Wavy::new(draws.between(0.05, 0.5), SIDE / draws.between(2.0, 4.0)).unwrap();
        let shape: Box<dyn Geometry> =
            if draws.chance(0.5) { Box::new(sphere) } else { Box::new(Sum::new(sphere, wavy)) };
        let (creeping, material) = material(&mut draws, 0.4);
        let cells = (2.0 * (2.0 * SIDE * mu * mu).ceil()).max(16.0) as usize;
        let tolerance = draws.scale(1e-9, 1e-3);
        let (kind, shortest, time) = (draws.below(3), draws.scale(1e-6, 1e-3), draws.scale(0.1, 10.0));
        let name = format!(
            "scene {number}: μ = {mu:.2}, {cells}², tolerance {tolerance:.1e}, steps of {shortest:.1e}, load {kind}, {law:?}"
        );
        let mut contact = ViscoelasticContact::builder(Grid::square(cells, SIDE).unwrap())
            .geometry(&*shape)
            .material(material)
            .attraction(Arc::clone(&law))
            .settings(Settings::default().with_edge(Edge::Allow).with_tolerance(tolerance).with_symmetry(true))
            .build()
            .unwrap();
        let touch = contact.approach();
        let load = |at: f64| match kind {
            0 => Load::approach(touch + at),
            1 => Load::spring(8.0, touch + 1.3 * at),
            _ => Load::force(3.0 * at),
        };
        let ways = if kind == 2 { [(0.0, 0.6), (0.6, -2.5)] } else { [(-1.8, 0.4), (0.4, -2.4)] };
        'scene: for (from, to) in ways {
            contact.step(1e-3, load(from)).unwrap();
            let (mut at, longest) = (from, (to - from) / 20.0);
            let mut length: f64 = longest;
            for _ in 0..MOST_STEPS {
                let before = contact.clone();
                let result = contact.step(time * length / longest, load(at + length));
                let own = contact.passes().unwrap();
                (steps, passes, most) = (steps + 1, passes + own.passes, most.max(own.passes));
                let jumped = match result {
                    Ok(report) => report.warnings.contains(Warnings::JUMP),
                    Err(Error::Adhesion(AdhesionError::PulledOff { .. })) if kind == 2 => true,
                    Err(error) => panic!("{name}, at {at} by {length:.1e}: {error}, {own:?}"),
                };
                if jumped && length.abs() > shortest {
                    (contact, length) = (before, 0.5 * length);
                    continue;
                }
                jumps += usize::from(jumped);
                if result.is_err() {
                    break 'scene;
                }
                assert!(own.rise < 1e-6, "{name}, at {at} by {length:.1e}: {own:?}");
                if tolerance < 1e-5 {
                    check(&format!("{name}, at {at} by {length:.1e}"), &contact, &*law, !creeping);
                }
                (at, length) = (at + length, longest);
                if (to - at) * longest < 0.0 {
                    break;
                }
            }
        }
    }
    println!("{scenes} scenes, {steps} steps, {jumps} jumps; {passes} passes, at most {most} in a step");
    assert!(jumps > 0);
}
