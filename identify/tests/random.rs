//! Random numbers for noise.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;

/// A draw from the normal distribution of mean 0 and variance 1.
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let mut uniform = || (f64::from(rng.next_u32()) + 0.5) / 4294967296.0;
    (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}
