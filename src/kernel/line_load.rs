//! Influence coefficients of a half-space whose pressure is a wave along one axis, and of one in plane strain.
//!
//! A pressure p(x) cos κy displaces the surface by v(x) cos κy with
//!
//! v(x) = (2/π) ∫ K0(κ |x − s|) p(s) ds,
//!
//! K0 the modified Bessel function, the integral of cos κy / (π √(x² + y²)) over y. For κ = 0 that is a line load,
//! whose displacement is unbounded and needs a datum: at the distance d from the load it is zero,
//!
//! v(x) = −(2/π) ∫ ln(|x − s|/d) p(s) ds   (Johnson, Contact Mechanics, 1985, section 2.3).

use std::f64::consts::{FRAC_2_PI, TAU};

/// Step of the trapezoidal rule for ∫ f(cosh t) dt: the integrand being analytic up to π/2 from the real axis, its
/// error is e^(−π²/step) of the coefficient of a cell on itself.
const STEP: f64 = 0.25;
/// End of the integration, where 1/cosh t is below rounding.
const LAST: f64 = 42.0;
/// e^(−x) underflows for larger x.
const UNDERFLOW: f64 = 745.0;

/// Coefficients of cells of equal length along the axis along which the load varies \[m\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strip {
    /// Length of a cell \[m\].
    pub(crate) side: f64,
    /// Distance from a line load at which the displacement is zero \[m\].
    pub(crate) datum: f64,
}

impl Strip {
    /// The displacement at a distance x from the middle of the cell \[m\], for the wave number `kappa` \[1/m\]: (2/π)
    /// ∫ K0(κ |s|) ds or −(2/π) ∫ ln(s/d) ds over the cell.
    pub(crate) fn at(&self, x: f64, kappa: f64) -> f64 {
        let (a, x) = (0.5 * self.side, x.abs());
        if kappa > 0.0 {
            return match x < a {
                true => on_waves(0.0, kappa * (a - x), kappa) + on_waves(0.0, kappa * (a + x), kappa),
                false => on_waves(kappa * (x - a), kappa * self.side, kappa),
            };
        }
        if x >= self.side {
            // (x + a) ln (x + a) − (x − a) ln (x − a) − 2a, written as 2a ln x and a remainder free of cancellation
            let z = a / x;
            let excess = (1.0 + z) * z.ln_1p() - (1.0 - z) * (-z).ln_1p() - 2.0 * z;
            return -FRAC_2_PI * (self.side * (x / self.datum).ln() + x * series_of_excess(z).unwrap_or(excess));
        }
        let term = |x: f64| if x == 0.0 { 0.0 } else { x * (x.abs() / self.datum).ln() };
        -FRAC_2_PI * (term(x + a) - term(x - a) - self.side)
    }
}

/// (2/π) ∫ K0(κ s) ds over `far` < κs < `far` + `width`, with K0(z) = ∫ e^(−z cosh t) dt over t > 0, integrated over
/// s first.
fn on_waves(far: f64, width: f64, kappa: f64) -> f64 {
    let mut sum = -0.5 * (-far).exp() * (-width).exp_m1();
    for step in 1..=(LAST / STEP) as usize {
        let cosh = (step as f64 * STEP).cosh();
        if far * cosh > UNDERFLOW {
            break;
        }
        sum -= (-far * cosh).exp() * (-width * cosh).exp_m1() / cosh;
    }
    FRAC_2_PI / kappa * STEP * sum
}

/// The mean displacement of a length under a uniform pressure on it, divided by the pressure \[m\].
pub(super) fn uniform(length: f64, datum: f64) -> f64 {
    FRAC_2_PI * length * (1.5 - (length / datum).ln())
}

/// (1 + z) ln(1 + z) − (1 − z) ln(1 − z) − 2z for small z: −z³/3 − z⁵/10 − …, where the closed form cancels.
fn series_of_excess(z: f64) -> Option<f64> {
    // Σ −2 z^(2k+1)/(2k (2k+1)), seven terms: right to rounding for z < 1/16
    (z < 0.0625).then(|| -(1..=7).map(|k| 2.0 * z.powi(2 * k + 1) / f64::from(2 * k * (2 * k + 1))).sum::<f64>())
}

/// The wave number \[1/m\] of the index `k` of a symbol.
pub(crate) fn wave_number(k: usize, period: usize, side: f64) -> f64 {
    TAU * k as f64 / (period as f64 * side)
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;
    use crate::quadrature::GaussLegendre;

    /// ln |s| over the cell by quadrature in pieces that shrink towards the load.
    fn by_quadrature(side: f64, i: usize, f: impl Fn(f64) -> f64) -> f64 {
        let rule = GaussLegendre::new(24);
        let piece = |middle: f64, half: f64| half * rule.sum(|s| f(middle + half * s));
        if i > 0 {
            return piece(i as f64 * side, 0.5 * side);
        }
        // both halves, from the outside in; the last piece is negligible
        (2..120).map(|n| 2.0 * piece(1.5 * side * 0.5_f64.powi(n), 0.5 * side * 0.5_f64.powi(n))).sum()
    }

    /// K0 by its integral with Simpson's rule on e^(−z cosh t).
    fn bessel_k0(z: f64) -> f64 {
        let (steps, last) = (4000, (800.0 / z).max(2.0).acosh());
        let h = last / f64::from(steps);
        let weight = |n: i32| if n == 0 || n == steps { 1.0 } else { f64::from(2 + 2 * (n % 2)) };
        (0..=steps).map(|n| weight(n) * (-z * (f64::from(n) * h).cosh()).exp()).sum::<f64>() * h / 3.0
    }

    #[test]
    fn reference_bessel_function_is_right() {
        // Abramowitz & Stegun, table 9.8
        assert_abs_diff_eq!(bessel_k0(1.0) / 0.421_024_438_240_708_3, 1.0, epsilon = 1e-12);
        assert_abs_diff_eq!(bessel_k0(0.1) / 2.427_069_024_702_017, 1.0, epsilon = 1e-12);
    }

    #[test]
    fn coefficients_are_their_integrals() {
        for (side, datum) in [(1.0, 1.0), (2.0e-6, 1.0e-3), (0.5, 4.0e3)] {
            let strip = Strip { side, datum };
            for i in [0, 1, 2, 5, 17, 40, 1000, 100_000] {
                let exact = -FRAC_2_PI * by_quadrature(side, i, |s| (s / datum).ln());
                let scale = exact.abs().max(1e-3 * side);
                let found = strip.at(i as f64 * side, 0.0);
                assert!((found - exact).abs() < 2e-14 * scale, "{side} {i}: {found} {exact}");
            }
            for kappa in [1e-3 / side, 0.1 / side, 1.0 / side, 3.0 / side] {
                for i in [0, 1, 2, 5, 17] {
                    let exact = FRAC_2_PI * by_quadrature(side, i, |s| bessel_k0(kappa * s));
                    let found = strip.at(i as f64 * side, kappa);
                    let error = (found - exact).abs() / strip.at(0.0, kappa);
                    assert!(error < 1e-12, "{side} {kappa} {i}: {found} {exact}");
                }
            }
        }
    }

    /// Over an infinitely long strip the waves add up to Westergaard's 2/κ.
    #[test]
    fn waves_of_a_strip_add_up_to_westergaards() {
        for kappa in [0.05, 0.3, 2.0, 40.0] {
            let strip = Strip { side: 1.0, datum: 1.0 };
            let sum = strip.at(0.0, kappa) + 2.0 * (1..2000).map(|i| strip.at(f64::from(i), kappa)).sum::<f64>();
            assert!((sum * kappa / 2.0 - 1.0).abs() < 1e-13, "{kappa}: {sum}");
        }
    }

    #[test]
    fn coefficients_add_up_to_a_uniform_pressure() {
        let (cells, strip) = (400, Strip { side: 0.25, datum: 300.0 });
        let row = |i: usize| (0..cells).map(|j: usize| strip.at(i.abs_diff(j) as f64 * strip.side, 0.0)).sum::<f64>();
        let mean = (0..cells).map(row).sum::<f64>() / cells as f64;
        assert_abs_diff_eq!(mean / uniform(100.0, 300.0), 1.0, epsilon = 1e-5);
    }
}
