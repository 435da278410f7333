//! Pressures to an accuracy: of runs in space at any time, and of contacts on elastic states.

use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::scene::{Features, Scene};
use viscocontact::prelude::*;

/// Ends of given steps: graded after and before each of the knots, and evenly between.
fn fine_times(scene: &Scene, asked: &[f64], ratio: f64) -> Vec<f64> {
    let until = scene.body.until;
    let mut knots: Vec<f64> = scene.moments();
    knots.extend(scene.history.corners.iter().copied().chain(asked.iter().copied()).chain([0.0, until]));
    knots.retain(|time| (0.0..=until).contains(time));
    knots.sort_by(f64::total_cmp);
    knots.dedup_by(|a, b| *a - *b < 1e-9 * until);
    let mut times: Vec<f64> = (1..400).map(|k| until * f64::from(k) / 400.0).collect();
    for pair in knots.windows(2) {
        let mut off = 1e-6 * (pair[1] - pair[0]);
        while off < 0.5 * (pair[1] - pair[0]) {
            times.extend([pair[0] + off, pair[1] - off]);
            off *= ratio;
        }
    }
    let near = |time: f64| knots.iter().any(|knot| (knot - time).abs() < 1e-9 * until);
    times.retain(|&time| !near(time));
    times.extend(knots.into_iter().filter(|time| *time > 0.0));
    times.sort_by(f64::total_cmp);
    times
}

struct Field {
    time: f64,
    pressure: Vec<f64>,
}

/// The pressures at the asked times, after jumps, by given fine steps, and the greatest force.
fn truth(scene: &Scene, asked: &[f64]) -> Option<(Vec<Field>, f64)> {
    let mut contact = scene.contact(1e-8);
    let (mut fields, mut greatest) = (Vec::new(), 0.0_f64);
    let load = scene.load();
    contact.step(0.0, load.at(0.0)).ok()?;
    for time in fine_times(scene, asked, 1.2) {
        contact.step(time - contact.time(), load.before(time)).ok()?;
        greatest = greatest.max(contact.force());
        if load.at(time) != load.before(time) {
            contact.step(0.0, load.at(time)).ok()?;
            greatest = greatest.max(contact.force());
        }
        if asked.contains(&time) {
            fields.push(Field { time, pressure: contact.pressure().to_vec() });
        }
    }
    Some((fields, greatest))
}

fn quantiles(name: &str, mut values: Vec<f64>) -> String {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values.get((share * values.len() as f64) as usize).or(values.last()).copied().unwrap_or(0.0);
    format!("{name}: {} values, 1/10/50/90/99/max {:.2?}", values.len(), [0.01, 0.1, 0.5, 0.9, 0.99, 1.0].map(at))
}

struct Outcome {
    name: String,
    over: f64,
    estimate: f64,
    contacts: usize,
    ratio: f64,
}

fn population(seed: u64, scenes: u64, accuracy: f64, print: bool) -> (Vec<Outcome>, usize) {
    let (mut outcomes, mut apart) = (Vec::new(), 0);
    for number in 0..scenes {
        let features = [Features::ANY, Features::ANY, Features::SPRING, Features::RETURNING][number as usize % 4];
        let scene = Scene::draw(seed, number, features);
        let mut draws = Draws::new(seed.wrapping_mul(7919).wrapping_add(number));
        let ratio = scene.body.creep_ratio();
        if ratio > 1000.0 {
            continue;
        }
        let mut asked: Vec<f64> = (0..3).map(|_| draws.between(0.02, 1.0) * scene.body.until).collect();
        asked.sort_by(f64::total_cmp);
        let Some((fields, greatest)) = truth(&scene, &asked) else {
            continue;
        };
        let mut contact = scene.contact(1e-6);
        let run = contact.follow(scene.load(), Stepping::adaptive(accuracy), scene.body.until);
        let mut run = run.sample_at(&asked[..]).unwrap().fields_to(accuracy).unwrap();
        let mut found = 0;
        while let Some(_) = run.next_step().unwrap_or_else(|error| panic!("{}: {error}", scene.name)) {
            for sample in run.samples() {
                let sample = sample.unwrap_or_else(|error| panic!("{}: {error}", scene.name));
                let Some(report) = sample.field() else { continue };
                let Some(truth) = fields.iter().find(|field| field.time == sample.contact().time()) else { continue };
                found += 1;
                let area = scene.grid().cell_area();
                let size = (truth.pressure.iter().sum::<f64>() * area).max(0.01 * greatest);
                if size == 0.0 {
                    apart += 1;
                    continue;
                }
                let pairs = truth.pressure.iter().zip(sample.contact().pressure());
                let off = pairs.map(|(a, b)| (a - b).abs()).sum::<f64>() * area / size;
                let over = off / accuracy;
                if print && over > 1.5 {
                    println!("{over:.2} estimate {:.2} at {:.3e}: {}", report.error.unwrap_or(f64::NAN) / accuracy, truth.time, scene.name);
                }
                outcomes.push(Outcome {
                    name: scene.name.clone(),
                    over,
                    estimate: report.error.map_or(f64::NAN, |error| error / accuracy),
                    contacts: report.elastic_contacts,
                    ratio,
                });
            }
        }
        assert!(found >= asked.len() - 1, "{}: {found} of {}", scene.name, asked.len());
    }
    (outcomes, apart)
}

#[test]
fn fields_of_runs_are_as_exact_as_asked() {
    let scenes = from_environment("FIELD_SCENES", 12);
    let print = scenes > 12;
    for accuracy in [1e-2, 1e-3] {
        let started = std::time::Instant::now();
        let (outcomes, apart) = population(from_environment("FIELD_SEED", 1), scenes, accuracy, print);
        println!("accuracy {accuracy:.0e}, {apart} apart, {:.1} s", started.elapsed().as_secs_f64());
        for beyond in [false, true] {
            let some: Vec<&Outcome> = outcomes.iter().filter(|outcome| (outcome.ratio > 100.0) == beyond).collect();
            println!("{}", quantiles("  L1 over asked", some.iter().map(|outcome| outcome.over).collect()));
            println!("{}", quantiles("  contacts", some.iter().map(|outcome| outcome.contacts as f64).collect()));
            let told = some.iter().filter(|outcome| outcome.over > 0.1);
            println!("{}", quantiles("  estimate over truth", told.map(|outcome| outcome.estimate / outcome.over).collect()));
        }
        for outcome in &outcomes {
            assert!(outcome.over < 3.0, "{}: {}", outcome.name, outcome.over);
        }
        assert!(outcomes.len() as u64 > scenes, "{}", outcomes.len());
    }
}
