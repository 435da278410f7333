//! The noise of each curve, from the residuals of a fit.

use faer::{Mat, Side};
use viscocontact::numeric::{LeastSquares, minimum};

use crate::bounds::inverse_gram;
use crate::error::Result;
use crate::identification::Identification;
use crate::noise::{CORRELATIONS, Whitening, difference};
use crate::problem::Problem;
use crate::statistics::square;
use crate::watch::Watch;

/// Correlations that are tried first.
const TRIED: usize = 40;
/// Orders of a memory that are tried, up to that of spectra that fall a little faster than 1/f, and by how much −2 ln of the likelihood has to fall: white and
/// autoregressive noise have a memory once in a hundred curves then.
const MEMORY: f64 = 0.1;
const MEMORIES: usize = 7;
const CLEARLY: f64 = 6.6;
/// Difference of −2 ln of the likelihood within which memories are as likely.
const ALIKE: f64 = 2.7;
/// Change of a weight or a correlation at which the noise is found.
const FOUND: f64 = 1e-3;
/// Residuals beyond so many standard deviations have no weight (Tukey's biweight, 95 % as efficient as least squares under normal noise).
const REJECTED: f64 = 4.685;
/// Median of |x| of a standard normal variable.
const MEDIAN: f64 = 0.6745;

impl Identification {
    /// Whether each curve has a standard deviation of its own.
    pub(super) fn finds_deviations(&self, problem: &Problem) -> bool {
        self.sigma().is_none() && problem.parts.len() > 1
    }

    /// Sets correlation and weights of each curve by the residuals at a minimum; whether they were as good as found.
    pub(super) fn reweigh(&self, problem: &mut Problem, minimum: &LeastSquares) -> Result<bool> {
        let mut bare = problem.without_outliers();
        for part in &mut bare.parts {
            part.scale = 1.0;
            if self.fits_correlation() {
                part.whitening = Whitening::default();
            }
        }
        let at = &minimum.coordinates;
        let (residuals, jacobian, weighed) = (bare.residuals(at)?, bare.jacobian(at)?, problem.jacobian(at)?);
        let inverse = inverse_gram(&weighed, 1e-13).unwrap_or_else(|_| Mat::zeros(jacobian.ncols(), jacobian.ncols()));
        let (mut first, mut is_found) = (0, true);
        let mut deviations = Vec::new();
        for part in &mut problem.parts {
            let rows = first..first + part.len();
            first = rows.end;
            let mut own = residuals[rows.clone()].to_vec();
            if self.fits_correlation() {
                let [phi, memory] = correlation(&own, &jacobian, rows.start, &self.watch)?;
                let before = part.whitening;
                is_found &= (phi - before.phi).abs() < FOUND && memory == before.memory;
                part.whitening = Whitening { phi, memory };
                part.whitening.apply(&mut own);
            }
            let leverage = |row: usize| {
                let slopes = weighed.row(row);
                (slopes * &inverse * slopes.transpose()).max(0.0)
            };
            // of all parameters, the share that this curve determines
            let fitted: f64 = rows.clone().map(leverage).sum();
            let deviation = if self.robust {
                let mut sizes: Vec<f64> = own.iter().map(|r| r.abs()).collect();
                sizes.sort_by(f64::total_cmp);
                sizes[sizes.len() / 2] / MEDIAN
            } else {
                (square(&own) / (own.len() as f64 - fitted).max(1.0)).sqrt()
            };
            deviations.push(deviation);
            let weight = |r: f64| {
                let u = r / (REJECTED * deviation);
                if self.robust && deviation > 0.0 { (1.0 - u * u).max(0.0) } else { 1.0 }
            };
            let weights: Vec<f64> = own.iter().map(|&r| weight(r)).collect();
            let change = weights.iter().zip(&part.outliers).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            is_found &= change < FOUND;
            part.outliers = weights;
        }
        Ok(is_found & self.balance(problem, &deviations))
    }

    /// Weighs curves by the deviations of their noise, relative to their geometric mean; whether the weights were as good as those.
    pub(super) fn balance(&self, problem: &mut Problem, deviations: &[f64]) -> bool {
        let mean = deviations.iter().map(|s| s.ln()).sum::<f64>() / deviations.len() as f64;
        let is_unequal = self.finds_deviations(problem) && mean.is_finite();
        let mut is_found = true;
        for (part, deviation) in problem.parts.iter_mut().zip(deviations) {
            let scale = if is_unequal { mean.exp() / deviation } else { 1.0 };
            is_found &= (scale / part.scale).ln().abs() < FOUND;
            part.scale = scale;
        }
        is_found
    }
}

/// The autoregressive coefficient of the maximum restricted likelihood (H. D. Patterson & R. Thompson, Biometrika 58, 1971), and the order of the
/// memory: the residuals are those of the problem that is linearised by the rows of the Jacobian from `first` on.
fn correlation(residuals: &[f64], jacobian: &Mat<f64>, first: usize, watch: &Watch) -> Result<[f64; 2]> {
    let points = residuals.len();
    let slopes = (0..jacobian.ncols()).map(|j| (0..points).map(|k| jacobian[(first + k, j)]).collect::<Vec<f64>>());
    let mut columns: Vec<Vec<f64>> = slopes.filter(|column| square(column) > 0.0).collect();
    let count = columns.len();
    columns.push(residuals.to_vec());
    for column in &mut columns {
        let norm = square(column).sqrt();
        column.iter_mut().for_each(|value| *value /= norm);
    }
    // −2 ln of the restricted likelihood
    let unlikelihood = |columns: &[Vec<f64>], phi: f64| {
        let (whitening, mut white) = (Whitening { phi, memory: 0.0 }, columns.to_vec());
        white.iter_mut().for_each(|column| whitening.apply(column));
        let white = Mat::from_fn(points, count + 1, |k, j| white[j][k]);
        let ridge = Mat::<f64>::identity(count + 1, count + 1) * faer::Scale(1e-12);
        // the last entry of the Cholesky factor is the norm of the residuals that are left, the others have the determinant
        let Ok(factor) = (white.transpose() * &white + ridge).llt(Side::Lower) else { return f64::INFINITY };
        let twice_ln = |i: usize| 2.0 * factor.L()[(i, i)].ln();
        let determinant: f64 = (0..count).map(twice_ln).sum();
        (points - count) as f64 * twice_ln(count) - whitening.log_weight() + determinant
    };
    if points <= count || square(residuals) == 0.0 {
        return Ok([0.0; 2]);
    }
    let tried = (0..=MEMORIES)
        .map(|k| {
            let (memory, mut columns) = (MEMORY * k as f64, columns.clone());
            let reduce = |column: &mut Vec<f64>| watch.goes_on().map(|()| difference(column, memory));
            columns.iter_mut().try_for_each(reduce)?;
            let phi = minimum(CORRELATIONS[0], CORRELATIONS[1], TRIED, |phi| unlikelihood(&columns, phi));
            Ok((unlikelihood(&columns, phi) + if memory > 0.0 { CLEARLY } else { 0.0 }, [phi, memory]))
        })
        .collect::<Result<Vec<_>>>()?;
    let (least, [_, memory]) = tried.iter().fold((f64::INFINITY, [0.0; 2]), |a, b| if b.0 < a.0 { *b } else { a });
    // of memories that are as likely, the longest: with a shorter one deviations are too small
    let margin = if memory > 0.0 { ALIKE } else { 0.0 };
    Ok(tried.iter().rfind(|(cost, _)| *cost <= least + margin).map_or([0.0; 2], |found| found.1))
}
