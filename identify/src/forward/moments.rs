//! Exact integrals of exponentials over one interval.

use crate::forward::real::Real;

/// A sum of exponentials over intervals of one length: what they decay by, and their moments.
///
/// The moments of ξ^k, k = 0, 1, 2, under exp(−a (1 − ξ)) over 0 < ξ < 1 with a = rate × length.
#[derive(Clone, Debug, Default)]
pub(super) struct Moments<const N: usize> {
    length: Real<N>,
    pub(super) decay: Vec<Real<N>>,
    pub(super) moments: Vec<[Real<N>; 3]>,
}

/// Intervals whose lengths differ by less than this fraction are equal: equal samples have times that are rounded.
const EQUAL: f64 = 1e-10;

impl<const N: usize> Moments<N> {
    /// Computes the moments for another length of the interval. The length of an interval between samples is `fixed`: it depends
    /// on no parameter.
    pub(super) fn set(&mut self, length: Real<N>, fixed: bool, rates: &[Real<N>]) {
        let equal = (length.value() - self.length.value()).abs() <= EQUAL * length.value();
        if fixed && equal && self.decay.len() == rates.len() {
            return;
        }
        // an interval whose length depends on parameters is never reused
        self.length = if fixed { length } else { Real::from(f64::NAN) };
        self.decay.resize(rates.len(), length);
        self.moments.resize(rates.len(), [length; 3]);
        for (&rate, (decay, own)) in rates.iter().zip(self.decay.iter_mut().zip(&mut self.moments)) {
            let a = rate * length;
            let (value, of_a) = moments(a.value());
            *decay = a.mapped(value, -value);
            // dMₖ/da = Mₖ₊₁ − Mₖ
            for (k, moment) in own.iter_mut().enumerate() {
                *moment = a.mapped(of_a[k], of_a[k + 1] - of_a[k]);
            }
        }
    }
}

/// exp(−a), and the moments of ξ⁰ … ξ³ under exp(−a (1 − ξ)).
fn moments(a: f64) -> (f64, [f64; 4]) {
    if a > 1.0 {
        let decay = (-a).exp();
        let zeroth = (1.0 - decay) / a;
        let first = (1.0 - zeroth) / a;
        let second = (1.0 - 2.0 * first) / a;
        return (decay, [zeroth, first, second, (1.0 - 3.0 * second) / a]);
    }
    // M₃ = 6 Σ (−a)^j/(j + 4)! = ¼ (1 − a/5 (1 − a/6 (…))), and downward from there, where the recursion loses no digits
    let terms = if a < 0.02 { 7 } else { 16 };
    let third = (5..5 + terms).rev().fold(1.0, |sum, k| 1.0 - a / f64::from(k) * sum) / 4.0;
    let second = (1.0 - a * third) / 3.0;
    let first = 0.5 * (1.0 - a * second);
    let zeroth = 1.0 - a * first;
    (1.0 - a * zeroth, [zeroth, first, second, third])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_agree_with_a_fine_sum() {
        for a in [0.0, 1e-9, 0.3, 0.999_999, 1.000_001, 7.0, 300.0] {
            let nodes = 200_000;
            for (power, moment) in moments(a).1.into_iter().enumerate() {
                let sum: f64 = (0..nodes)
                    .map(|k| (f64::from(k) + 0.5) / f64::from(nodes))
                    .map(|x| x.powi(power as i32) * (-a * (1.0 - x)).exp())
                    .sum::<f64>()
                    / f64::from(nodes);
                assert!((moment / sum - 1.0).abs() < 1e-6, "a {a}, power {power}: {moment} {sum}");
            }
        }
    }
}
