//! The search for the parameters of a fit.

use crate::error::{Error, Result};
use crate::experiment::Curve;
use crate::fit::Fit;
use crate::identification::Identification;
use crate::least_squares::{Minimum, square};
use crate::model::Model;
use crate::problem::Problem;
use crate::start::starts;

/// Rounds of fits, each with the noise of the one before.
const MAX_ROUNDS: usize = 12;
/// Relative difference of the sums of squares of one minimum.
const AGREED: f64 = 1e-7;

/// What a search found.
pub(crate) struct Found {
    pub(super) minimum: Minimum,
    /// A model that this one contains, and its sum of squares.
    pub(super) contained: Option<(Model, f64)>,
}

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
        let mut found = self.global_minimum(&problem)?;
        if self.finds_noise(&problem) {
            for _ in 0..MAX_ROUNDS {
                let is_found = self.reweigh(&mut problem, &found.minimum)?;
                if is_found {
                    break;
                }
                found.minimum = self.minimum(&problem, found.minimum.coordinates)?;
                // sums of squares of other weights cannot be compared
                found.contained = None;
            }
        }
        let fit = Fit::new(self, problem, found)?;
        let points = fit.points_in_contact();
        if points <= free {
            return Err(Error::TooFewPoints { points, parameters: free });
        }
        Ok(fit)
    }

    /// The least of the minima from several starts, of which one is the minimum of each model that this one contains.
    fn global_minimum(&self, problem: &Problem<'_>) -> Result<Found> {
        let mut found: Vec<(f64, Minimum)> = Vec::new();
        let mut failure = Error::NoContact { curve: 0 };
        let mut search = |coordinates: Vec<f64>| match self.minimum(problem, coordinates) {
            Ok(minimum) => {
                found.push((square(&minimum.residuals), minimum));
                found.sort_by(|a, b| a.0.total_cmp(&b.0));
                // two searches that end at one minimum are believed
                found[0].0 <= problem.rounding() || found.len() > 1 && found[1].0 <= (1.0 + AGREED) * found[0].0
            }
            Err(error) => {
                failure = error;
                false
            }
        };
        let mut contained = None;
        for inner in problem.model.contained() {
            let simpler = problem.with_model(inner);
            if let Some(Found { minimum, .. }) = simpler.and_then(|simpler| self.global_minimum(&simpler).ok()) {
                contained = Some((inner, square(&minimum.residuals)));
                let values = problem.with_model(inner).map(|simpler| simpler.values(&minimum.coordinates));
                search(problem.coordinates(&problem.of_contained(inner, &values.unwrap_or_default())));
            }
        }
        for coordinates in starts(problem)? {
            if search(coordinates) {
                break;
            }
        }
        let iterations = found.iter().map(|(_, minimum)| minimum.iterations).sum();
        match found.into_iter().next() {
            Some((_, minimum)) => Ok(Found { minimum: Minimum { iterations, ..minimum }, contained }),
            None => Err(failure),
        }
    }
}
