//! Love's closed form (A. E. H. Love, Phil. Trans. R. Soc. A 228, 1929).

use std::f64::consts::PI;

/// The displacement at a distance from the middle of a rectangle under unit pressure, over the contact compliance.
pub fn love(x: [f64; 2], side: [f64; 2]) -> f64 {
    let corner = |x: f64, y: f64| {
        let term = |x: f64, y: f64| if x == 0.0 { 0.0 } else { x * (y / x.abs()).asinh() };
        term(x, y) + term(y, x)
    };
    let [a, b] = [0.5 * side[0], 0.5 * side[1]];
    let sum = corner(x[0] + a, x[1] + b) - corner(x[0] - a, x[1] + b) - corner(x[0] + a, x[1] - b)
        + corner(x[0] - a, x[1] - b);
    sum / PI
}
