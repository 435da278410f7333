//! Noise of the force, and data made white.

/// Minimum and maximum autoregressive coefficient that is looked for.
pub(crate) const CORRELATIONS: [f64; 2] = [-0.9, 0.995];

/// The noise of the measured forces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Noise {
    /// Independent from sample to sample, with an unknown standard deviation of each curve.
    #[default]
    White,
    /// Each deviation is φ times the one before plus an independent part: amplifiers, filters, thermal motion of a
    /// cantilever. φ of each curve is the one of the maximum restricted likelihood of the residuals. Where that is clearly likelier, the independent
    /// parts have a long memory, too, as pink noise has: their spectrum grows as a power −2d of the frequency towards 0 ([`Fit::memory_of`](crate::Fit::memory_of)).
    Autoregressive,
    /// Autoregressive with a known φ, between −1 and 1.
    AutoregressiveWith(f64),
}

/// Makes the noise of one curve white: r ↦ L⁻¹ r where L Lᵀ is the covariance, up to a factor. First-order autoregressive noise of parts with a fractional
/// memory (C. W. J. Granger & R. Joyeux, J. Time Ser. Anal. 1, 1980); white if both are 0.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Whitening {
    /// The coefficient φ.
    pub(crate) phi: f64,
    /// The order d of the difference (1 − L)ᵈ that makes the parts independent.
    pub(crate) memory: f64,
}

impl Whitening {
    /// Makes a column white in place.
    pub(crate) fn apply(&self, column: &mut [f64]) {
        difference(column, self.memory);
        for k in (1..column.len()).rev() {
            column[k] -= self.phi * column[k - 1];
        }
        if let Some(first) = column.first_mut() {
            *first *= (1.0 - self.phi * self.phi).sqrt();
        }
    }

    /// −ln of the determinant of the covariance, up to the factor σ².
    pub(crate) fn log_weight(&self) -> f64 {
        (1.0 - self.phi * self.phi).ln()
    }
}

/// The fractional difference (1 − L)ᵈ of a column in place, of which nothing was before the first value.
pub(crate) fn difference(column: &mut [f64], order: f64) {
    if order == 0.0 {
        return;
    }
    let factor = |last: &mut f64, k: usize| {
        *last *= (k as f64 - order) / (k + 1) as f64;
        Some(*last)
    };
    let factors: Vec<f64> = (0..column.len()).scan(1.0, factor).collect();
    for k in (1..column.len()).rev() {
        let past = column[..k].iter().rev().zip(&factors).map(|(value, factor)| value * factor).sum::<f64>();
        column[k] += past;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitening_inverts_the_covariance() {
        // L⁻¹ C L⁻ᵀ = 1 of the covariance C = φ^|i−j|/(1 − φ²) of an autoregressive process
        let (phi, len) = (0.6_f64, 7_usize);
        let whitening = Whitening { phi, memory: 0.0 };
        let entry = |i: usize, j: usize| phi.powi(i.abs_diff(j) as i32) / (1.0 - phi * phi);
        let mut rows: Vec<Vec<f64>> = (0..len).map(|i| (0..len).map(|j| entry(i, j)).collect()).collect();
        for _ in 0..2 {
            rows.iter_mut().for_each(|row| whitening.apply(row));
            rows = (0..len).map(|i| (0..len).map(|j| rows[j][i]).collect()).collect();
        }
        let is_one = |i: usize, j: usize| (rows[i][j] - f64::from(u8::from(i == j))).abs() < 1e-14;
        assert!((0..len * len).all(|k| is_one(k / len, k % len)), "{rows:?}");
    }

    #[test]
    fn two_half_differences_are_a_difference() {
        let mut column: Vec<f64> = (0..50).map(|k| f64::from(k * k % 17)).collect();
        let whole: Vec<f64> = (0..50).map(|k| column[k] - if k > 0 { column[k - 1] } else { 0.0 }).collect();
        (0..2).for_each(|_| difference(&mut column, 0.5));
        assert!(column.iter().zip(&whole).all(|(a, b)| (a - b).abs() < 1e-12), "{column:?}");
    }
}
