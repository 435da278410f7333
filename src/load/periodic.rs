use crate::error::{Result, positive, within};
use crate::load::{Load, LoadHistory, PiecewiseLinear};

/// A piecewise linear load that repeats without end: square, triangle, sawtooth, or any table. Where the last load of
/// the table differs from the first, it jumps from one period to the next.
///
/// Jumps and corners are exact at any number of periods: the corner at c of the period number n lies at the f64
/// nearest to n P + c.
///
/// ```
/// use viscocontact::load::{Load, LoadHistory, Periodic};
///
/// let [on, off] = [Load::force(0.5), Load::force(0.0)];
/// let blinking = Periodic::square(on, off, 0.02, 0.5)?; // on for half of 20 ms
/// assert_eq!([blinking.before(0.01), blinking.at(0.01), blinking.at(0.02)], [on, off, on]);
/// assert_eq!(blinking.next_breakpoint(1.0e4), Some(10_000.01));
///
/// let taps = Periodic::new(&[(0.0, off), (0.125, on), (0.25, off), (1.0, off)])?; // one a second
/// assert_eq!(taps.at(60.0625), Load::force(0.25));
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    /// Times from the start of a period \[s\], and loads.
    period: Vec<(f64, Load)>,
    /// Length of a period \[s\].
    length: f64,
    /// Start of the first period \[s\].
    start: f64,
}

impl Periodic {
    /// Repeats a `table`, as of [`PiecewiseLinear::new`], from its first time on; a period lasts from its first time
    /// \[s\] to its last. Before, the load is the first one.
    ///
    /// # Errors
    /// If the period is not finite and positive, and as [`PiecewiseLinear::new`].
    pub fn new(table: &[(f64, Load)]) -> Result<Periodic> {
        PiecewiseLinear::new(table)?;
        let [start, end] = [0, table.len() - 1].map(|k| table[k].0);
        let length = positive("period", end - start)?;
        Ok(Periodic { period: table.iter().map(|&(time, load)| (time - start, load)).collect(), length, start })
    }

    /// From t = 0 on `first` for the part `duty` of each `period` \[s\], then `second`.
    ///
    /// # Errors
    /// If the period is not finite and positive, `duty` not in (0, 1), a load is invalid, or the loads are of
    /// different kinds.
    pub fn square(first: Load, second: Load, period: f64, duty: f64) -> Result<Periodic> {
        within("duty cycle", duty, duty > 0.0 && duty < 1.0, "in (0, 1)")?;
        let change = duty * positive("period", period)?;
        Periodic::new(&[(0.0, first), (change, first), (change, second), (period, second)])
    }

    /// From t = 0 on linearly `from` one load `to` another in half of each `period` \[s\], and back.
    ///
    /// # Errors
    /// As [`Periodic::square`].
    pub fn triangle(from: Load, to: Load, period: f64) -> Result<Periodic> {
        Periodic::new(&[(0.0, from), (0.5 * positive("period", period)?, to), (period, from)])
    }

    /// From t = 0 on linearly `from` one load `to` another in each `period` \[s\], and back at once.
    ///
    /// # Errors
    /// As [`Periodic::square`].
    pub fn sawtooth(from: Load, to: Load, period: f64) -> Result<Periodic> {
        Periodic::new(&[(0.0, from), (positive("period", period)?, to)])
    }

    /// The time `phase` of the period number `n`. The sum is rounded after it is taken, so that times never decrease
    /// from entry to entry.
    fn time(&self, n: f64, phase: f64) -> f64 {
        n.mul_add(self.length, phase) + self.start
    }

    /// The period at `t`, and its first entry that has not `passed`.
    fn place(&self, t: f64, passed: impl Fn(f64) -> bool) -> (f64, usize) {
        // but for rounding one less than the period
        let mut n = ((t - self.start) / self.length - 1.0).floor().max(0.0);
        for _ in 0..2 {
            n += if passed(self.time(n + 1.0, 0.0)) { 1.0 } else { 0.0 };
        }
        (n, self.period.partition_point(|entry| passed(self.time(n, entry.0))))
    }

    fn load(&self, t: f64, passed: impl Fn(f64) -> bool) -> Load {
        let (n, next) = self.place(t, passed);
        let [from, to] = [next.saturating_sub(1), next].map(|k| self.period[k.min(self.period.len() - 1)]);
        let [start, end] = [from, to].map(|(phase, _)| self.time(n, phase));
        let share = if end > start { (t - start) / (end - start) } else { 0.0 };
        from.1.towards(&to.1, share)
    }
}

impl LoadHistory for Periodic {
    fn at(&self, t: f64) -> Load {
        self.load(t, |time| time <= t)
    }

    fn before(&self, t: f64) -> Load {
        self.load(t, |time| time < t)
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        let (n, next) = self.place(after, |time| time <= after);
        self.period.get(next).map(|entry| self.time(n, entry.0)).filter(|time| time.is_finite())
    }
}
