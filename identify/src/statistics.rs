//! Tests of residuals.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// A test of residuals: how far they are from independent ones.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ResidualTest {
    /// The statistic: a standard normal variable of runs, a χ² of correlations.
    pub statistic: f64,
    /// Probability of a value as extreme if the residuals are independent.
    pub probability: f64,
}

/// Number of runs of one sign (Wald & Wolfowitz 1940), over curves; few runs mean a misfit.
pub(crate) fn runs_test(curves: &[Vec<f64>]) -> ResidualTest {
    let (mut deviation, mut variance) = (0.0, 0.0);
    for residuals in curves {
        let above = residuals.iter().filter(|r| **r > 0.0).count() as f64;
        let total = residuals.len() as f64;
        let below = total - above;
        let runs = 1 + residuals.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count();
        let expected = 2.0 * above * below / total + 1.0;
        deviation += runs as f64 - expected;
        variance += (expected - 1.0) * (expected - 2.0) / (total - 1.0);
    }
    let statistic = if variance > 0.0 { deviation / variance.sqrt() } else { 0.0 };
    ResidualTest { statistic, probability: 2.0 * normal_below(-statistic.abs()) }
}

/// The sum of squared correlations up to a lag (Ljung & Box 1978), of which `fitted` were fitted, over curves.
pub(crate) fn correlation_test(curves: &[Vec<f64>], fitted: usize) -> ResidualTest {
    let (mut statistic, mut freedom) = (0.0, 0.0);
    for residuals in curves {
        let count = residuals.len();
        let lags = 20.min(count / 5);
        let square: f64 = residuals.iter().map(|r| r * r).sum();
        if square == 0.0 {
            continue;
        }
        for lag in 1..=lags {
            let product: f64 = residuals.iter().zip(&residuals[lag..]).map(|(a, b)| a * b).sum();
            let correlation = product / square;
            statistic += (count * (count + 2)) as f64 * correlation * correlation / (count - lag) as f64;
        }
        freedom += lags as f64;
    }
    freedom -= fitted as f64;
    let probability = ChiSquared::new(freedom).map_or(1.0, |law| law.sf(statistic));
    ResidualTest { statistic, probability }
}

/// P(x < value) of a standard normal variable.
pub(crate) fn normal_below(value: f64) -> f64 {
    Normal::standard().cdf(value)
}

/// Half the width of a two-sided interval of this `confidence`, in standard deviations estimated with `freedom` degrees.
pub(crate) fn student(confidence: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |law| law.inverse_cdf(0.5 + 0.5 * confidence))
}

/// Quantile of the F distribution of 1 and `freedom` degrees.
pub(crate) fn fisher(confidence: f64, freedom: f64) -> f64 {
    FisherSnedecor::new(1.0, freedom).map_or(f64::INFINITY, |law| law.inverse_cdf(confidence))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    fn independent(seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..400).map(|_| (0..12).map(|_| random.next_u32() as f64 / 2.0_f64.powi(32)).sum::<f64>() - 6.0).collect()
    }

    #[test]
    fn independent_residuals_pass_as_often_as_they_should() {
        let failures = |test: &dyn Fn(&[Vec<f64>]) -> ResidualTest| {
            (0..1000).filter(|&seed| test(&[independent(seed)]).probability < 0.05).count()
        };
        let (runs, correlations) = (failures(&runs_test), failures(&|r| correlation_test(r, 0)));
        assert!((30..=72).contains(&runs) && (30..=76).contains(&correlations), "{runs} {correlations}");
    }

    #[test]
    fn correlated_residuals_fail() {
        for seed in 0..20 {
            let mut residuals = independent(seed);
            for k in 1..residuals.len() {
                residuals[k] += 0.5 * residuals[k - 1];
            }
            assert!(runs_test(&[residuals.clone()]).probability < 1e-3);
            assert!(correlation_test(&[residuals], 0).probability < 1e-3);
        }
    }

    #[test]
    fn quantiles_are_those_of_tables() {
        assert!((student(0.95, 10.0) - 2.2281).abs() < 1e-4);
        assert!((fisher(0.95, 10.0) - 4.9646).abs() < 1e-3);
    }
}
