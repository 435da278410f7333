//! Exact integrals of exponentials over one interval.

/// A sum of exponentials over intervals of one length: what they decay by, and their moments.
///
/// The moments of ξ^k, k = 0, 1, 2, under exp(−a (1 − ξ)) over 0 < ξ < 1 with a = rate × length.
#[derive(Clone, Debug, Default)]
pub(super) struct Moments {
    length: f64,
    pub(super) decay: Vec<f64>,
    pub(super) moments: Vec<[f64; 3]>,
}

/// Intervals whose lengths differ by less than this fraction are equal: equal samples have times that are rounded.
const EQUAL: f64 = 1e-10;

impl Moments {
    /// Computes the moments for another length of the interval.
    pub(super) fn set(&mut self, length: f64, rates: &[f64]) {
        if (length - self.length).abs() <= EQUAL * length && self.decay.len() == rates.len() {
            return;
        }
        self.length = length;
        self.decay.clear();
        self.moments.clear();
        for rate in rates {
            self.decay.push((-rate * length).exp());
            self.moments.push(moments(rate * length));
        }
    }
}

/// Moments of ξ⁰, ξ¹, ξ² under exp(−a (1 − ξ)).
fn moments(a: f64) -> [f64; 3] {
    if a > 1.0 {
        let zeroth = -(-a).exp_m1() / a;
        let first = (1.0 - zeroth) / a;
        return [zeroth, first, (1.0 - 2.0 * first) / a];
    }
    // M₂ = 2 Σ (−a)^j/(j + 3)!, and downward from there, where the recursion loses no digits
    let (mut second, mut term) = (0.0, 1.0 / 3.0);
    for j in 0..16 {
        second += term;
        term *= -a / f64::from(j + 4);
    }
    let first = 0.5 * (1.0 - a * second);
    [1.0 - a * first, first, second]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_agree_with_a_fine_sum() {
        for a in [0.0, 1e-9, 0.3, 0.999_999, 1.000_001, 7.0, 300.0] {
            let nodes = 200_000;
            for (power, moment) in moments(a).into_iter().enumerate() {
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
