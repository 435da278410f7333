//! Where a function of one number has its minimum.

/// Where `of` has its minimum between `low` and `high`, in the units of both, if it has no other there: by so many
/// golden sections, each of which leaves 0.618 of the interval (Kiefer, Proc. Am. Math. Soc. 4, 1953).
pub(crate) fn golden_section(mut low: f64, mut high: f64, sections: usize, of: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..sections {
        let [inner, outer] = [high - golden * (high - low), low + golden * (high - low)];
        if of(inner) < of(outer) { high = outer } else { low = inner }
    }
    0.5 * (low + high)
}

/// Where `of` has its minimum between `low` and `high`, in the units of both: at the best of `tried` + 1 even points,
/// refined by the golden section between its neighbours. A minimum narrower than the distance of the points may be
/// missed.
///
/// ```
/// // two minima, of which the second is the lower one
/// let found = viscocontact::numeric::minimum(0.0, 10.0, 60, |x: f64| x.cos() - 0.1 * x);
/// assert!((found - 9.525).abs() < 1e-3);
/// ```
pub fn minimum(low: f64, high: f64, tried: usize, of: impl Fn(f64) -> f64) -> f64 {
    const SECTIONS: usize = 50;
    let step = (high - low) / tried as f64;
    let all = (0..=tried).map(|k| low + step * k as f64);
    let best = all.map(|at| (of(at), at)).min_by(|a, b| a.0.total_cmp(&b.0)).map_or(low, |best| best.1);
    golden_section((best - step).max(low), (best + step).min(high), SECTIONS, of)
}
