//! Whether runs of random scenes come to their end, and in how many steps.
//!
//! By hand: `PROTOCOLS_SCENES=5000 PROTOCOLS_SEED=7 cargo test --release --test suite time::protocols_run -- --nocapture`.

use crate::common::random_histories::FromSmallLoad;
use crate::common::watched_runs::watch;
use crate::common::{Draws, Features, Ratios, Scene, from_environment};
use viscocontact::prelude::*;

/// A run of so many contact problems does not end.
const MOST_PROBLEMS: u64 = 20_000;

/// The same history, never below a hundredth of its greatest load, is no more than twice as easy.
#[test]
fn random_protocols_run_to_their_end() {
    let scenes = from_environment("PROTOCOLS_SCENES", 150);
    let seed = from_environment("PROTOCOLS_SEED", 2);
    let (mut failures, mut compared, mut total) = (Vec::new(), Ratios::default(), [0; 2]);
    for number in 0..scenes {
        let scene = Scene::draw(seed, number, Features::ANY);
        let tolerance = Draws::new(number.wrapping_add(77 * seed)).power_of_ten(-4.0, -2.0);
        let name = format!("{tolerance:.0e} {}", scene.name);
        let steps = |history: &dyn LoadHistory| {
            let mut contact = scene.contact(Settings::default().tolerance());
            watch(&scene, &mut contact, history, Stepping::adaptive(tolerance), &scene.stops, MOST_PROBLEMS)
        };
        let from_small = FromSmallLoad::new(scene.load(), scene.control.load(0.01), scene.body.until);
        // a body without elastic response cannot start from a load, and an approach that starts with a jump asks for less: the
        // force of the jump is then the greatest, which the errors of the run are relative to
        let comparable = scene.body.is_elastic_at_once() && !scene.control.is_approach();
        let easier = comparable.then(|| steps(&from_small));
        match (steps(scene.load()), easier) {
            (Ok(run), Some(Ok(easier))) => {
                total = [total[0] + run.problems(), total[1] + easier.problems()];
                let name = format!("{} problems: {name}", run.problems());
                compared.push(run.problems() as f64 / easier.problems() as f64, &name);
            }
            (Ok(_), None) => {}
            (Ok(_), Some(Err(stopped))) => failures.push(format!("from a small load, {stopped}: {name}")),
            (Err(stopped), _) => failures.push(format!("{stopped}: {name}")),
        }
    }
    println!("seed {seed}: {} of {scenes} runs do not end", failures.len());
    failures.iter().take(12).for_each(|failure| println!("    {failure}"));
    println!("{} contact problems, {} from a small load; their ratio:", total[0], total[1]);
    compared.print("over a small start", 12);
    assert!(failures.is_empty(), "{} do not end", failures.len());
    assert_eq!(compared.above(2.0), 0);
}
