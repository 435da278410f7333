//! How the first guess of a step extrapolates from the last one.

/// A guess reaches at most this many times the length of the last step ahead.
pub(crate) const MAX_REACH: f64 = 2.0;

/// The length of the step to extrapolate from, and when K p was last computed afresh.
///
/// The first guess of a step extrapolates p and K p alike, which saves a convolution but lets the rounding of K p
/// accumulate, step by step linearly. After 62 steps K p is computed afresh, in two successive steps: extrapolation
/// reads two states, and one left stale would feed its error back, multiplied. This costs a thirty-second of a
/// convolution per step. K p is computed afresh, too, when the force has fallen by a factor of 8, since the rounding
/// came from the larger force, and when steps that grow have multiplied the rounding by 1000: a guess that reaches a
/// times the last step ahead multiplies the difference of the errors of the last two states by a.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Extrapolation {
    /// Length of the last step, 0 where the next must not extrapolate from it.
    last_dt: f64,
    /// Steps that are still to compute K p afresh.
    due: usize,
    /// Steps since then.
    stale: usize,
    /// The largest Σ p since then.
    greatest: f64,
    /// The factor by which the rounding has grown since then.
    growth: f64,
}

impl Default for Extrapolation {
    fn default() -> Extrapolation {
        Extrapolation { last_dt: 0.0, due: 0, stale: 0, greatest: 0.0, growth: 1.0 }
    }
}

impl Extrapolation {
    /// How many times the last step a guess for a step of length `dt` reaches ahead.
    pub(crate) fn reach(&self, dt: f64) -> f64 {
        if self.last_dt > 0.0 { (dt / self.last_dt).min(MAX_REACH) } else { 0.0 }
    }

    /// Whether K p of the next guess has to be computed afresh.
    pub(crate) fn refresh_is_due(&self) -> bool {
        self.due > 0
    }

    /// The next step must not extrapolate from the last.
    pub(crate) fn interrupt(&mut self) {
        self.last_dt = 0.0;
    }

    /// After a step of length `dt` with Σ p = `sum`, whose guess reached so many times the step before it ahead.
    pub(crate) fn accept(&mut self, dt: f64, sum: f64, reach: f64) {
        self.last_dt = dt;
        if self.due > 0 {
            *self = Extrapolation { last_dt: dt, due: self.due - 1, greatest: sum, ..Extrapolation::default() };
            return;
        }
        self.stale = self.stale.saturating_add(1);
        self.greatest = self.greatest.max(sum);
        self.growth *= reach.max(1.0);
        if self.growth > 1e3 || self.stale >= 62 || sum < self.greatest / 8.0 {
            self.due = 2;
        }
    }
}
