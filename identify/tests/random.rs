//! Random numbers for noise.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;

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

/// Noise of standard deviation `sigma`, each value `phi` times the one before plus an independent part.
pub fn correlated(count: usize, sigma: f64, phi: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut value = sigma * normal(rng);
    let mut next = || {
        value = phi * value + (1.0 - phi * phi).sqrt() * sigma * normal(rng);
        value
    };
    (0..count).map(|_| next()).collect()
}
