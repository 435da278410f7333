//! Random numbers, and the curves of bodies with noise or without.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use viscocontact::load::LoadHistory;
use viscocontact::prelude::*;
use viscocontact_identify::{Curve, Experiment, Identification, Result};

/// A number from the environment, or this one.
pub fn from_environment(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

pub fn generator(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// The values of parameters beside their names.
pub fn named<'a>(names: &'a [String], values: &[f64]) -> Vec<(&'a str, f64)> {
    names.iter().map(String::as_str).zip(values.iter().copied()).collect()
}

/// The curve of a body, with noise of each sample by the greatest force.
pub fn noisy(
    of: &Identification,
    experiment: Experiment,
    body: &[(&str, f64)],
    mut noise: impl FnMut(f64) -> f64,
) -> Curve {
    let samples = of.respond(&experiment, body).unwrap();
    let greatest = samples.iter().fold(0.0, |most: f64, sample| most.max(sample.force));
    let force = samples.iter().map(|sample| sample.force + noise(greatest)).collect();
    Curve::new(experiment, force).unwrap()
}

/// The curve of a body without noise.
pub fn exact(of: &Identification, experiment: Experiment, body: &[(&str, f64)]) -> Curve {
    noisy(of, experiment, body, |_| 0.0)
}

/// The force at each time of the protocol, by the contact on elastic states in so many steps between two times.
pub fn marched(experiment: &Experiment, body: &Material, substeps: u32) -> Result<Vec<f64>> {
    let (history, mut contact) = (experiment.load_history()?, StatesContact::new(experiment.tip(), body)?);
    let to = |&end: &f64| {
        let start = contact.time();
        for k in 1..=substeps {
            let time = start + (end - start) * f64::from(k) / f64::from(substeps);
            contact.step(time - contact.time(), history.at(time))?;
        }
        Ok(contact.force())
    };
    experiment.protocol().times().iter().map(to).collect()
}

/// A draw from the normal distribution of mean 0 and variance 1.
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let mut uniform = || (f64::from(rng.next_u32()) + 0.5) / 4294967296.0;
    (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

/// A uniform draw between two values.
pub fn uniform(rng: &mut ChaCha8Rng, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) * f64::from(rng.next_u32()) / 4294967296.0
}

/// A draw between two values, uniform in the logarithm.
pub fn logarithmic(rng: &mut ChaCha8Rng, [low, high]: [f64; 2]) -> f64 {
    uniform(rng, [low.ln(), high.ln()]).exp()
}

/// One of several.
pub fn choice<T: Copy>(rng: &mut ChaCha8Rng, of: &[T]) -> T {
    of[rng.next_u32() as usize % of.len()]
}

/// Noise of standard deviation 1, each value `phi` times the one before plus an independent part.
pub fn correlated(phi: f64, rng: &mut ChaCha8Rng) -> impl FnMut() -> f64 {
    let mut value = normal(rng);
    move || {
        value = phi * value + (1.0 - phi * phi).sqrt() * normal(rng);
        value
    }
}
