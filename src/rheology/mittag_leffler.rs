//! The Mittag-Leffler function on the negative real axis.

use mittagleffler::MittagLeffler;

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
    // defined for every α in (0, 1); NaN would be rejected as a compliance
    (-x).mittag_leffler(alpha, 1.0).map_or(f64::NAN, |value| 1.0 - value.re)
}

#[cfg(test)]
mod tests {
    use super::mittag_leffler_rise;
    use std::f64::consts::PI;

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
        for alpha in [1e-3, 0.02, 0.5, 0.99, 0.999] {
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
}
