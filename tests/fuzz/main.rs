//! Everything that reads or accepts data, given good and bad data: never a panic, never a hang, never NaN in a returned
//! `Ok`.
//!
//! `cargo test --all-features --test fuzz` is the short run of a contribution. A long one:
//!
//! `FUZZ_SECONDS=3600 FUZZ_SEED=7 cargo test --all-features --test fuzz -- --nocapture`
//!
//! with `FUZZ_TARGET=scene` for targets whose names begin so. A finding is printed with its case; `FUZZ_TARGET=scene
//! FUZZ_CASE=123` runs that alone. docs/maintainers/fuzzing.md has the limits.

mod checkpoints;
mod constructors;
mod engine;
mod files;
mod maps;
mod models;
mod pictures;
mod rubbing;
mod scenes;
mod source;
mod states;
mod studies;
mod tables;

use std::time::{Duration, Instant};

use engine::{Tally, Target};

/// All targets. A new one is one line here and a function from a [`source::Source`].
fn targets() -> Vec<Target> {
    let mut targets = Vec::new();
    targets.extend(maps::targets());
    targets.extend(tables::targets());
    targets.extend(constructors::targets());
    targets.extend(scenes::targets());
    targets.extend(studies::targets());
    targets.extend(files::targets());
    targets.extend(states::targets());
    targets.extend(pictures::targets());
    targets.extend(rubbing::targets());
    targets.extend(checkpoints::targets());
    targets
}

/// A number from the environment.
fn from_environment(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

#[test]
fn nothing_panics_hangs_or_returns_nan() {
    engine::watch();
    let wanted = std::env::var("FUZZ_TARGET").unwrap_or_default();
    let targets: Vec<Target> = targets().into_iter().filter(|target| target.name.starts_with(&wanted)).collect();
    assert!(!targets.is_empty(), "no target begins with {wanted}");
    if let Some(case) = from_environment("FUZZ_CASE") {
        let start = Instant::now();
        let verdict = engine::execute(&targets[0], case);
        files::leave();
        println!("{} {case}: {verdict:?} in {:.3} s", targets[0].name, start.elapsed().as_secs_f64());
        assert!(verdict.is_ok(), "{verdict:?}");
        return;
    }
    let seed = from_environment("FUZZ_SEED").unwrap_or(1);
    let mut tallies = vec![Tally::default(); targets.len()];
    match from_environment("FUZZ_SECONDS") {
        None => {
            for (index, (target, tally)) in targets.iter().zip(&mut tallies).enumerate() {
                (0..target.short).for_each(|execution| tally.take(target, engine::case(seed, index, execution)));
            }
        }
        Some(seconds) => {
            // each target has the same time, in turns
            let end = Instant::now() + Duration::from_secs(seconds);
            let turn = Duration::from_secs_f64((seconds as f64 / targets.len() as f64 / 10.0).min(10.0));
            while Instant::now() < end {
                for (index, (target, tally)) in targets.iter().zip(&mut tallies).enumerate() {
                    let start = Instant::now();
                    while start.elapsed() < turn && Instant::now() < end {
                        tally.take(target, engine::case(seed, index, tally.executions));
                    }
                }
                let total: u64 = tallies.iter().map(|tally| tally.executions).sum();
                let found: u64 = tallies.iter().map(|tally| tally.found).sum();
                println!("{total} executions, {found} findings");
                // all of it, so that what hangs later costs no record
                targets.iter().zip(&tallies).for_each(|(target, tally)| println!("  {}", tally.line(target)));
            }
        }
    }
    files::leave();
    targets.iter().zip(&tallies).for_each(|(target, tally)| println!("{}", tally.line(target)));
    // printed as they were found: the hook that silences panics silences this one, too
    let found: u64 = tallies.iter().map(|tally| tally.found).sum();
    assert!(found == 0, "{found} findings");
}
