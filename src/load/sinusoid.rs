use std::f64::consts::TAU;

use crate::error::{Result, in_order, non_negative, positive};
use crate::load::{Load, LoadHistory};

/// A load that oscillates between two values: it starts at the mean at t = 0, rising towards `high`, and is
/// constant before.
///
/// ```
/// use viscocontact::load::{Load, Sinusoid};
///
/// // 3 N ± 2 N at 1 Hz
/// let sine = Sinusoid::new(Load::force(1.0), Load::force(5.0), 1.0)?;
/// assert_eq!(Sinusoid::about(Load::force(3.0), 2.0, 1.0)?, sine);
/// assert!(Sinusoid::new(Load::force(0.3), Load::force(0.2), 1.0).is_err());
/// # Ok::<(), viscocontact::Error>(())
/// ```
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
    /// If the frequency is not finite and positive, a load is invalid, the loads are of different kinds, or force,
    /// approach or drive of `low` exceeds the value of `high`.
    pub fn new(low: Load, high: Load, frequency: f64) -> Result<Sinusoid> {
        Load::validate_all("sinusoid", [low, high])?;
        let (field, rule) = ("sinusoid from low to high", "not fall; `Sinusoid::about` takes mean and amplitude");
        in_order(field, [low, high].map(|load| load.main()), rule, |low, high| low <= high)?;
        Ok(Sinusoid { low, high, frequency: positive("frequency", frequency)? })
    }

    /// Oscillation about `mean` by the `amplitude` of its force \[N\], approach or drive \[m\], with `frequency`
    /// cycles per second \[Hz\].
    ///
    /// # Errors
    /// If the amplitude is negative, and as [`Sinusoid::new`].
    pub fn about(mean: Load, amplitude: f64, frequency: f64) -> Result<Sinusoid> {
        non_negative("amplitude", amplitude)?;
        Sinusoid::new(mean.changed(-amplitude), mean.changed(amplitude), frequency)
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
