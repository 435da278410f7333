//! The whole stepper on random scenes, against a dense reference that shares no code with it.

#[path = "../common/noise.rs"]
mod noise;
mod scenes;

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
        if let Ok(only) = std::env::var("ONLY") {
            seed = only.parse().unwrap();
            taken = count;
        }
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
