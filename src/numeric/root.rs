//! Roots of a function of one number.

/// The root of a rising function between the lower and the upper end of a bracket. The function gives its value and
/// its slope. Where it has no root there, the end at which it is nearer to zero; where its value is NaN, NaN.
///
/// Newton's steps start `from` a number of the bracket. The bracket is halved where a step leaves it, or where the
/// last step did not halve the value. The search ends with a step shorter than `tolerance`, relative to the greater
/// of the root and 1.
///
/// ```
/// let found = viscocontact::numeric::root([0.0, 2.0], 2.0, 1e-8, |x| [x * x - 2.0, 2.0 * x]);
/// assert!((found - 2f64.sqrt()).abs() < 1e-15);
/// ```
pub fn root(bracket: [f64; 2], from: f64, tolerance: f64, mut at: impl FnMut(f64) -> [f64; 2]) -> f64 {
    let bracket = bracket.map(|end| end.clamp(f64::MIN, f64::MAX));
    let ([mut low, mut high], mut s, mut last) = (bracket, from, f64::INFINITY);
    loop {
        let [excess, slope] = at(s);
        if excess.is_nan() {
            return f64::NAN;
        }
        if excess > 0.0 {
            high = s
        } else {
            low = s
        }
        let (newton, middle) = (s - excess / slope, 0.5 * low + 0.5 * high);
        let is_near = |next: f64| (next - s).abs() <= tolerance * s.abs().max(1.0);
        if is_near(newton) || is_near(middle) {
            let ends = [(low, bracket[0]), (high, bracket[1])];
            let halved = ends.iter().find(|(at, end)| at == end).map_or(middle, |(at, _)| *at);
            return if is_near(newton) { newton.clamp(low, high) } else { halved };
        }
        let converges = newton > low && newton < high && excess.abs() <= 0.5 * last;
        (s, last) = (if converges { newton } else { middle }, excess.abs());
    }
}

#[cfg(test)]
mod tests {
    use super::root;

    #[test]
    fn brackets_may_be_endless() {
        let square = |x: f64| [x * x - 2.0, 2.0 * x];
        assert!((root([0.0, f64::INFINITY], 0.0, 1e-8, square) - 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(root([f64::NEG_INFINITY, f64::INFINITY], 1.0, 1e-8, |_| [-1.0, 0.0]), f64::MAX);
    }
}
