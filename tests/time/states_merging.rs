//! Long runs on elastic states in steps of given length: merged groups of levels stay few, and change force, depth and area by no more than
//! stated. `STATES_STEPS=1000000` for the whole length.

use std::f64::consts::TAU;
use std::time::Instant;

use crate::common::{Draws, from_environment};
use viscocontact::prelude::*;
use viscocontact::states::{ElasticStates, StatesContact};

/// Length of all steps [s].
const STEP: f64 = 1e-3;
/// Merge errors, with the greatest number of groups.
const ERRORS: [(f64, usize); 2] = [(1e-4, 300), (1e-6, 2500)];
/// What is stated: force and depth err by the merge error at most, the area by ten times as much.
const OF_FORCE: f64 = 1.0;
const OF_AREA: f64 = 10.0;
const LOADS: [&str; 9] = [
    "sine of the force",
    "bouncing approach",
    "random forces",
    "walk of the force",
    "walk of the approach",
    "slow ramp down",
    "triangles of the force",
    "triangles of the approach",
    "sine that falls a thousandfold",
];

/// A body with so many relaxation times.
fn body(times: u32) -> Material {
    let (equilibrium, modulus, first, decades) =
        [(0.1, 0.9, 1.0, 0.0), (0.1, 0.18, 1e-3, 4.0), (0.01, 0.033, 1e-4, 8.0)]
            [(times > 1) as usize + (times > 5) as usize];
    let time = |k: u32| first * 10f64.powf(decades * f64::from(k) / f64::from(times.max(2) - 1));
    let terms: Vec<_> = (0..times).map(|k| (0.25 * modulus, time(k))).collect();
    Material::incompressible(GeneralizedMaxwell::new(0.25 * equilibrium, &terms).unwrap())
}

/// The loads of a run of so many steps.
fn loads(kind: &str, steps: usize) -> impl FnMut(usize) -> Load {
    let (mut draws, mut walk) = (Draws::new(7), 0.5);
    let rate = TAU * 7.3;
    move |k| {
        let (time, part) = (k as f64 * STEP, k as f64 / steps as f64);
        let triangle = 1.0 - (2.0 * (time / 1.37).fract() - 1.0).abs();
        let mut walked = |low: f64| {
            walk = (walk + 0.02 * (draws.between(0.0, 1.0) - 0.5)).clamp(low, 1.0);
            walk
        };
        match kind {
            "sine of the force" => Load::force(0.5 + 0.45 * (rate * time).sin()),
            "bouncing approach" => Load::approach(0.3 * (rate * time).sin() + 0.08 * (0.61 * time).sin()),
            "random forces" => Load::force(draws.between(0.0, 1.0)),
            "walk of the force" => Load::force(walked(0.0)),
            "walk of the approach" => Load::approach(walked(-0.1)),
            "slow ramp down" if part < 0.1 => Load::force(10.0 * part),
            "slow ramp down" => Load::force(1.0 - 0.95 * (part - 0.1) / 0.9),
            "triangles of the force" => Load::force(triangle),
            "triangles of the approach" => Load::approach(triangle - 0.1),
            _ => Load::force(if part < 0.3 { 1.0 } else { 1e-3 } * (0.5 + 0.45 * (rate * time).sin())),
        }
    }
}

/// What a run gives: force, depth and area of the first steps, the most groups before and after the first tenth, and its time [s].
struct Found {
    values: Vec<[f64; 3]>,
    groups: [usize; 2],
    time: f64,
}

fn run(times: u32, kind: &str, steps: usize, kept: usize, error: f64) -> Found {
    let mut contact = StatesContact::new(&ElasticStates::sphere(1.0).unwrap(), &body(times))
        .unwrap()
        .with_merge_error(error)
        .unwrap();
    let (mut load, mut values, mut groups, start) = (loads(kind, steps), Vec::new(), [0; 2], Instant::now());
    for k in 0..steps {
        contact.step(if k == 0 { 0.0 } else { STEP }, load(k)).unwrap();
        if k < kept {
            values.push([contact.force(), contact.approach(), contact.contact_area()]);
        }
        let most = &mut groups[usize::from(k > steps / 10)];
        *most = contact.groups().max(*most);
    }
    Found { values, groups, time: start.elapsed().as_secs_f64() / steps as f64 }
}

/// Errors relative to the greatest values of the run, or of its last half where loads fall.
#[test]
fn merged_groups_are_few_and_change_little() {
    let steps = from_environment("STATES_STEPS", 1500) as usize;
    let kept = steps.min(from_environment("STATES_KEPT", 20_000) as usize);
    let mut compared = 0;
    for times in [1, 5, 30] {
        for kind in LOADS {
            let all = run(times, kind, kept, kept, 0.0).values;
            let from = if kind == LOADS[8] { all.len() / 2 } else { 0 };
            for (error, most) in ERRORS {
                // as many steps as the reference has, for loads that depend on their number
                let found = run(times, kind, kept, kept, error);
                let long = (steps > kept).then(|| run(times, kind, steps, 0, error));
                let long = long.as_ref().unwrap_or(&found);
                let off = [0, 1, 2].map(|axis| {
                    let greatest = all[from..].iter().fold(0.0, |most: f64, values| most.max(values[axis].abs()));
                    let pairs = found.values[from..].iter().zip(&all[from..]);
                    pairs.fold(0.0, |most: f64, (found, right)| most.max((found[axis] - right[axis]).abs())) / greatest
                });
                println!(
                    "{times:>2} times, {kind}, {error:.0e}: groups {:?}, {:.2} µs a step, force {:.1e}, depth {:.1e}, area {:.1e}",
                    long.groups,
                    1e6 * long.time,
                    off[0],
                    off[1],
                    off[2]
                );
                let bounds = [OF_FORCE, OF_FORCE, OF_AREA].map(|factor| factor * error);
                assert!(
                    off.iter().zip(bounds).all(|(off, bound)| *off <= bound),
                    "{times} times, {kind}, {error:.0e}: {off:?}"
                );
                assert!(long.groups.iter().all(|groups| *groups <= most), "{times} times, {kind}: {:?}", long.groups);
                compared += usize::from(off[1] > 0.0 || off[0] > 0.0);
            }
        }
    }
    assert!(compared > 40, "{compared} runs merge anything");
}
