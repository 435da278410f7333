//! The relaxation of a fractional element as a sum of exponentials.

use std::f64::consts::PI;

use viscocontact::numeric::root;

/// −ln of the least share of a spectrum that is summed, and the spacing of its nodes: the trapezoidal rule errs by exp(−π²/spacing), below 1e-8.
const LEAST_SHARE: f64 = 23.0;
const NODES: f64 = 0.5;

/// The spectrum of E_α(−t^α) over y = ln(rate), of area 1: sin(πα)/2π/(cosh αy + cos πα) (Gorenflo & Mainardi 1997). With
/// c = sin(π(1 − α)/2) and s = cos(π(1 − α)/2) this is s c/2π/(sinh²(αy/2) + c²).
fn density(alpha: f64, y: f64) -> f64 {
    let (c, s) = (0.5 * PI * (1.0 - alpha)).sin_cos();
    s * c / (2.0 * PI * ((0.5 * alpha * y).sinh().powi(2) + c * c))
}

/// Its area below y < 0.
fn share(alpha: f64, y: f64) -> f64 {
    let (c, s) = (0.5 * PI * (1.0 - alpha)).sin_cos();
    // 1/2 + atan(tanh(αy/2) s/c)/πα, free of the cancellation
    let u = (0.5 * alpha * y).tanh();
    let rest = 2.0 * (alpha * y).exp() / (1.0 + (alpha * y).exp());
    // atan(s/c) + atan(u s/c) = atan of (s/c)(1 + u)/(1 − u s²/c²)
    (s / c * rest).atan2(1.0 - u * s * s / (c * c)) / (PI * alpha)
}

/// Moduli and rates of E_α(−t^α) at times that rates between two, given by their logarithms, show: a sum by the trapezoidal rule in v = y + asinh(y/b), where ±ib are the poles: the spectrum is
/// as smooth in v for α → 1, where the peak is narrow, as for α → 0, where it is wide. (The Mittag-Leffler function of the main crate takes a
/// hundred times as long.)
pub(crate) fn spectrum(alpha: f64, [slowest, fastest]: [f64; 2]) -> Vec<(f64, f64)> {
    let width = PI * (1.0 - alpha) / alpha;
    let v = |y: f64| y + (y / width).asinh();
    let reach = LEAST_SHARE / alpha;
    let first = (slowest - LEAST_SHARE).clamp(-reach, -LEAST_SHARE);
    let last = (fastest + LEAST_SHARE).clamp(1.0, reach);
    let y = |v_k: f64| {
        let distance = |y: f64| [v(y) - v_k.abs(), 1.0 + 1.0 / y.hypot(width)];
        // from the side of 0, where v is steepest
        v_k.signum() * root([0.0, v_k.abs()], v_k.abs() * width / (1.0 + width), 1e-15, distance)
    };
    let [from, to] = [first, last].map(|end| (v(end) / NODES).round() as i64);
    let node = |k: i64| {
        let y = y(k as f64 * NODES);
        (y, NODES / (1.0 + 1.0 / y.hypot(width)))
    };
    // the sum below the first node: the midpoint rule, with its first correction h² f′/24
    let (y, h) = node(from);
    let [near, far] = [y.abs(), y.abs() + h].map(|y| density(alpha, y));
    let below = share(alpha, -y.abs() - 0.5 * h) + h * (far - near) / 24.0;
    let terms = (from..=to).map(node).map(|(y, h)| (h * density(alpha, y), y.exp()));
    std::iter::once((below, 0.0)).chain(terms).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use viscocontact::rheology::{FractionalZener, Rheology};

    #[test]
    fn the_fractional_solid_has_closed_forms() {
        // E_½(−√x) = exp(x) erfc(√x)
        let prony = Model::FractionalZener.prony(&[3.0, 1.0, 2.0, 0.5], [1e-3, 100.0]).unwrap();
        for t in [1e-3_f64, 0.1, 2.0, 50.0] {
            let exact = 1.0 + 2.0 * (0.5 * t).exp() * libm::erfc((0.5 * t).sqrt());
            assert!((prony.modulus(t) / exact - 1.0).abs() < 1e-6, "t {t}: {} {exact}", prony.modulus(t));
        }
        // near 1 it is the standard solid
        let near = Model::FractionalZener.prony(&[3.0, 1.0, 2.0, 0.98], [1e-3, 100.0]).unwrap();
        assert!((near.modulus(1.0) / Model::Zener.modulus(&[3.0, 1.0, 2.0], 1.0).unwrap() - 1.0).abs() < 0.02);
    }

    /// The Mittag-Leffler function of the main crate is another algorithm: 1 + [1 − E_α(−t^α)] is the compliance of unit moduli.
    #[test]
    fn the_fractional_solid_is_the_mittag_leffler_function_at_any_exponent() {
        for alpha in [1e-9, 1e-5, 1e-3, 0.01, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999, 1.0 - 1e-9] {
            let exact = FractionalZener::new(1.0, 1.0, 1.0, alpha).unwrap();
            for tau in [1e-4, 0.3, 50.0, 1e5] {
                let prony = Model::FractionalZener.prony(&[2.0, 1.0, tau, alpha], [1e-3, 100.0]).unwrap();
                assert!(prony.moduli.len() < 40, "{alpha}: {} terms", prony.moduli.len());
                for t in [1e-3, 0.1, 2.0, 50.0, 100.0] {
                    let exact = 3.0 - exact.creep_compliance(t / tau);
                    let error = (prony.modulus(t) / exact - 1.0).abs();
                    assert!(error < 1e-6, "α = {alpha}, τ = {tau}, t = {t}: {} {exact}", prony.modulus(t));
                }
            }
        }
    }

    /// Times that no data show took millions of nodes once, and all memory.
    #[test]
    fn times_far_from_the_data_have_few_nodes() {
        for tau in [1e-280, 1e-100, 1e100, f64::MAX] {
            for alpha in [1e-5, 0.02, 0.3, 0.98] {
                let shown = [1e-3, 1e3].map(|rate: f64| rate.ln() + tau.ln());
                assert!(spectrum(alpha, shown).len() < 4000, "{tau} {alpha}");
                let prony = Model::FractionalZener.prony(&[3.0, 1.0, tau, alpha], [1e-3, 10.0]).unwrap();
                let exact = 5.0 - 2.0 * FractionalZener::new(1.0, 1.0, 1.0, alpha).unwrap().creep_compliance(1.0 / tau);
                assert!(prony.moduli.len() < 40);
                assert!(
                    (prony.modulus(1.0) / exact - 1.0).abs() < 1e-6,
                    "{tau:e} {alpha}: {} {exact}",
                    prony.modulus(1.0)
                );
            }
        }
    }
}
