//! Prints a hash of the states of random scenes, a line each: where two trees compute the same bits, they print the same lines.
//!
//! `cargo run --all-features -p viscocontact-tests --bin bits -- 100 > before.txt`, for 100 scenes of each kind.

use std::hash::{DefaultHasher, Hash, Hasher};

use viscocontact::prelude::*;
use viscocontact_scenes::any_scene::AnyScene;
use viscocontact_scenes::{Features, Scene};

fn hash(numbers: impl IntoIterator<Item = u64>) -> u64 {
    let mut hasher = DefaultHasher::new();
    numbers.into_iter().for_each(|number| number.hash(&mut hasher));
    hasher.finish()
}

/// A scene of any kernel, on the whole grid or in a window.
fn of_any_kernel(seed: u64, window: bool) -> String {
    let mut scene = AnyScene::new(seed);
    scene.settings = scene.settings.with_window(window);
    match scene.course(None) {
        Ok(course) => {
            let fields = course.fields.iter().flatten();
            format!("{} steps {:016x}", course.reports.len(), hash(course.numbers.iter().chain(fields).copied()))
        }
        Err(error) => format!("{error}"),
    }
}

/// A scene whose steps are chosen by their error.
fn adaptive(scene: &Scene) -> String {
    let mut contact = scene.contact(1e-10);
    let mut run = contact.follow(scene.load(), Stepping::adaptive(1e-3), scene.body.until);
    let mut steps = 0;
    let end = loop {
        match run.next_step() {
            Ok(Some(_)) if steps < 200 => steps += 1,
            Ok(_) => break "ends".to_string(),
            Err(error) => break error.to_string(),
        }
    };
    let fields = contact.pressure().iter().chain(contact.fields().displacement());
    let numbers = fields.chain([&contact.time(), &contact.approach()]).map(|value| value.to_bits()).collect::<Vec<_>>();
    format!("{steps} steps {:016x} {end}", hash(numbers))
}

fn main() {
    let count: u64 = std::env::args().nth(1).map_or(24, |count| count.parse().expect("a number of scenes"));
    for seed in 0..count {
        for window in [false, true] {
            println!("any kernel {seed} window {window}: {}", of_any_kernel(seed, window));
        }
        println!("adaptive {seed}: {}", adaptive(&Scene::draw(1, seed, Features::ANY)));
        println!("returning {seed}: {}", adaptive(&Scene::draw(1, seed, Features::RETURNING)));
    }
}
