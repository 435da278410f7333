//! Noise of the force, and data made white.

use faer::{Mat, Side};

use crate::error::{Error, Result, same_length, within};

/// Least and greatest autoregressive coefficient that is looked for.
pub(crate) const CORRELATIONS: [f64; 2] = [-0.9, 0.995];

/// The noise of the measured forces.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Noise {
    /// Independent from sample to sample, with an unknown standard deviation of each curve.
    #[default]
    White,
    /// Each deviation is φ times the one before plus an independent part: amplifiers, filters, thermal motion of a
    /// cantilever. φ of each curve is the one of the greatest restricted likelihood of the residuals. Where that is clearly likelier, the independent
    /// parts have a long memory, too, as pink noise has: their spectrum grows as a power −2d of the frequency towards 0 ([`Fit::memory_of`](crate::Fit::memory_of)).
    Autoregressive,
    /// Autoregressive with a known φ, between −1 and 1.
    AutoregressiveWith(f64),
    /// The covariance matrix of the forces of each curve \[N²\], by rows.
    Covariance(Vec<Vec<f64>>),
}

impl Noise {
    /// Refuses covariance matrices of another number of curves.
    pub(crate) fn suits(&self, curves: usize) -> Result<()> {
        if let Noise::Covariance(all) = self { same_length("covariance matrices", all.len(), curves) } else { Ok(()) }
    }
}

/// Makes the noise of one curve white: r ↦ L⁻¹ r where L Lᵀ is the covariance, up to a factor.
#[derive(Clone, Debug)]
pub(crate) enum Whitening {
    /// First-order autoregressive noise of parts with a fractional memory (C. W. J. Granger & R. Joyeux, J. Time Ser. Anal. 1, 1980); white if both are 0.
    Autoregressive {
        /// The coefficient φ.
        phi: f64,
        /// The order d of the difference (1 − L)ᵈ that makes the parts independent.
        memory: f64,
    },
    /// By the Cholesky factor.
    Factor(Mat<f64>),
}

impl Whitening {
    /// Of white noise.
    pub(crate) const NONE: Whitening = Whitening::Autoregressive { phi: 0.0, memory: 0.0 };

    pub(crate) fn of(noise: &Noise, curve: usize, len: usize) -> Result<Whitening> {
        match noise {
            Noise::White | Noise::Autoregressive => Ok(Whitening::NONE),
            &Noise::AutoregressiveWith(phi) => {
                within("autoregressive coefficient", phi, phi.abs() < 1.0, "between -1 and 1")?;
                Ok(Whitening::Autoregressive { phi, memory: 0.0 })
            }
            Noise::Covariance(matrices) => {
                let matrix = matrices.get(curve).map_or(&[][..], |matrix| matrix);
                same_length("covariance", matrix.len(), len * len)?;
                let reason = "the covariance of the noise is not positive definite: give variances on its diagonal";
                let singular = |_| Error::NotConverged { iterations: 0, reason };
                let matrix = Mat::from_fn(len, len, |i, j| matrix[i * len + j]);
                Ok(Whitening::Factor(matrix.llt(Side::Lower).map_err(singular)?.L().to_owned()))
            }
        }
    }

    /// Makes a column white in place.
    pub(crate) fn apply(&self, column: &mut [f64]) {
        match self {
            &Whitening::Autoregressive { phi, memory } => {
                difference(column, memory);
                if phi == 0.0 {
                    return;
                }
                for k in (1..column.len()).rev() {
                    column[k] -= phi * column[k - 1];
                }
                if let Some(first) = column.first_mut() {
                    *first *= (1.0 - phi * phi).sqrt();
                }
            }
            Whitening::Factor(factor) => {
                for i in 0..column.len() {
                    let known: f64 = (0..i).map(|j| factor[(i, j)] * column[j]).sum();
                    column[i] = (column[i] - known) / factor[(i, i)];
                }
            }
        }
    }

    /// The autoregressive coefficient, if there is one.
    pub(crate) fn correlation(&self) -> Option<f64> {
        match self {
            Whitening::Autoregressive { phi, .. } if *phi != 0.0 => Some(*phi),
            _ => None,
        }
    }

    /// The order of the memory.
    pub(crate) fn memory(&self) -> f64 {
        if let Whitening::Autoregressive { memory, .. } = self { *memory } else { 0.0 }
    }

    /// −ln of the determinant of the covariance, up to the factor σ².
    pub(crate) fn log_weight(&self) -> f64 {
        match self {
            Whitening::Autoregressive { phi, .. } => (1.0 - phi * phi).ln(),
            Whitening::Factor(factor) => -2.0 * (0..factor.nrows()).map(|i| factor[(i, i)].ln()).sum::<f64>(),
        }
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
        // covariance φ^|i−j|/(1 − φ²) of an autoregressive process, both ways
        let (phi, len) = (0.6_f64, 7_usize);
        let matrix: Vec<f64> =
            (0..len * len).map(|k| phi.powi((k / len).abs_diff(k % len) as i32) / (1.0 - phi * phi)).collect();
        let noise = Noise::Covariance(vec![matrix]);
        for k in 0..len {
            let mut one = vec![0.0; len];
            one[k] = 1.0;
            let mut other = one.clone();
            Whitening::of(&noise, 0, len).unwrap().apply(&mut one);
            Whitening::Autoregressive { phi, memory: 0.0 }.apply(&mut other);
            assert!(one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-14), "{one:?} {other:?}");
        }
        let given = Whitening::of(&noise, 0, len).unwrap().log_weight();
        assert!((given - Whitening::Autoregressive { phi, memory: 0.0 }.log_weight()).abs() < 1e-12);
    }

    #[test]
    fn two_half_differences_are_a_difference() {
        let mut column: Vec<f64> = (0..50).map(|k| f64::from(k * k % 17)).collect();
        let whole: Vec<f64> = (0..50).map(|k| column[k] - if k > 0 { column[k - 1] } else { 0.0 }).collect();
        (0..2).for_each(|_| difference(&mut column, 0.5));
        assert!(column.iter().zip(&whole).all(|(a, b)| (a - b).abs() < 1e-12), "{column:?}");
    }

    #[test]
    fn refuses_what_is_no_covariance() {
        assert!(Whitening::of(&Noise::Covariance(vec![vec![1.0, 2.0, 2.0, 1.0]]), 0, 2).is_err());
        assert!(Whitening::of(&Noise::Covariance(vec![]), 0, 2).is_err());
        assert!(Whitening::of(&Noise::AutoregressiveWith(1.0), 0, 2).is_err());
    }
}
