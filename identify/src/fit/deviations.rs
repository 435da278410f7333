//! Deviations of estimates.

use faer::Mat;

use super::LITTLE;
use crate::bounds::inverse_gram;
use crate::error::Result;
use crate::model::Scale;
use crate::parameters::Parameter;
use crate::problem::Problem;

/// A parameter is at a limit if its coordinate would have to change by so much for an effect of one standard deviation: by a factor of e¹⁰.
const NO_EFFECT: f64 = 10.0;
/// Relative information on a combination of parameters that is rounding.
const SINGULAR: f64 = 1e-13;

/// The standard deviation that gives, with columns without weights, the deviations of an estimate with the weights w = 1 − u² of residuals r
/// (P. J. Huber, *Robust Statistics*, 1981): √(Σψ²/freedom)/mean ψ′, with ψ = w² r.
pub(super) fn robust_deviation(problem: &Problem, weighted: &[f64], freedom: f64) -> f64 {
    let weights = problem.parts.iter().flat_map(|part| &part.outliers);
    let (mut square, mut slope, mut count) = (0.0, 0.0, 0.0);
    for (&weight, &residual) in weights.zip(weighted) {
        square += (weight * residual).powi(2);
        slope += weight * (5.0 * weight - 4.0);
        count += 1.0;
    }
    (square / freedom).sqrt() * count / slope
}

/// (JᵀJ)⁻¹ without the coordinates at a limit, and which ones are.
pub(super) fn inverse(free: &[Parameter], jacobian: &Mat<f64>, sigma: f64) -> Result<(Mat<f64>, Vec<bool>)> {
    let is_at_limit = |column: usize| {
        let norm = jacobian.col(column).norm_l2();
        free[column].scale != Scale::Linear && sigma > NO_EFFECT * norm
    };
    let limits: Vec<bool> = (0..free.len()).map(is_at_limit).collect();
    let rest: Vec<usize> = (0..free.len()).filter(|&column| !limits[column]).collect();
    let mut inverse = Mat::zeros(free.len(), free.len());
    if !rest.is_empty() {
        let part = Mat::from_fn(jacobian.nrows(), rest.len(), |row, column| jacobian[(row, rest[column])]);
        let part = inverse_gram(&part, SINGULAR)?;
        for (i, &row) in rest.iter().enumerate() {
            rest.iter().enumerate().for_each(|(j, &column)| inverse[(row, column)] = part[(i, j)]);
        }
    }
    Ok((inverse, limits))
}

/// What the limit of a parameter is, which moves by so much with its coordinate.
pub(super) fn limit(name: &str, value: f64, scale: f64) -> &'static str {
    match name {
        "Einf" if scale >= LITTLE => "Einf = 0: no equilibrium",
        "E0" | "Einf" => "E0 = Einf: no relaxation",
        "alpha" if value < 0.5 => "an exponent of 0: no relaxation",
        "beta" if value < 0.5 => "an exponent of 0: a power law",
        "alpha" | "beta" => "an exponent of 1: one relaxation time",
        "stiffness" => "a rigid spring",
        name if name.starts_with("tau") => "a time without effect, or beyond the data",
        _ => "0",
    }
}
