//! Every step beside a jump ends, however fine its tolerance and however short it is: random scenes are led up to each of their jumps by steps
//! that are halved, and through it by a step of the least length. `ADHESION_JUMPS` (6) chooses the number of scenes, `ADHESION_SEED` (1) others.

use super::adhesion_population::{Drawn, SIDE, Scene, check};
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;

/// Steps tried on a way down or back, at most.
const MOST_STEPS: usize = 400;

#[test]
fn every_step_beside_a_jump_ends() {
    let (scenes, seed) = (from_environment("ADHESION_JUMPS", 6), from_environment("ADHESION_SEED", 1));
    let (mut steps, mut passes, mut most, mut jumps, mut full) = (0, 0, 0, 0, 0);
    for number in 0..scenes {
        let mut draws = Draws::new(1000 * (seed - 1) + number);
        let scene = Scene::draw(
            &mut draws,
            &Drawn {
                side: 6.0,
                tabor: [0.8, 2.2],
                heights: [0.05, 0.5],
                waves: [3.0, 6.0],
                creeping: 0.4,
                periodic: 0.0,
            },
        );
        let tolerance = draws.scale(1e-9, 1e-3);
        let (kind, shortest, time) = (draws.below(3), draws.scale(1e-6, 1e-3), draws.scale(0.1, 10.0));
        let name =
            format!("scene {number}: {}, tolerance {tolerance:.1e}, steps of {shortest:.1e}, load {kind}", scene.name);
        let mut contact = scene.build(Settings::default().with_tolerance(tolerance));
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
                    Err(Error::PulledOff { .. }) if kind == 2 => true,
                    // waves that stick all over the grid
                    Err(error) if error.code() == "adhesion_fills_grid" => {
                        full += 1;
                        break 'scene;
                    }
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
                    check(&format!("{name}, at {at} by {length:.1e}"), &contact, &*scene.law, !scene.creeping);
                }
                (at, length) = (at + length, longest);
                if (to - at) * longest < 0.0 {
                    break;
                }
            }
        }
    }
    println!(
        "{scenes} scenes, {steps} steps, {jumps} jumps; {passes} passes, at most {most} in a step; {full} fill the grid"
    );
    assert!(jumps > 0 && 3 * full <= scenes, "{full} of {scenes}");
}

/// A jump is what stays however a step is split: steps carry the warning where a quarter of what they release is left in 64 parts, and where
/// hardly anything is left they do not. Among them bodies that are held apart, and let go.
#[test]
fn jumps_are_what_stays_in_parts() {
    let scenes = from_environment("ADHESION_JUMPS", 24);
    let (mut flagged, mut real, mut missed, mut wrong, mut steps, mut looks) = (0, 0, 0, 0, 0, 0);
    for number in 0..scenes {
        let mut draws = Draws::new(7000 * from_environment("ADHESION_SEED", 1) + number);
        let scene = Scene::draw(
            &mut draws,
            &Drawn {
                side: SIDE,
                tabor: [0.5, 1.4],
                heights: [0.02, 0.4],
                waves: [2.0, 5.0],
                creeping: 0.3,
                periodic: 0.4,
            },
        );
        let (law, mut contact) = (&scene.law, scene.build(Settings::default()));
        let (kind, count, dt) = (number % 3, draws.scale(10.0, 80.0) as u32, draws.scale(0.02, 2.0));
        let (stiffness, down, touch) = (draws.scale(1.0, 50.0), draws.between(0.2, 0.8), contact.approach());
        let load = |way: f64| {
            let at = if way < 0.4 { -2.5 + (2.5 + down) * way / 0.4 } else { down - (way - 0.4) / 0.6 * (down + 3.0) };
            match kind {
                0 => Load::approach(touch + at),
                1 => Load::spring(stiffness, touch + at),
                _ if way == 0.0 => Load::approach(touch - 2.5),
                _ => Load::force(if at > 0.0 {
                    5.0 * at
                } else if way < 0.4 {
                    0.0
                } else {
                    1.2 * at
                }),
            }
        };
        for k in 0..=count {
            let [from, to] = [k.saturating_sub(1), k].map(|k| f64::from(k) / f64::from(count));
            let before = contact.clone();
            let dt = if k == 0 { 0.0 } else { dt };
            let Ok(report) = contact.step(dt, load(to)) else { break };
            let (own, is_flagged) = (contact.passes().unwrap(), report.warnings.contains(Warnings::JUMP));
            (steps, flagged) = (steps + 1, flagged + usize::from(is_flagged));
            let (mut left, start, mut parts) = (0.0, before.clone(), before);
            // what is small is no jump, though an eighth of it may stay: none of them is flagged
            if k == 0 || own.released < 1e-3 * law.energy(0.0) || !is_flagged && own.released < 1e-2 * law.energy(0.0) {
                continue;
            }
            looks += 1;
            for part in 1..=64 {
                let share = f64::from(part) / 64.0;
                let load = if kind == 2 && k == 1 { load(to) } else { load(from + share * (to - from)) };
                if let Err(error) = parts.step(dt / 64.0, load) {
                    println!("scene {number}, step {k}, part {part}: {error:?} after {:?}", parts.passes());
                    left = f64::INFINITY;
                    break;
                }
                left += parts.passes().unwrap().released;
            }
            // beside a jump to come the step took it early
            let early = |of: fn(&ViscoelasticContact) -> f64| {
                (of(&parts) - of(&contact)).abs() > 0.3 * (of(&start) - of(&contact)).abs()
            };
            let is_early = left.is_finite()
                && early(ViscoelasticContact::force).max(early(ViscoelasticContact::approach))
                && is_flagged;
            let left = if is_early { 1.0 } else { left / own.released };
            real += usize::from(left > 0.25);
            if (left > 0.25 && !is_flagged) || (left < 0.06 && is_flagged) {
                println!(
                    "scene {number}, step {k}: {}, load {kind}, released {:.3e}, {left:.3} left, flagged {is_flagged}",
                    scene.name, own.released
                );
            }
            missed += usize::from(left > 0.25 && !is_flagged);
            wrong += usize::from(left < 0.06 && is_flagged);
        }
    }
    println!(
        "{scenes} scenes, {steps} steps, {looks} looked at, {flagged} flagged, {real} real: {missed} missed, {wrong} false"
    );
    assert!(real > 0 && missed == 0 && 20 * wrong <= flagged);
}
