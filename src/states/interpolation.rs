//! Cubics between states, and roots.

/// Upper limit of the steps of Newton's method.
const MAX_STEPS: usize = 100;

/// The root of a rising function, given with its slope: Newton's steps from the upper end, halved intervals where one
/// leaves the bracket.
pub(super) fn root([mut low, mut high]: [f64; 2], at: impl Fn(f64) -> [f64; 2]) -> f64 {
    let mut s = high;
    for _ in 0..MAX_STEPS {
        let [excess, slope] = at(s);
        if excess > 0.0 {
            high = s
        } else {
            low = s
        }
        let next = s - excess / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - s).abs() <= f64::EPSILON * s.abs().max(1.0) {
            break;
        }
        s = next;
    }
    s
}

/// Cubic with the values `f` and slopes `m` at 0 and 1.
pub(super) fn hermite([f0, f1]: [f64; 2], [m0, m1]: [f64; 2], s: f64) -> f64 {
    let (r, d) = (1.0 - s, f1 - f0);
    f0 + s * d + s * r * (r * (m0 - d) - s * (m1 - d))
}

/// Its slope.
pub(super) fn hermite_slope([f0, f1]: [f64; 2], [m0, m1]: [f64; 2], s: f64) -> f64 {
    let (r, d) = (1.0 - s, f1 - f0);
    d + (r - s) * (r * (m0 - d) - s * (m1 - d)) - s * r * (m0 + m1 - 2.0 * d)
}
