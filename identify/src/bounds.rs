//! Cramér–Rao bounds.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};

use crate::error::{Error, Result};
use crate::problem::Problem;

/// The least standard deviations of the parameters that any unbiased estimate from an experiment can have, on the scale on
/// which a parameter is searched for: relative for moduli, times and stiffness.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Bounds {
    /// Names of the free parameters.
    pub names: Vec<String>,
    /// Covariance of the parameters, by rows.
    pub covariance: Vec<Vec<f64>>,
}

impl Bounds {
    pub(crate) fn new(problem: &Problem, coordinates: &[f64], sigma: f64) -> Result<Bounds> {
        let (names, scales) = (problem.free().map(|of| of.name.clone()).collect(), problem.scales(coordinates));
        let inverse = inverse_gram(&problem.jacobian(coordinates)?, 0.0)?;
        Ok(Bounds::of(names, &scales * inverse * scales.transpose(), sigma))
    }

    /// From the covariance over σ².
    pub(crate) fn of(names: Vec<String>, covariance: Mat<f64>, sigma: f64) -> Bounds {
        let row = |i: usize| (0..names.len()).map(|j| sigma * sigma * covariance[(i, j)]).collect();
        Bounds { covariance: (0..names.len()).map(row).collect(), names }
    }

    /// Least standard deviation of a parameter: of its logarithm for moduli, times and stiffness, of ln(α/(1 − α)) for exponents, and
    /// in its unit for the others.
    pub fn deviation(&self, name: &str) -> Option<f64> {
        self.of_both(name, name).map(f64::sqrt)
    }

    /// Correlation of two parameters.
    pub fn correlation(&self, one: &str, other: &str) -> Option<f64> {
        Some(self.of_both(one, other)? / (self.deviation(one)? * self.deviation(other)?))
    }

    /// Covariance of two parameters.
    pub(crate) fn of_both(&self, one: &str, other: &str) -> Option<f64> {
        let at = |name: &str| self.names.iter().position(|other| other == name);
        Some(self.covariance[at(one)?][at(other)?])
    }
}

/// (JᵀJ)⁻¹, by a matrix of unit diagonal, to which `ridge` is added: so that a combination of parameters on which the data do not depend has a
/// great deviation.
pub(crate) fn inverse_gram(jacobian: &Mat<f64>, ridge: f64) -> Result<Mat<f64>> {
    let gram = jacobian.transpose() * jacobian;
    let count = gram.nrows();
    let scale: Vec<f64> = (0..count).map(|j| gram[(j, j)].sqrt()).collect();
    let singular = || {
        let reason = "the data do not depend on a parameter, or only on a combination of several: fix one of them";
        Error::NotConverged { iterations: 0, reason }
    };
    if scale.iter().any(|s| *s == 0.0 || !s.is_finite()) {
        return Err(singular());
    }
    let scaled =
        Mat::from_fn(count, count, |i, j| gram[(i, j)] / (scale[i] * scale[j]) + if i == j { ridge } else { 0.0 });
    let inverse = scaled.llt(Side::Lower).map_err(|_| singular())?.inverse();
    Ok(Mat::from_fn(count, count, |i, j| inverse[(i, j)] / (scale[i] * scale[j])))
}
