//! A smooth function of distance, interpolated.

use std::f64::consts::PI;

/// Nodes of an interval.
const NODES: usize = 24;

/// Chebyshev series of a function on \[0, 1\], \[1, 2\], \[2, 4\], \[4, 8\], …: for one that is analytic up to a
/// distance of 2 from the real axis their error is below rounding.
#[derive(Debug, Clone)]
pub(super) struct Table {
    /// Coefficients of each interval, the first of them halved.
    series: Vec<[f64; NODES]>,
}

impl Table {
    /// The table of `function` for distances from 0 to `last`.
    pub(super) fn new(last: f64, function: impl Fn(f64) -> f64) -> Table {
        let count = if last <= 1.0 { 1 } else { interval(last) + 1 };
        Table { series: (0..count).map(|n| chebyshev(ends(n), &function)).collect() }
    }

    /// The function at the distance `x`, at most the last distance of the table.
    pub(super) fn at(&self, x: f64) -> f64 {
        let n = interval(x).min(self.series.len() - 1);
        let [from, to] = ends(n);
        let z = (2.0 * x - from - to) / (to - from);
        // Clenshaw's recurrence
        let (mut above, mut value) = (0.0, 0.0);
        for coefficient in self.series[n][1..].iter().rev() {
            (above, value) = (value, coefficient + 2.0 * z * value - above);
        }
        self.series[n][0] + z * value - above
    }
}

/// The interval that `x` lies in.
fn interval(x: f64) -> usize {
    // the exponent of x ≥ 1
    if x < 1.0 { 0 } else { (x.to_bits() >> 52) as usize - 1022 }
}

fn ends(interval: usize) -> [f64; 2] {
    if interval == 0 { [0.0, 1.0] } else { [0.5, 1.0].map(|part| part * 2_f64.powi(interval as i32)) }
}

fn chebyshev(interval: [f64; 2], function: impl Fn(f64) -> f64) -> [f64; NODES] {
    let [from, to] = interval;
    let angle = |k: usize| PI * (k as f64 + 0.5) / NODES as f64;
    let values: [f64; NODES] =
        std::array::from_fn(|k| function(0.5 * (from + to) + 0.5 * (to - from) * angle(k).cos()));
    std::array::from_fn(|m| {
        let sum: f64 = values.iter().enumerate().map(|(k, value)| value * (m as f64 * angle(k)).cos()).sum();
        sum * if m == 0 { 1.0 } else { 2.0 } / NODES as f64
    })
}
