//! The search for the parameters of a fit.

use std::sync::Arc;

use faer::Col;
#[cfg(feature = "rayon")]
use rayon::prelude::*;
use viscocontact::numeric::LeastSquares;

use super::scatter::is_error;
use crate::bounds::inverse_gram;
use crate::error::{Error, Result};
use crate::experiment::Curve;
use crate::fit::Fit;
use crate::identification::Identification;
use crate::model::Model;
use crate::noise::Noise;
use crate::parameters::Property;
use crate::problem::{ENOUGH, LONG, Problem, ROUGH};
use crate::start::starts;
use crate::statistics::{is_flat, means, scatter};

/// Rounds of fits, each with the noise of the one before.
const MAX_ROUNDS: usize = 12;
/// Share of the information on a parameter that means of neighbours may lose.
const MOST_LOST: f64 = 0.01;
/// Deviations by which means may move a coordinate.
const LITTLE_MOVED: f64 = 0.3;
/// Relative difference of the sums of squares of one minimum.
const AGREED: f64 = 1e-7;

/// What a search found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(super) minimum: LeastSquares,
    /// A model that this one contains, and its sum of squares over the least one.
    pub(super) above: Option<(Model, f64)>,
}

impl Identification {
    /// Fits curves.
    ///
    /// # Errors
    /// If no curve is given, a parameter has an unknown name or a value outside its range, a tip never touches or goes beyond its
    /// last elastic state, there are not more points than parameters, or the search does not converge.
    pub fn fit(&self, curves: &[Curve]) -> Result<Fit> {
        self.watch.goes_on()?;
        let mut problem = self.problem(curves.to_vec())?;
        if let Some(curve) = curves.iter().position(|curve| is_flat(&curve.force)) {
            return Err(Error::NoContact { curve });
        }
        let scatters: Vec<f64> = curves.iter().map(|curve| scatter(&curve.force)).collect();
        // known correlations are those of samples, and an outlier is one
        let is_simple = matches!(self.noise, Noise::White | Noise::Autoregressive) && !self.robust;
        self.balance(&mut problem, &scatters);
        let means = if is_simple { problem.thinned(LONG) } else { None };
        let mut found = self.global_minimum(means.as_ref().unwrap_or(&problem))?;
        if let Some(means) = means {
            let means = Problem { whole: Some(Arc::new(problem.clone())), ..means };
            match self.means_suffice(&means, &found.minimum)? {
                true => problem = means,
                false => found.minimum = self.minimum(&problem, found.minimum.coordinates)?,
            }
        }
        if self.fits_correlation() || self.robust || self.finds_deviations(&problem) {
            for _ in 0..MAX_ROUNDS {
                let mut next = problem.clone();
                // a minimum that is kept keeps the weights that it is of
                if self.reweigh(&mut next, &found.minimum)? {
                    break;
                }
                problem = next;
                // sums of squares of other weights cannot be compared
                found = Found { minimum: self.minimum(&problem, found.minimum.coordinates)?, above: None };
            }
        }
        let fit = Fit::new(self, problem, found)?;
        let (points, parameters) = (fit.points_in_contact(), fit.estimates().len());
        if points <= parameters { Err(Error::TooFewPoints { points, parameters }) } else { Ok(fit) }
    }

    /// Fits each curve alone, as the curves of a force map: the results are in the order of the curves. With the feature `rayon` the
    /// curves are shared between the threads of the present pool. `done` is called after each fit, for a progress bar. A list of contact points,
    /// springs, or starts of the material has one for each curve ([`Identification::parameter`]).
    ///
    /// ```
    /// use std::sync::atomic::{AtomicUsize, Ordering};
    /// use viscocontact::states::ElasticStates;
    /// use viscocontact_identify::{Curve, Experiment, Identification, Model, Protocol};
    ///
    /// let protocol = Protocol::trapezoid(1.0e-6, [0.1, 1.0, 0.1], 0.05)?;
    /// let experiment = Experiment::new(protocol, ElasticStates::sphere(5.0e-6)?);
    /// let maxwell = Identification::new(Model::Maxwell);
    /// let curve = |modulus: f64| -> viscocontact_identify::Result<Curve> {
    ///     let samples = maxwell.respond(&experiment, &[("E0", modulus), ("tau", 0.5)])?;
    ///     Curve::new(experiment.clone(), samples.iter().map(|sample| sample.force).collect())
    /// };
    /// let map = [curve(1.0e3)?, curve(2.0e3)?, curve(3.0e3)?];
    /// let done = AtomicUsize::new(0);
    /// let fits = maxwell.fit_each(&map, |_| { done.fetch_add(1, Ordering::Relaxed); });
    /// assert_eq!((fits.len(), done.into_inner()), (3, 3));
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// Each result as of [`Identification::fit`], where the index of a curve is 0. An error of one curve does not end the others.
    pub fn fit_each(&self, curves: &[Curve], done: impl Fn(&Result<Fit>) + Sync) -> Vec<Result<Fit>> {
        let lists = self.chosen.0.iter().map(|(name, of)| of.each(Property::field(name), curves.len()).map(drop));
        let suited: Result<()> = lists.collect();
        let fit = |(index, curve): (usize, &Curve)| {
            let fit = suited.clone().and_then(|()| self.of_curve(index).fit(std::slice::from_ref(curve)));
            done(&fit);
            fit
        };
        #[cfg(feature = "rayon")]
        return curves.par_iter().enumerate().map(fit).collect();
        #[cfg(not(feature = "rayon"))]
        curves.iter().enumerate().map(fit).collect()
    }

    /// Whether the minimum of means of neighbours is that of all samples, nearly: they lose little of the information, and the residuals of the samples
    /// would move no coordinate by much of its deviation. They may move it where the drive has errors of measurement, which means reduce.
    fn means_suffice(&self, problem: &Problem, minimum: &LeastSquares) -> Result<bool> {
        let (coordinates, whole) = (&minimum.coordinates, problem.whole());
        let (slopes, values) = (problem.slopes(coordinates)?, problem.values(coordinates));
        let prony = problem.prony(&values)?;
        let (mut differences, mut has_errors) = (Vec::new(), false);
        for (curve, part) in problem.parts.iter().enumerate() {
            let [fine, coarse] = [whole, problem].map(|of| of.response(curve, &values, &prony));
            let (fine, coarse) = (fine?, coarse?.force);
            has_errors |= is_error(&fine.samples, &fine.residuals);
            let fine = means(&fine.force, part.len());
            differences.push(fine.iter().zip(coarse).map(|(fine, coarse)| fine - coarse).collect());
        }
        let (differences, jacobian) = (problem.white(differences), problem.matrix(&slopes));
        let inverse = inverse_gram(&jacobian, 1e-13)?;
        let moved = &inverse * jacobian.transpose() * Col::from_fn(differences.len(), |k| differences[k]);
        let deviation = (minimum.sum() / problem.len() as f64).sqrt();
        let is_same = (0..moved.nrows()).all(|k| moved[k].abs() < LITTLE_MOVED * deviation * inverse[(k, k)].sqrt());
        Ok(problem.lost(&slopes) <= MOST_LOST && (is_same || has_errors))
    }

    /// The least of the minima from several starts, of which one is the minimum of each model that this one contains. Most of the search is on
    /// few samples.
    fn global_minimum(&self, problem: &Problem) -> Result<Found> {
        let inside = problem.model.contained().and_then(|inner| {
            let simpler = problem.with_model(inner)?;
            let minimum = self.global_minimum(&simpler).ok()?.minimum;
            let values = problem.of_contained(inner, &simpler.values(&minimum.coordinates));
            Some((inner, minimum.sum(), problem.coordinates(&values)))
        });
        self.watch.goes_on()?;
        let start = inside.iter().map(|(.., coordinates)| coordinates.clone());
        // few samples, on which a search is cheap
        let rough = problem.thinned(ROUGH).map(|few| Problem { enough: ENOUGH[1], ..few });
        let some = rough.as_ref().unwrap_or(problem);
        let mut best = self.least(some, start.clone().chain(starts(some)?), AGREED.max(some.enough));
        if rough.is_some() {
            best = best.and_then(|minimum| self.least(problem, std::iter::once(minimum.coordinates), AGREED));
            if inside.as_ref().is_none_or(|(_, least, _)| sum(&best) > *least) {
                let again = self.least(problem, start, AGREED);
                best = if sum(&again) < sum(&best) { again } else { best };
            }
        }
        let above = inside.map(|(model, least, _)| (model, least / sum(&best)));
        Ok(Found { minimum: best?, above })
    }

    /// The least of the minima from several starts; two that agree end the search.
    fn least(&self, problem: &Problem, starts: impl Iterator<Item = Vec<f64>>, agreed: f64) -> Result<LeastSquares> {
        let mut best: Result<LeastSquares> = Err(Error::NoContact { curve: 0 });
        let (mut least, mut steps) = (f64::INFINITY, 0);
        for start in starts {
            let found = self.minimum(problem, start);
            steps += found.as_ref().map_or(0, |minimum| minimum.steps);
            let sum = sum(&found);
            let [less, more] = if sum < least { [sum, least] } else { [least, sum] };
            if sum < least || best.is_err() {
                (least, best) = (least.min(sum), found);
            }
            let is_same = more.is_finite() && more <= (1.0 + agreed) * less;
            if is_same || less <= problem.rounding() {
                break;
            }
        }
        let mut best = best?;
        best.steps = steps;
        Ok(best)
    }
}

/// The sum of squares of a minimum, infinite where none is found.
fn sum(found: &Result<LeastSquares>) -> f64 {
    found.as_ref().map_or(f64::INFINITY, LeastSquares::sum)
}
