//! Is what a step accepts beside a fold a state? Random scenes are led up to their jumps by steps that are halved, and each of their states is taken up, by
//! a checkpoint, by a contact of tolerance 1e-9, in a step under the same load. `ADHESION_FOLDS` (8) chooses the number of scenes, `ADHESION_SEED` (1) others.

use std::path::Path;

use super::adhesion_population::{Drawn, SIDE, Scene, rough};
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::fields::traction;
use crate::common::temporary::Temporary;
use viscocontact::contact::{StepError, Warnings};
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

/// Halvings of the step before a jump.
const HALVINGS: u32 = 8;

struct Pair {
    name: String,
    /// To the default tolerance, and to 1e-9.
    contacts: [ViscoelasticContact; 2],
    greatest: f64,
}

impl Pair {
    fn draw(number: u64, seed: u64) -> Pair {
        let mut draws = Draws::new(9000 * seed + number);
        let scene = Scene::draw(
            &mut draws,
            &Drawn {
                side: SIDE,
                tabor: [0.7, 1.5],
                heights: [0.1, 0.6],
                waves: [2.0, 4.0],
                creeping: 0.0,
                periodic: 0.6,
            },
        );
        // with symmetry, which an unstable state may keep, and without
        let symmetric = draws.chance(0.5);
        let wavy = Wavy::new(draws.between(0.1, 0.6), SIDE / draws.between(2.0, 4.0).round()).unwrap();
        let rough = rough(&mut draws, SIDE, 3, [0.05, 0.4]);
        let sphere = Sphere::new(1.0).unwrap();
        let shape: Box<dyn Geometry> = match (symmetric, scene.periodic) {
            (true, true) if draws.chance(0.5) => Box::new(wavy),
            (true, _) => Box::new(Sum::new(sphere, wavy)),
            (false, true) => Box::new(rough),
            (false, false) => Box::new(Sum::new(sphere, rough)),
        };
        let scene = Scene { shape, ..scene };
        let contacts = [Settings::default().tolerance(), 1e-9]
            .map(|tolerance| scene.build(Settings::default().with_symmetry(false).with_tolerance(tolerance)));
        let name = format!("scene {number}: {}, symmetric {symmetric}", scene.name);
        Pair { name, contacts, greatest: scene.law.traction(0.0) }
    }

    /// How far the state moves at the fine tolerance: the greatest change of the tractions, over the greatest traction of the law.
    fn moves(&mut self, checkpoint: &Path) -> f64 {
        let [rough, fine] = &mut self.contacts;
        rough.save(checkpoint).unwrap();
        fine.resume(checkpoint).unwrap();
        fine.step(0.0, rough.fields().load()).unwrap();
        let [rough, fine] = [rough, fine].map(|contact| traction(contact.fields()));
        rough.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / self.greatest
    }
}

#[test]
fn states_beside_folds_are_states() {
    let (scenes, seed) = (from_environment("ADHESION_FOLDS", 8), from_environment("ADHESION_SEED", 1));
    let first = from_environment("ADHESION_FIRST", 0);
    let checkpoint = Temporary::file("folds");
    let (mut beside, mut steps, mut jumps, mut missed, mut worst) = (0, 0, 0, 0, 0.0_f64);
    for number in first..first + scenes {
        let mut pair = Pair::draw(number, seed);
        let touch = pair.contacts[0].approach();
        let mut at = touch - 1.0;
        for to in [touch + 0.6, touch - 3.0] {
            let longest = (to - at) / 16.0;
            let (mut length, mut halvings) = (longest, 0);
            while (to - at) * longest > 0.0 {
                let before = pair.contacts[0].clone();
                let jumped = match pair.contacts[0].step(1.0, Load::approach(at + length)) {
                    Ok(report) => report.warnings.contains(Warnings::JUMP),
                    Err(Error::Step(StepError::BeyondFullContact { .. })) => {
                        pair.contacts[0] = before;
                        break;
                    }
                    Err(error) => panic!("{}: {error:?}", pair.name),
                };
                if jumped && halvings < HALVINGS {
                    (pair.contacts[0], length, halvings) = (before, 0.5 * length, halvings + 1);
                    continue;
                }
                let off = pair.moves(&checkpoint);
                steps += 1;
                beside += usize::from(halvings > 0 && !jumped);
                jumps += usize::from(jumped);
                if off >= 1e-3 {
                    println!("{}, to {:.6} by {length:.1e}: {off:.1e}, jumps {jumped}", pair.name, at + length);
                }
                missed += usize::from(off >= 1e-3);
                worst = worst.max(off);
                at += length;
                if jumped || halvings == 0 {
                    (length, halvings) = (longest, 0);
                }
            }
        }
    }
    println!(
        "{scenes} scenes, {steps} steps, {beside} before jumps, {jumps} jumps: {missed} are off, worst {worst:.1e}"
    );
    assert!(beside > 0 && missed == 0);
}
