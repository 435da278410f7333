//! Cramér–Rao bounds.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};

use crate::error::{Error, Result};
use crate::problem::Problem;

/// The minimum standard deviations of the parameters that any unbiased estimate from an experiment can have, on the scale on
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
    /// From the covariance (JᵀJ)⁻¹ of the coordinates over σ², and the derivatives of the parameters by them.
    pub(crate) fn new(problem: &Problem, inverse: &Mat<f64>, scales: &Mat<f64>, sigma: f64) -> Bounds {
        let names: Vec<String> = problem.free().map(|of| of.name.clone()).collect();
        let covariance = scales * inverse * scales.transpose();
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

/// (JᵀJ)⁻¹, with a diagonal that is greater by the fraction `ridge`: so that a combination of parameters on which the data do not depend has a
/// great deviation.
pub(crate) fn inverse_gram(jacobian: &Mat<f64>, ridge: f64) -> Result<Mat<f64>> {
    let mut gram = jacobian.transpose() * jacobian;
    let reason = "the data do not depend on a parameter, or only on a combination of several: fix one of them";
    let singular = || Error::NotConverged { iterations: 0, reason };
    for j in 0..gram.nrows() {
        gram[(j, j)] *= 1.0 + ridge;
        if gram[(j, j)] == 0.0 || !gram[(j, j)].is_finite() {
            return Err(singular());
        }
    }
    Ok(gram.llt(Side::Lower).map_err(|_| singular())?.inverse())
}
