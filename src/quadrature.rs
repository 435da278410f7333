//! Gauss–Legendre quadrature and bisection, used by the influence coefficients and the reference solutions.

use std::f64::consts::PI;

/// A Gauss–Legendre rule on [−1, 1].
#[derive(Debug, Clone)]
pub(crate) struct GaussLegendre {
    /// Nodes and weights.
    points: Vec<(f64, f64)>,
}

impl GaussLegendre {
    /// The rule with `n` points, exact for polynomials of degree 2n − 1; nodes by Newton's method on
    /// the three-term recurrence from the usual cosine guess.
    pub(crate) fn new(n: usize) -> GaussLegendre {
        let points = (0..n)
            .map(|k| {
                let mut x = (PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
                for _ in 0..8 {
                    let (value, slope) = legendre(n, x);
                    x -= value / slope;
                }
                if 2 * k + 1 == n {
                    x = 0.0;
                }
                let slope = legendre(n, x).1;
                (x, 2.0 / ((1.0 - x) * (1.0 + x) * slope * slope))
            })
            .collect();
        GaussLegendre { points }
    }

    /// Nodes and weights.
    pub(crate) fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Σ w_k f(x_k): the integral of `f` over [−1, 1].
    pub(crate) fn sum(&self, mut f: impl FnMut(f64) -> f64) -> f64 {
        self.points.iter().map(|&(x, w)| w * f(x)).sum()
    }

    /// The integral of `f` over [from, to].
    pub(crate) fn integrate(&self, from: f64, to: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        half * self.sum(|s| f(middle + half * s))
    }
}

/// The ends of the interval between `low` and `high` at which `is_below` turns false, after so many halvings.
pub(crate) fn bisect(low: f64, high: f64, halvings: usize, is_below: impl Fn(f64) -> bool) -> [f64; 2] {
    (0..halvings).fold([low, high], |[low, high], _| {
        let middle = 0.5 * (low + high);
        if is_below(middle) { [middle, high] } else { [low, middle] }
    })
}

/// Legendre polynomial of degree `n` and its derivative at `x` inside (−1, 1).
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for k in 1..n {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0));
    }
    (value, n as f64 * (x * value - before) / ((x - 1.0) * (x + 1.0)))
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    #[test]
    fn rules_are_exact_to_their_degree_and_no_further() {
        for n in [1_usize, 2, 3, 8, 24, 40] {
            let rule = GaussLegendre::new(n);
            let moment = |k: usize| rule.sum(|x| x.powi(k as i32));
            for k in 0..2 * n {
                let exact = if k % 2 == 0 { 2.0 / (k as f64 + 1.0) } else { 0.0 };
                assert!((moment(k) - exact).abs() < 1e-15 * 4.0, "n = {n}, degree {k}: {:e}", moment(k) - exact);
            }
            if n <= 8 {
                assert!((moment(2 * n) - 2.0 / (2.0 * n as f64 + 1.0)).abs() > 1e-6 / 4_f64.powi(n as i32));
            }
        }
    }

    #[test]
    fn integrals_over_any_interval_are_exact() {
        let rule = GaussLegendre::new(16);
        assert_abs_diff_eq!(rule.integrate(1.0, 3.0, |x| 1.0 / x), 3_f64.ln(), epsilon = 1e-14);
    }
}
