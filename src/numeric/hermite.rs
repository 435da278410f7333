//! Cubics between nodes.

/// Cubic with these values and slopes at 0 and 1.
pub fn hermite(values: [f64; 2], slopes: [f64; 2], s: f64) -> f64 {
    let ([f0, f1], [m0, m1], r) = (values, slopes, 1.0 - s);
    let d = f1 - f0;
    f0 + s * d + s * r * (r * (m0 - d) - s * (m1 - d))
}

/// Its slope.
pub fn hermite_slope(values: [f64; 2], slopes: [f64; 2], s: f64) -> f64 {
    let ([f0, f1], [m0, m1], r) = (values, slopes, 1.0 - s);
    let d = f1 - f0;
    d + (r - s) * (r * (m0 - d) - s * (m1 - d)) - s * r * (m0 + m1 - 2.0 * d)
}
