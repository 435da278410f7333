//! Tests of residuals.

use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// Least and maximum value.
pub(crate) fn range(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| [low.min(value), high.max(value)])
}

/// Sum of squares.
pub(crate) fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// Arithmetic mean.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// So many means of neighbouring values.
pub(crate) fn means(values: &[f64], count: usize) -> Vec<f64> {
    (0..count).map(|k| mean(&values[k * values.len() / count..(k + 1) * values.len() / count])).collect()
}

/// Standard deviation of the noise of some data, from second differences.
pub(crate) fn scatter(data: &[f64]) -> f64 {
    let differences = data.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2));
    (differences.sum::<f64>() / (6.0 * data.len().saturating_sub(2).max(1) as f64)).sqrt()
}

/// Whether the variance of some data is above the square of their scatter by so little that both are the same of white noise, by six
/// deviations of their ratio (J. von Neumann, 1941).
pub(crate) fn is_flat(data: &[f64]) -> bool {
    let mean = mean(data);
    let squares: f64 = data.iter().map(|value| (value - mean).powi(2)).sum();
    let count = data.len() as f64;
    squares <= (count + 11.0 * count.sqrt()) * scatter(data).powi(2)
}

/// Intercept, if there is one, slope and sum of squares of the line through some points.
pub(crate) fn line(x: &[f64], y: &[f64], has_intercept: bool) -> [f64; 3] {
    let [mean_x, mean_y] = if has_intercept { [mean(x), mean(y)] } else { [0.0; 2] };
    let offsets = || x.iter().zip(y).map(|(x, y)| [x - mean_x, y - mean_y]);
    let [xx, xy] = offsets().fold([0.0; 2], |[xx, xy], [x, y]| [xx + x * x, xy + x * y]);
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    [mean_y - slope * mean_x, slope, offsets().map(|[x, y]| (y - slope * x).powi(2)).sum()]
}

/// Probability that independent residuals have as great a sum of squared correlations up to a lag (Ljung & Box 1978), of which `fitted` were
/// fitted, over curves.
pub(crate) fn correlation_test(curves: &[Vec<f64>], fitted: usize) -> f64 {
    let (mut statistic, mut freedom) = (0.0, 0.0);
    for residuals in curves.iter().filter(|residuals| square(residuals) > 0.0) {
        let (count, square) = (residuals.len(), square(residuals));
        let lags = 20.min(count / 5);
        for lag in 1..=lags {
            let product: f64 = residuals.iter().zip(&residuals[lag..]).map(|(a, b)| a * b).sum();
            let correlation = product / square;
            statistic += (count * (count + 2)) as f64 * correlation * correlation / (count - lag) as f64;
        }
        freedom += lags as f64;
    }
    freedom -= fitted as f64;
    ChiSquared::new(freedom).map_or(1.0, |law| law.sf(statistic))
}

/// Half the width of a two-sided interval of this `confidence`, in standard deviations estimated with `freedom` degrees.
pub(crate) fn student(confidence: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |law| law.inverse_cdf(0.5 + 0.5 * confidence))
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
        let correlations = (0..1000).filter(|&seed| correlation_test(&[independent(seed)], 0) < 0.05).count();
        assert!((30..=76).contains(&correlations), "{correlations}");
    }

    #[test]
    fn correlated_residuals_fail() {
        for seed in 0..20 {
            let mut residuals = independent(seed);
            for k in 1..residuals.len() {
                residuals[k] += 0.5 * residuals[k - 1];
            }
            assert!(correlation_test(&[residuals], 0) < 1e-3);
        }
    }

    #[test]
    fn quantiles_are_those_of_tables() {
        assert!((student(0.95, 10.0) - 2.2281).abs() < 1e-4);
        // the square is that of the F distribution of 1 and 10 degrees
        assert!((student(0.95, 10.0).powi(2) - 4.9646).abs() < 1e-3);
    }
}
