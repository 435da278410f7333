//! Whether runs keep to their tolerance where loads go back and return: the surface that recovers outside the contact is met
//! again, and the errors of many steps add up.
//!
//! The forge runs 300 scenes. By hand:
//! `RETURNS_SCENES=1000 RETURNS_SEED=1 cargo test --release --test suite time::returns -- --nocapture`; `RETURNS_FIRST=17`
//! begins with that number, `RETURNS_STEPS=300000` finds the truth of more scenes. `RETURNS_SPRINGS` counts those by springs.

use super::honest::Promise;
use crate::common::watched_runs::watch;
use crate::common::{Features, Ratios, Scene, Truth, builder_on, from_environment};
use viscocontact::prelude::*;

/// A run of so many contact problems does not end.
const MOST_PROBLEMS: u64 = 50_000;

/// The least tolerance in long populations alone.
fn returns(count: &'static str, features: &'static [Features]) -> Promise {
    Promise {
        features,
        chosen: [(count, 16), ("RETURNS_SEED", 2), ("RETURNS_FIRST", 0), ("RETURNS_STEPS", 20_000)],
        most_problems: MOST_PROBLEMS,
        tolerances: if from_environment(count, 16) > 16 { 4 } else { 3 },
        share: 0.99,
        high: [2.0; 4],
        most: [3.0; 4],
        by_budget: true,
    }
}

/// True errors are at most twice the tolerance in 99 % of random scenes down to 1e-4, somewhat more at 1e-5, and in 98 % at
/// most twice what the budget states of approach or force.
#[test]
fn errors_are_honest_on_random_returns() {
    Promise { high: [1.2, 1.8, 2.0, 2.7], most: [5.0; 4], ..returns("RETURNS_SCENES", &[Features::RETURNING]) }.check();
}

/// True errors of approach and force are at most twice the tolerance in 99 % of random scenes under springs, 1/20 to 20 times as stiff as the
/// bodies, and three times in all.
#[test]
fn errors_are_honest_on_random_returns_by_springs() {
    returns("RETURNS_SPRINGS", &[Features::RETURNING_BY_SPRING]).check();
}

/// Step loads on bodies of one relaxation time err by at most twice 1e-4, and short ramps before long holds by at most twice the tolerance,
/// in 99 % of random scenes: the first of the scenes above that are such. By hand:
/// `STEPS_SCENES=250 cargo test --release --test suite time::returns::step_loads -- --nocapture`, with `STEPS_SEED=3`.
#[test]
fn step_loads_and_short_ramps_are_honest() {
    let [wanted, seed] =
        [("STEPS_SCENES", 6), ("STEPS_SEED", 2)].map(|(name, default)| from_environment(name, default));
    let mut ratios: [Ratios; 2] = Default::default();
    let is_step = |scene: &Scene| {
        let creep = scene.body.material.contact_spectrum().unwrap().unwrap();
        scene.history.name.starts_with("step") && creep.terms().len() == 1
    };
    let is_ramp = |scene: &Scene| scene.history.name.starts_with("ramp, hold");
    let (mut steps, mut ramps) = (0, 0);
    for scene in (0..).map(|number| Scene::draw(seed, number, Features::RETURNING)) {
        let (step, ramp) = (is_step(&scene) && steps < wanted, is_ramp(&scene) && ramps < wanted);
        (steps, ramps) = (steps + u64::from(step), ramps + u64::from(ramp));
        for tolerance in [1e-2, 1e-3, 1e-4].into_iter().filter(|&tolerance| ramp || step && tolerance == 1e-4) {
            let truth = Truth::of(&scene, 0.1 * tolerance, 20_000).unwrap();
            let mut contact = scene.contact(Settings::default().tolerance());
            let stepping = Stepping::adaptive(tolerance);
            let run = watch(&scene, &mut contact, scene.load(), stepping, &scene.stops, MOST_PROBLEMS).unwrap();
            let (errors, name) = (truth.errors(&run), format!("at {tolerance:e}: {}", scene.name));
            if truth.uncertainty[0] <= 0.1 * tolerance.max(errors[0]) {
                ratios[usize::from(!step)].push(errors[0] / tolerance, &name);
            }
        }
        if steps == wanted && ramps == wanted {
            break;
        }
    }
    for (ratios, name) in ratios.iter().zip(["steps, over 1e-4", "ramps, over the tolerance"]) {
        ratios.print(name, 3);
        assert!(ratios.quantile(0.99) <= 2.0, "{name}");
    }
}

/// Cells leave within steps of many relaxation times, after which a force presses the bodies deeper than before: the kink of u shows little in
/// its differences where it is near the end of a step.
#[test]
fn cells_that_leave_in_long_steps_are_honest() {
    let (until, tolerance) = (18.94, 1e-5);
    let force = |part: f64| Load::force(2.0171e-2 * part);
    let rows = [(0.0, force(0.0)), (0.4243 * until, force(1.0)), (0.8487 * until, force(0.2)), (until, force(0.8))];
    let load = PiecewiseLinear::new(&rows).unwrap();
    let body = FractionalZener::new(1.0e6, 1.0e6 / 2.2523, 0.01, 0.6909).unwrap();
    let contact = || {
        let builder = builder_on(Grid::square(14, 2.0e-3).unwrap(), Material::incompressible(body));
        let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(1e-10);
        builder.times_of(&load, until).settings(settings).build().unwrap()
    };
    let (mut tried, mut fine) = (contact(), contact());
    let mut run = tried.follow(&load, Stepping::adaptive(tolerance), until);
    let (mut now, mut worst, mut deepest, mut leaves, mut cells) = (0.0, 0.0_f64, 0.0_f64, 0, 0);
    while let Some(StepReport { time, approach, contact_cells, .. }) = run.next_step().unwrap() {
        for part in 1..=32 {
            let next = if part == 32 { time } else { now + (time - now) * f64::from(part) / 32.0 };
            fine.step(next - fine.time(), load.before(next)).unwrap();
        }
        (now, leaves, cells) = (time, leaves + usize::from(contact_cells < cells), contact_cells);
        (worst, deepest) = (worst.max((approach - fine.approach()).abs()), deepest.max(fine.approach()));
    }
    let worst = worst / deepest / tolerance;
    println!("cells leave in {leaves} steps, maximum error {worst:.2} tolerances");
    assert!(leaves >= 3 && worst <= 2.0, "{worst}");
}
