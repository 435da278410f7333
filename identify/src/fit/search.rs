//! The search for the parameters of a fit.

use crate::error::{Error, Result};
use crate::experiment::Curve;
use crate::fit::Fit;
use crate::identification::Identification;
use crate::least_squares::{Minimum, square};
use crate::model::Model;
use crate::problem::Problem;
use crate::start::{check_contact, starts};
use crate::statistics::scatter;

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
        let mut problem = self.problem(curves.to_vec())?;
        check_contact(&problem)?;
        let scatters: Vec<f64> = curves.iter().map(|curve| scatter(&curve.force)).collect();
        self.balance(&mut problem, &scatters);
        let mut found = self.global_minimum(&problem)?;
        if self.finds_noise(&problem) {
            for _ in 0..MAX_ROUNDS {
                let is_found = self.reweigh(&mut problem, &found.minimum)?;
                if is_found {
                    break;
                }
                // sums of squares of other weights cannot be compared
                found = Found { minimum: self.minimum(&problem, found.minimum.coordinates)?, contained: None };
            }
        }
        let fit = Fit::new(self, problem, found)?;
        let (points, parameters) = (fit.points_in_contact(), fit.estimates().len());
        if points <= parameters { Err(Error::TooFewPoints { points, parameters }) } else { Ok(fit) }
    }

    /// The least of the minima from several starts, of which one is the minimum of each model that this one contains. Most of the search is on
    /// few samples.
    fn global_minimum(&self, problem: &Problem) -> Result<Found> {
        let (mut contained, mut inside) = (None, Vec::new());
        for inner in problem.model.contained() {
            let Some(simpler) = problem.with_model(inner) else { continue };
            if let Ok(Found { minimum, .. }) = self.global_minimum(&simpler) {
                contained = Some((inner, square(&minimum.residuals)));
                let values = simpler.values(&minimum.coordinates);
                inside.push(problem.coordinates(&problem.of_contained(inner, &values)));
            }
        }
        let rough = problem.thinned();
        let some = rough.as_ref().unwrap_or(problem);
        let mut best = self.least(some, inside.iter().cloned().chain(starts(some)?), AGREED.max(some.enough));
        if rough.is_some() {
            best = self.least(problem, best.map(|minimum| minimum.coordinates).into_iter(), AGREED);
            let sum = |found: &Result<Minimum>| found.as_ref().map_or(f64::INFINITY, |m| square(&m.residuals));
            if contained.is_none_or(|(_, least)| sum(&best) > least) {
                let again = self.least(problem, inside.into_iter(), AGREED);
                best = if sum(&again) < sum(&best) { again } else { best };
            }
        }
        Ok(Found { minimum: best?, contained })
    }

    /// The least of the minima from several starts; two that agree end the search.
    fn least(&self, problem: &Problem, starts: impl Iterator<Item = Vec<f64>>, agreed: f64) -> Result<Minimum> {
        let mut best: Result<Minimum> = Err(Error::NoContact { curve: 0 });
        let (mut least, mut iterations) = (f64::INFINITY, 0);
        for start in starts {
            let minimum = match self.minimum(problem, start) {
                Ok(minimum) => minimum,
                Err(error) => {
                    best = best.map_err(|_| error);
                    continue;
                }
            };
            iterations += minimum.iterations;
            let sum = square(&minimum.residuals);
            let [less, more] = if sum < least { [sum, least] } else { [least, sum] };
            if sum < least || best.is_err() {
                (least, best) = (least.min(sum), Ok(minimum));
            }
            if less <= problem.rounding() || more <= (1.0 + agreed) * less {
                break;
            }
        }
        best.map(|minimum| Minimum { iterations, ..minimum })
    }
}
