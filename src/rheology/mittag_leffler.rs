//! The Mittag-Leffler function on the negative real axis.

use std::f64::consts::PI;

use num_complex::Complex64;

/// Spacing of nodes in ln z at which the trapezoidal rule is accurate to rounding: its error is
/// exp(−2π w/h) where the integrand is analytic within the distance w of the axis, here π/2
/// (Trefethen & Weideman, SIAM Review 56, 385, 2014).
const SPACING: f64 = 0.26;
/// Nodes end where the integrand is below exp(−39), which is rounding.
const DECAYED: f64 = 39.0;
/// Above this α the poles of the spectrum are nearer than π/2.
const NEAR_POLES: f64 = 2.0 / 3.0;

/// 1 − E_α(−x) for 0 < α < 1 and x ≥ 0: it rises from 0 to 1.
pub(crate) fn mittag_leffler_rise(alpha: f64, x: f64) -> f64 {
    if x < 0.3 {
        // x/Γ(1 + α) − x²/Γ(1 + 2α) + …, free of the cancellation
        let (mut sum, mut power) = (0.0, x);
        for k in 1..40 {
            let term = power / libm::tgamma(1.0 + alpha * f64::from(k));
            sum += term;
            if term.abs() < 1e-17 * sum {
                break;
            }
            power *= -x;
        }
        return sum;
    }
    if x == f64::INFINITY {
        return 1.0;
    }
    if alpha <= NEAR_POLES { by_angles(alpha, x) } else { by_poles(alpha, x) }
}

/// ∫₀^∞ (1 − e^(−r t)) K(r) dr with t = x^(1/α) and the spectrum K(r) = sin(απ)/π r^(α−1)/(r^(2α) + 2 r^α cos(απ) + 1)
/// (Mainardi, *Fractional Calculus and Waves in Linear Viscoelasticity*, 2010), integrated by parts:
///
/// (1/πα) ∫₀^∞ e^(−z) arg(y + e^(iαπ)) dz, y = z^α/x,
///
/// by the trapezoidal rule in ln z.
fn by_angles(alpha: f64, x: f64) -> f64 {
    let (sin, cos) = (alpha * PI).sin_cos();
    let node = |k: i32| {
        let logarithm = SPACING * f64::from(k);
        let z = logarithm.exp();
        z * (-z).exp() * sin.atan2((alpha * logarithm).exp() / x + cos)
    };
    let last = (DECAYED.ln() / SPACING) as i32 + 1;
    (-(DECAYED / SPACING) as i32..=last).map(node).sum::<f64>() * SPACING / (alpha * PI)
}

/// The same integral, as sin(απ)/π ∫ (1 − e^(−z)) y/(y² + 2 y cos(απ) + 1) d ln z by the trapezoidal
/// rule with nodes on both sides of the maximum of the spectrum, y = 1, and what the two poles at
/// y = −e^(±iαπ), which approach the axis as α → 1, take from the rule: 1 − e^(−z) there over α times
/// 1/(1 + e^(2π w/h)), w their distance.
fn by_poles(alpha: f64, x: f64) -> f64 {
    // sin(απ) and 1 + cos(απ) = 2 sin²(π (1 − α)/2) keep their digits as α → 1
    let sin = ((1.0 - alpha) * PI).sin();
    let rest = 4.0 * (0.5 * (1.0 - alpha) * PI).sin().powi(2);
    let top = x.ln() / alpha;
    let node = |k: i32| {
        let from_top = SPACING * (f64::from(k) + 0.5);
        let y = (alpha * from_top).exp();
        -(-(top + from_top).exp()).exp_m1() * y / ((alpha * from_top).exp_m1().powi(2) + rest * y)
    };
    let nodes = (DECAYED / (alpha * SPACING)) as i32 + 1;
    let sum = (-nodes..nodes).map(node).sum::<f64>() * SPACING * sin / PI;
    let height = PI * (1.0 - alpha) / alpha;
    let at_pole = 1.0 - (-Complex64::from_polar(top.exp(), height)).exp();
    let taken = 2.0 / alpha * at_pole.re / (1.0 + (2.0 * PI * height / SPACING).exp());
    // what exceeds 1 is rounding
    (sum + taken).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫₀^∞ (1 − e^(−r x^(1/α))) K(r) dr, K(r) = sin(απ)/π · r^(α−1)/(r^(2α) + 2 r^α cos(απ) + 1) (e.g. Mainardi,
    /// *Fractional Calculus and Waves in Linear Viscoelasticity*, 2010), by the trapezoidal rule in ln r.
    fn spectral(alpha: f64, x: f64) -> f64 {
        let t = x.powf(1.0 / alpha);
        let h = 1e-3 / alpha;
        let node = |k: i32| {
            let r = (h * f64::from(k)).exp();
            let y = (alpha * h * f64::from(k)).exp();
            -(-r * t).exp_m1() * y / (y * y + 2.0 * y * (alpha * PI).cos() + 1.0)
        };
        (-45_000..=45_000).map(node).sum::<f64>() * h * (alpha * PI).sin() / PI
    }

    #[test]
    fn agrees_with_its_spectrum() {
        for alpha in [0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95] {
            for exponent in -8..=8 {
                let x = 10f64.powf(0.5 * f64::from(exponent));
                let relative = mittag_leffler_rise(alpha, x) / spectral(alpha, x) - 1.0;
                assert!(relative.abs() < 2e-13, "alpha = {alpha}, x = {x:e}: {relative:e}");
            }
        }
    }

    #[test]
    fn the_rise_grows_from_0_to_1_at_all_arguments() {
        for alpha in [1e-3, 0.02, 0.5, 0.7, 0.99, 0.999] {
            assert_eq!(mittag_leffler_rise(alpha, 0.0), 0.0);
            let mut previous = 0.0;
            for exponent in -300..=300 {
                let rise = mittag_leffler_rise(alpha, 10f64.powi(exponent));
                assert!(rise > 0.0 && rise <= 1.0 && rise >= previous * (1.0 - 1e-12), "{alpha} 1e{exponent}: {rise}");
                previous = rise;
            }
            assert!(previous > 1.0 - 1e-15);
        }
    }

    /// E_½(−x) = exp(x²) erfc(x).
    #[test]
    fn one_half_is_the_error_function() {
        for x in [0.3, 0.5, 1.0, 2.0, 3.0, 5.0] {
            let expected = 1.0 - f64::exp(x * x) * libm::erfc(x);
            assert!((mittag_leffler_rise(0.5, x) / expected - 1.0).abs() < 1e-14, "{x}");
        }
    }

    /// The power series, which loses two digits to cancellation up to x = 2, at every α and at the
    /// ends of the three ways to compute the function.
    #[test]
    fn agrees_with_its_series() {
        for alpha in
            [0.3, 0.5, NEAR_POLES, NEAR_POLES + 1e-12, 0.7, 0.8, 0.9, 0.97, 0.99, 0.999, 1.0 - 1e-6, 1.0 - 1e-12]
        {
            for x in [0.29, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0, 1.01, 1.3, 2.0] {
                // 1/Γ is 0 where it underflows
                let term = |k: i32| -f64::powi(-x, k) / libm::tgamma((1.0 + alpha * f64::from(k)).min(170.0));
                let expected: f64 = (1..=300).map(term).sum();
                let off = mittag_leffler_rise(alpha, x) / expected - 1.0;
                assert!(off.abs() < if x < 1.0 || alpha > 0.6 { 1e-13 } else { 1e-9 }, "{alpha} {x} {off:e}");
            }
        }
    }
}
