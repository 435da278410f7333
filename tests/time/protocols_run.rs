//! Whether runs come to their end, and in how many steps: ordinary protocols on ordinary bodies, and random scenes.
//!
//! By hand: `PROTOCOLS_SCENES=5000 PROTOCOLS_SEED=7 cargo test --release --test suite time::protocols_run -- --nocapture`.

use crate::common::random_histories::FromSmallLoad;
use crate::common::watched_runs::watch;
use crate::common::{Draws, Features, Ratios, Scene, builder_on, from_environment};
use viscocontact::prelude::*;

/// A run of so many contact problems does not end.
const MOST_PROBLEMS: u64 = 20_000;

fn bodies() -> [(&'static str, Material); 4] {
    [
        ("elastic", Material::incompressible(Elastic::new(1.0e6).unwrap())),
        ("Kelvin-Voigt", Material::incompressible(KelvinVoigt::with_time(1.0e6, 0.3).unwrap())),
        ("Maxwell", Material::incompressible(Maxwell::with_time(1.0e6, 0.3).unwrap())),
        ("fractional Zener", Material::incompressible(FractionalZener::new(3.0e6, 1.0e6, 0.3, 0.5).unwrap())),
    ]
}

/// Protocols of one second on a sphere, in approach or force.
fn protocols() -> [(&'static str, Box<dyn LoadHistory>); 5] {
    let approaches = |rows: &[(f64, f64)]| {
        let rows: Vec<_> = rows.iter().map(|&(time, approach)| (time, Load::approach(approach))).collect();
        Box::new(PiecewiseLinear::new(&rows).unwrap()) as Box<dyn LoadHistory>
    };
    let force = |of: fn(f64) -> f64| Box::new(FnHistory::new(move |t| Load::force(of(t)))) as Box<dyn LoadHistory>;
    let (above, below) = (-0.2e-4, 1.5e-4);
    [
        ("indentation at a constant rate", approaches(&[(0.0, above), (1.0, below)])),
        ("triangle of the approach", approaches(&[(0.0, above), (0.5, below), (1.0, above)])),
        ("force as t^2", force(|t| t * t)),
        ("force as t^0.5", force(f64::sqrt)),
        ("force as sin^2", force(|t| (std::f64::consts::TAU * t).sin().powi(2))),
    ]
}

/// The number of steps, rejected ones included; or why it did not end.
fn run(contact: &mut ViscoelasticContact, history: &dyn LoadHistory, stepping: Stepping) -> Result<u64, String> {
    let mut run = contact.follow(history, stepping, 1.0);
    for steps in 0..MOST_PROBLEMS {
        match run.next_step() {
            Ok(Some(_)) => {}
            Ok(None) => return Ok(steps + run.rejected_steps()),
            Err(error) => return Err(format!("at {:e} s: {error:?}", run.contact().time())),
        }
    }
    Err(format!("only at {:e} s after {MOST_PROBLEMS} steps", run.contact().time()))
}

#[test]
fn ordinary_protocols_run_to_their_end() {
    let mut failures = 0;
    for (protocol, history) in protocols() {
        for (body, material) in bodies() {
            let mut line = format!("{protocol}, {body}:");
            for (name, stepping) in [("fixed", Stepping::fixed(0.02)), ("adaptive", Stepping::adaptive(1e-3))] {
                let builder = builder_on(Grid::square(16, 4.0e-3).unwrap(), material.clone()).times_of(&*history, 1.0);
                let mut contact = builder.settings(Settings::default().with_edge(Edge::Allow)).build().unwrap();
                match run(&mut contact, &*history, stepping) {
                    Ok(problems) => line += &format!("  {name} {problems}"),
                    Err(error) => {
                        line += &format!("  {name} FAILED {error}");
                        failures += 1;
                    }
                }
            }
            println!("{line}");
        }
    }
    println!("{failures} of 40 do not end");
    assert_eq!(failures, 0);
}

/// The same history, never below a hundredth of its greatest load, is no more than twice as easy.
#[test]
fn random_protocols_run_to_their_end() {
    let scenes = from_environment("PROTOCOLS_SCENES", 250);
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
