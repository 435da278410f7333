//! Functions that the examples share.
#![allow(dead_code, reason = "each example takes what it needs")]

use std::error::Error;

use indicatif::{ProgressBar, ProgressStyle};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use viscocontact::load::LoadHistory;
use viscocontact::rheology::Material;
use viscocontact::run::Contact;
use viscocontact::states::StatesContact;
use viscocontact_identify::Experiment;

/// Ends an example: prints an error with its causes in a line, and sets the exit status.
pub fn finish(result: Result<(), Box<dyn Error>>) {
    if let Err(error) = result {
        eprint!("error: {error}");
        let mut cause = error.source();
        while let Some(error) = cause {
            eprint!(": {error}");
            cause = error.source();
        }
        eprintln!();
        std::process::exit(1);
    }
}

/// A bar on the terminal, with the time that is left.
pub fn progress(length: u64) -> ProgressBar {
    let bar = ProgressBar::new(length);
    match ProgressStyle::with_template("{bar:40} {pos}/{len}, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// The force at each time of an experiment on a body [N], by a contact on elastic states in `substeps` steps between two times: a
/// computation that shares neither its model of the material nor its time rule with a fit.
pub fn simulated(experiment: &Experiment, body: &Material, substeps: u32) -> Result<Vec<f64>, Box<dyn Error>> {
    let (history, times) = (experiment.load_history()?, experiment.protocol().times());
    let mut contact = StatesContact::new(experiment.tip(), body)?;
    let mut force = vec![0.0];
    for pair in times.windows(2) {
        for k in 1..=substeps {
            let time = pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(substeps);
            contact.step(time - contact.time(), history.at(time))?;
        }
        force.push(contact.force());
    }
    Ok(force)
}

/// Noise of a standard deviation, with a correlation of neighbours.
pub fn noise(count: usize, deviation: f64, correlation: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || (f64::from(random.next_u32()) + 0.5) / 4294967296.0;
    let mut last = 0.0;
    let mut next = |k: usize| {
        let normal = (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
        let share = if k == 0 { 0.0 } else { correlation };
        last = share * last + (1.0 - share * share).sqrt() * normal;
        deviation * last
    };
    (0..count).map(&mut next).collect()
}
