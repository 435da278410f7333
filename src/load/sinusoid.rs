use std::f64::consts::TAU;

use crate::error::{Result, positive};
use crate::load::{Load, LoadHistory};

/// A load that oscillates between two values: it starts at the mean at t = 0, rising towards `high`, and is
/// constant before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoid {
    low: Load,
    high: Load,
    frequency: f64,
}

impl Sinusoid {
    /// Oscillation between `low` and `high` with `frequency` cycles per second \[Hz\].
    ///
    /// # Errors
    /// If the frequency is not finite and positive, a load is invalid, or the loads are of different kinds.
    pub fn new(low: Load, high: Load, frequency: f64) -> Result<Sinusoid> {
        Load::validate_all("sinusoid", [low, high])?;
        Ok(Sinusoid { low, high, frequency: positive("frequency", frequency)? })
    }
}

impl LoadHistory for Sinusoid {
    fn at(&self, t: f64) -> Load {
        let (t, cycles) = (t.max(0.0), self.frequency * t.max(0.0));
        // if the number of cycles overflows, the fraction of the last one
        let cycles = if cycles.is_finite() { cycles } else { t % (1.0 / self.frequency) * self.frequency };
        let phase = cycles.fract();
        self.low.towards(&self.high, 0.5 + 0.5 * (TAU * phase).sin())
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        (after < 0.0).then_some(0.0)
    }
}
