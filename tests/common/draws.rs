//! Random numbers of the kinds that scenes are made of, the same for the same seed.

use super::noise::uniform;

/// A stream of random numbers.
pub struct Draws(Box<dyn FnMut() -> f64>);

impl Draws {
    pub fn new(seed: u64) -> Draws {
        // scattered (splitmix64): linear congruential generators of neighbouring seeds draw alike
        let mut mixed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        Draws::of(uniform(mixed ^ (mixed >> 31)))
    }

    /// Of numbers between 0 and 1.
    pub fn of(next: impl FnMut() -> f64 + 'static) -> Draws {
        Draws(Box::new(next))
    }

    /// Equally probable between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0)()
    }

    /// 10^x, x equally probable between two exponents.
    pub fn power_of_ten(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low, high))
    }

    /// Equally probable between two numbers on a logarithmic axis.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf((self.0)())
    }

    /// 0 … `count` − 1.
    pub fn below(&mut self, count: usize) -> usize {
        (((self.0)() * count as f64) as usize).min(count - 1)
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        (self.0)() < probability
    }
}
