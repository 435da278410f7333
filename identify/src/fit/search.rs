//! The search for the parameters of a fit.

use crate::error::{Error, Result};
use crate::experiment::Curve;
use crate::fit::Fit;
use crate::identification::Identification;
use crate::least_squares::{Minimum, square};
use crate::noise::{Whitening, autoregression};
use crate::problem::Problem;
use crate::start::starts;
use crate::statistics::{correlation_test, runs_test};

/// Rounds of the estimate of an autoregressive coefficient.
const MAX_ROUNDS: usize = 8;
/// Residuals are tested, and another search is made where they are dependent with this probability.
const DOUBTED: f64 = 1e-3;

impl Identification {
    /// Fits curves.
    ///
    /// # Errors
    /// If no curve is given, a parameter has an unknown name or a value outside its range, a tip never touches or goes beyond its
    /// last elastic state, there are not more points than parameters, or the search does not converge.
    pub fn fit(&self, curves: &[Curve]) -> Result<Fit> {
        let pairs = curves.iter().map(|curve| (&curve.experiment, Some(&curve.force)));
        let mut problem = self.problem(pairs)?;
        let free = problem.free().count();
        let mut minimum = self.global_minimum(&problem)?;
        if self.fits_correlation() {
            let mut last = 0.0;
            for _ in 0..MAX_ROUNDS {
                let deviations = problem.all_deviations(&problem.values(&minimum.coordinates))?;
                let phi = autoregression(deviations.iter().map(Vec::as_slice));
                for part in &mut problem.parts {
                    part.whitening = Whitening::Autoregressive(phi);
                }
                minimum = self.minimum(&problem, minimum.coordinates)?;
                if (phi - last).abs() < 1e-4 {
                    break;
                }
                last = phi;
            }
        }
        let fit = Fit::new(self, problem, minimum)?;
        let points = fit.points_in_contact();
        if points <= free {
            return Err(Error::TooFewPoints { points, parameters: free });
        }
        Ok(fit)
    }

    /// The least of the minima from several starts. A minimum whose residuals are independent is not doubted.
    fn global_minimum(&self, problem: &Problem<'_>) -> Result<Minimum> {
        let mut best: Option<(f64, Minimum)> = None;
        let mut failure = None;
        for coordinates in starts(problem)? {
            match self.minimum(problem, coordinates) {
                Ok(minimum) => {
                    let sum = square(&minimum.residuals);
                    let residuals = std::slice::from_ref(&minimum.residuals);
                    let tests = [runs_test(residuals), correlation_test(residuals, 0)];
                    let fits = sum <= problem.rounding() || tests.iter().all(|test| test.probability > DOUBTED);
                    if best.as_ref().is_none_or(|(least, _)| sum < *least) {
                        best = Some((sum, minimum));
                    }
                    if fits {
                        break;
                    }
                }
                Err(error) => failure = Some(error),
            }
        }
        match (best, failure) {
            (Some((_, minimum)), _) => Ok(minimum),
            (None, Some(error)) => Err(error),
            (None, None) => Err(Error::NoContact { curve: 0 }),
        }
    }
}
