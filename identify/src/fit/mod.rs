//! What was identified.

mod band;
mod deviations;
mod intervals;
mod report;
mod reweigh;
mod scatter;
mod search;
mod state;
mod variants;

use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

use faer::Mat;
use viscocontact::rheology::Material;

use crate::bounds::Bounds;
use crate::error::{Error, Result, count_within};
use crate::experiment::{Curve, Experiment};
use crate::forward::Sample;
use crate::identification::Identification;
use crate::model::{Model, Scale};
use crate::parameters::Parameter;
use crate::part::Part;
use crate::problem::{Problem, Response};
use crate::series::Prony;
use crate::statistics::{correlation_test, means, student};
use deviations::{inverse, limit, robust_deviation};
pub use report::{FitWarning, ranked};
use search::Found;
pub use state::FitState;
pub use variants::Variant;

/// A parameter that moves by less than this fraction with a coordinate hardly depends on it.
const LITTLE: f64 = 0.1;

/// One identified parameter.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Its value, in SI units.
    pub value: f64,
    /// The scale of the deviations.
    pub scale: Scale,
    /// Standard deviation on that scale: relative for moduli, times and stiffness, of ln(α/(1 − α)) for exponents, in the unit of the value for the others.
    pub deviation: f64,
    /// Interval of 95 % from the standard deviation.
    pub interval: [f64; 2],
    /// The limit at which the parameter is, if the data cannot tell it from there: then the model is a simpler one. A parameter that has
    /// no effect at the limit has an infinite deviation.
    pub limit: Option<&'static str>,
}

/// The result of a fit.
#[derive(Clone, Debug)]
pub struct Fit {
    identification: Identification,
    curves: Vec<Curve>,
    /// The problem that was solved, with the noise that was found.
    pub(crate) problem: Problem,
    /// Values of all parameters.
    pub(crate) values: Vec<f64>,
    found: Found,
    prony: Prony,
    estimates: Vec<Estimate>,
    /// Covariance of the estimates, and of the coordinates.
    spread: Bounds,
    of_coordinates: Mat<f64>,
    /// Ends of profiles, for bands, and whether the data bound them.
    ends: OnceLock<Vec<(Vec<f64>, bool)>>,
    responses: Vec<Response>,
    sigma: f64,
    /// Degrees of freedom of intervals.
    freedom: f64,
    /// Share of the information that means of neighbours have lost.
    lost: f64,
}

impl Fit {
    pub(crate) fn new(identification: &Identification, problem: Problem, found: Found) -> Result<Fit> {
        let minimum = &found.minimum;
        let (coordinates, residuals, sum) = (&minimum.coordinates, &minimum.residuals, minimum.sum());
        let slopes = problem.slopes(coordinates)?;
        let (jacobian, lost) = (&problem.matrix(&slopes), problem.lost(&slopes));
        let values = problem.values(coordinates);
        let prony = problem.prony(&values)?.finite()?;
        let (count, points) = (coordinates.len(), problem.len());
        if points <= count {
            return Err(Error::TooFewPoints { points, parameters: count });
        }
        let freedom = (points - count) as f64;
        let sigma = identification.sigma().unwrap_or_else(|| match identification.robust {
            true => robust_deviation(&problem, residuals, freedom),
            false => (sum / freedom).sqrt(),
        });
        let free: Vec<Parameter> = problem.free().cloned().collect();
        let scales = problem.scales(coordinates);
        let all = match identification.robust {
            true => &problem.without_outliers().jacobian(coordinates)?,
            false => jacobian,
        };
        let (inverse, limits) = inverse(&free, all, sigma)?;
        let spread = Bounds::new(&problem, &inverse, &scales, sigma);
        // of slow residuals so many are independent, and their standard deviation is known as that of half as many (F. E. Satterthwaite, 1946)
        let independent =
            |part: &Part| 0.5 * part.len() as f64 * (1.0 - part.whitening.phi) / (1.0 + part.whitening.phi);
        let freedom = match identification.sigma() {
            _ if identification.fits_correlation() => problem.parts.iter().map(independent).sum::<f64>().min(freedom),
            Some(_) => 1e6,
            None => freedom,
        };
        let quantile = student(0.95, freedom.max(1.0));
        let at = (0..values.len()).filter(|&k| problem.parameters[k].is_free);
        let estimate = |((k, parameter), at): ((usize, &Parameter), usize)| {
            // a coordinate at its limit may have any value, and a parameter that nothing else moves, too
            let is_known = (0..count).all(|j| !limits[j] || scales[(k, j)].abs() < LITTLE);
            let is_known = is_known && !(limits[k] && spread.covariance[k][k] == 0.0);
            let known = |variance: f64| if is_known { variance.sqrt() } else { f64::INFINITY };
            let (value, deviation) = (values[at], known(spread.covariance[k][k]));
            let on_scale = parameter.scale.forward(value);
            Estimate {
                name: parameter.name.clone(),
                value,
                scale: parameter.scale,
                deviation,
                interval: [-quantile, quantile].map(|quantile| parameter.scale.back(on_scale + quantile * deviation)),
                limit: limits[k].then(|| limit(&parameter.name, value, scales[(k, k)])),
            }
        };
        let estimates = free.iter().enumerate().zip(at).map(estimate).collect();
        let whole = problem.whole();
        let response = |curve: usize| whole.response(curve, &values, &prony);
        let responses = (0..whole.parts.len()).map(response).collect::<Result<_>>()?;
        let of_coordinates = inverse * faer::Scale(sigma * sigma);
        let curves = whole.parts.iter().map(|part| part.curve.clone()).collect();
        Ok(Fit {
            identification: identification.clone(),
            curves,
            problem,
            values,
            found,
            prony,
            estimates,
            spread,
            of_coordinates,
            ends: OnceLock::new(),
            responses,
            sigma,
            freedom,
            lost,
        })
    }

    /// The same with a watch over what it computes from now on ([`Identification::watched`]).
    pub fn watched(mut self, goes_on: impl Fn() -> ControlFlow<()> + Send + Sync + 'static) -> Fit {
        self.identification = self.identification.watched(goes_on);
        self.problem.watch = self.identification.watch.clone();
        self
    }

    /// Ends a call whose watch breaks.
    pub(crate) fn goes_on(&self) -> Result<()> {
        self.identification.watch.goes_on()
    }

    /// The model that was fitted.
    pub fn model(&self) -> Model {
        self.identification.model()
    }

    /// The identified parameters: of the material first.
    pub fn estimates(&self) -> &[Estimate] {
        &self.estimates
    }

    /// The estimate of one parameter. With several curves, names of properties of a curve end with its index: `offset 1`.
    pub fn estimate(&self, name: &str) -> Option<&Estimate> {
        self.estimates.iter().find(|estimate| estimate.name == name)
    }

    /// Covariance of two parameters, on their scales.
    pub fn covariance(&self, one: &str, other: &str) -> Option<f64> {
        self.spread.of_both(one, other)
    }

    /// Correlation of two parameters.
    pub fn correlation(&self, one: &str, other: &str) -> Option<f64> {
        self.spread.correlation(one, other)
    }

    /// The material, against a rigid tip, for contacts of the main crate: incompressible, with the identified contact modulus. Its contact
    /// with a rigid body is the contact of every material of this modulus. Its series is that of the fit: steps beyond the times of the data, from
    /// their shortest sampling interval to the length of the longest curve, warn that the material is extrapolated.
    ///
    /// # Errors
    /// If a modulus of the series is beyond 1e100 Pa, as of a law that is steep at t = 0.
    pub fn material(&self) -> Result<Material> {
        self.prony.material(0.5, self.problem.window)
    }

    /// Force and depth of the fit at each sample of a curve; empty if there is no such curve, as its forces and residuals are.
    pub fn samples(&self, curve: usize) -> &[Sample] {
        self.responses.get(curve).map_or(&[], |response| &response.samples)
    }

    /// Force of the fit at each sample of a curve, offset, drift, tilt and drag included \[N\].
    pub fn force(&self, curve: usize) -> &[f64] {
        self.responses.get(curve).map_or(&[], |response| &response.force)
    }

    /// Measured less fitted force at each sample of a curve \[N\].
    pub fn residuals(&self, curve: usize) -> &[f64] {
        self.responses.get(curve).map_or(&[], |response| &response.residuals)
    }

    /// The curves.
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// The experiment of a curve of this index.
    pub(crate) fn experiment(&self, curve: usize) -> Result<&Experiment> {
        let allowed = "below the number of curves: the first is curve 0";
        count_within("index of a curve", curve, curve < self.curves.len(), allowed)?;
        Ok(&self.curves[curve].experiment)
    }

    /// Standard deviation of the noise \[N\]: of its independent part, if it is autoregressive.
    /// Of several curves, the geometric mean; [`Fit::sigma_of`] is that of one.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// Standard deviation of the noise of a curve \[N\].
    pub fn sigma_of(&self, curve: usize) -> f64 {
        self.sigma / self.problem.parts.get(curve).map_or(1.0, |part| part.scale)
    }

    /// The autoregressive coefficient of the noise of a curve, if it has one.
    pub fn autoregression_of(&self, curve: usize) -> Option<f64> {
        Some(self.problem.parts.get(curve)?.whitening.phi).filter(|phi| *phi != 0.0)
    }

    /// The order d of the long memory that the noise of a curve has beside its autoregressive coefficient: 0 if it has none, ½ of pink noise.
    pub fn memory_of(&self, curve: usize) -> f64 {
        self.problem.parts.get(curve).map_or(0.0, |part| part.whitening.memory)
    }

    /// Iterations of the search.
    pub fn iterations(&self) -> usize {
        self.found.minimum.steps
    }

    /// Share of the information on a parameter that is lost where a curve of more than 2048 samples, in noise that is white or of unknown correlation, is
    /// fitted in so many means of neighbours: the maximum of all parameters. Where it is above 1 %, and of shorter curves, each sample is fitted, and it is 0.
    pub fn information_lost(&self) -> f64 {
        self.lost
    }

    /// Work of the search: exponentials that were advanced by a sample, each derivative counted.
    pub fn work(&self) -> usize {
        self.problem.work.load(Ordering::Relaxed)
    }

    /// Samples with the tip in contact.
    pub fn points_in_contact(&self) -> usize {
        self.responses.iter().flat_map(|of| &of.samples).filter(|sample| sample.contact_depth > 0.0).count()
    }

    /// Probability of correlations of the residuals as great, if the model is right (Ljung & Box 1978): a small one means that the model is wrong, of
    /// the material or of the noise.
    pub fn probability(&self) -> f64 {
        let white = |(of, part): (&Response, &Part)| {
            let mut white = means(&of.residuals, part.len());
            part.whiten(&mut white);
            white
        };
        let white: Vec<_> = self.responses.iter().zip(&self.problem.parts).map(white).collect();
        correlation_test(&white, if self.identification.fits_correlation() { self.curves.len() } else { 0 })
    }

    /// Akaike's criterion, corrected for the number of samples (Hurvich & Tsai 1989). Less is better; it is infinite where there are hardly more samples than
    /// parameters.
    pub fn aicc(&self) -> f64 {
        let (points, known) = (self.problem.len() as f64, self.identification.sigma());
        // of each curve
        let of_noise = usize::from(known.is_none()) + usize::from(self.identification.fits_correlation());
        let count = (self.estimates.len() + of_noise * self.curves.len()) as f64;
        if points <= count + 1.0 {
            return f64::INFINITY;
        }
        let sum = self.found.minimum.sum();
        let misfit = match known {
            Some(sigma) => sum / (sigma * sigma) + 2.0 * points * sigma.ln(),
            None => points * ((sum / points).ln() + 1.0),
        };
        let log_weight: f64 = self.problem.parts.iter().map(Part::log_weight).sum();
        misfit - log_weight + 2.0 * count + 2.0 * count * (count + 1.0) / (points - count - 1.0)
    }

    /// The exponentials, with moduli of zero or more.
    pub(crate) fn prony(&self) -> Prony {
        self.prony.positive()
    }

    /// The value of the contact point of a curve \[m\].
    pub fn contact_point(&self, curve: usize) -> f64 {
        self.problem.contact_point(curve, &self.values)
    }
}
