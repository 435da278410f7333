//! What was identified.

mod deviations;
mod intervals;
mod report;
mod reweigh;
mod search;
mod variants;

use faer::Mat;
use viscocontact::rheology::Material;

use crate::error::{Error, Result};
use crate::experiment::Curve;
use crate::forward::Sample;
use crate::identification::Identification;
use crate::least_squares::square;
use crate::model::{Model, Scale};
use crate::noise::CurveNoise;
use crate::parameters::{Kind, Parameter};
use crate::problem::Problem;
use crate::series::Prony;
use crate::statistics::{ResidualTest, correlation_test, runs_test, student};
use deviations::{inverse, limit, robust_deviation, sandwich};
pub use report::{FitWarning, ranked};
use search::Found;
pub use variants::Variant;

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
    /// Standard deviation on that scale: relative for moduli, times and stiffness.
    pub deviation: f64,
    /// The same from the scatter of the residuals as it is, without the assumption on the noise (sandwich estimate, with the correlations
    /// of neighbours after Newey & West 1987).
    pub robust_deviation: f64,
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
    values: Vec<f64>,
    prony: Prony,
    estimates: Vec<Estimate>,
    covariance: Mat<f64>,
    samples: Vec<Vec<Sample>>,
    forces: Vec<Vec<f64>>,
    /// Measured less modelled force, by curve, and the same made white.
    residuals: Vec<Vec<f64>>,
    white: Vec<Vec<f64>>,
    sigma: f64,
    noise: Vec<CurveNoise>,
    sum: f64,
    log_weight: f64,
    iterations: usize,
    work: usize,
    window: [f64; 2],
    /// The least sum of squares of a model that this one contains.
    contained: Option<(Model, f64)>,
}

impl Fit {
    pub(crate) fn new(identification: &Identification, problem: Problem, found: Found) -> Result<Fit> {
        let Found { minimum, contained } = found;
        let values = problem.values(&minimum.coordinates);
        let prony = problem.prony(&values)?;
        let count = minimum.coordinates.len();
        let points = problem.len();
        if points <= count {
            return Err(Error::TooFewPoints { points, parameters: count });
        }
        let sum = square(&minimum.residuals);
        let freedom = (points - count) as f64;
        let sigma = match identification.sigma() {
            Some(sigma) => sigma,
            None if identification.is_robust() => robust_deviation(&problem, &minimum.residuals, freedom),
            None => (sum / freedom).sqrt(),
        };
        let free: Vec<Parameter> = problem.free().cloned().collect();
        let scales = problem.scales(&values);
        let (weighted, _) = inverse(&free, &minimum.jacobian, sigma)?;
        let lengths: Vec<usize> = problem.parts.iter().map(|part| part.len()).collect();
        let sandwich = &scales * sandwich(&minimum, &weighted, &lengths) * scales.transpose();
        let (inverse, limits) = inverse(&free, &problem.without_outliers().jacobian(&minimum.coordinates)?, sigma)?;
        let covariance = &scales * &inverse * scales.transpose();
        let quantile = student(0.95, if identification.sigma().is_some() { 1e6 } else { freedom });
        let mut at = (0..values.len()).filter(|&k| problem.parameters[k].is_free);
        let estimates = free.iter().enumerate().map(|(k, parameter)| {
            // a coordinate at its limit has no deviation; its parameter may have that of another
            let is_known = (0..count).any(|j| scales[(k, j)] != 0.0 && !limits[j]);
            let deviation = if is_known { sigma * covariance[(k, k)].sqrt() } else { f64::INFINITY };
            let value = values[at.next().unwrap_or_default()];
            let on_scale = parameter.scale.forward(value);
            Estimate {
                name: parameter.name.clone(),
                value,
                scale: parameter.scale,
                deviation,
                robust_deviation: if is_known { sandwich[(k, k)].sqrt() } else { f64::INFINITY },
                interval: [-quantile, quantile].map(|quantile| parameter.scale.back(on_scale + quantile * deviation)),
                limit: limits[k].then(|| limit(&parameter.name, value)),
            }
        });
        let estimates = estimates.collect();
        let (mut samples, mut forces, mut residuals, mut white) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (curve, part) in problem.parts.iter().enumerate() {
            let response = problem.samples(curve, &values, &prony)?;
            let force = problem.measured(curve, &values, response.iter().map(|sample| sample.force));
            let residual: Vec<f64> = part.data.iter().zip(&force).map(|(data, force)| data - force).collect();
            let mut of_curve = residual.clone();
            part.whiten(&mut of_curve);
            samples.push(response);
            forces.push(force);
            residuals.push(residual);
            white.push(of_curve);
        }
        let noise = problem.parts.iter().map(|part| CurveNoise {
            correlation: part.whitening.correlation(),
            scale: part.scale,
            outliers: part.outliers.clone(),
        });
        let noise = noise.collect();
        let curve =
            |part: &crate::problem::Part| Curve { experiment: part.experiment.clone(), force: part.data.clone() };
        Ok(Fit {
            identification: identification.clone(),
            curves: problem.parts.iter().map(curve).collect(),
            values,
            prony,
            estimates,
            covariance: Mat::from_fn(count, count, |i, j| sigma * sigma * covariance[(i, j)]),
            samples,
            forces,
            residuals,
            white,
            sigma,
            noise,
            sum,
            log_weight: problem.parts.iter().map(|part| part.log_weight()).sum(),
            iterations: minimum.iterations,
            work: problem.work.get(),
            window: problem.window,
            contained,
        })
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
        let at = |name: &str| self.estimates.iter().position(|estimate| estimate.name == name);
        Some(self.covariance[(at(one)?, at(other)?)])
    }

    /// Correlation of two parameters.
    pub fn correlation(&self, one: &str, other: &str) -> Option<f64> {
        let variance = |name: &str| self.covariance(name, name);
        Some(self.covariance(one, other)? / (variance(one)? * variance(other)?).sqrt())
    }

    /// The contact modulus E*(t) at a time after a sudden step \[Pa\].
    pub fn modulus(&self, t: f64) -> f64 {
        self.prony.modulus(t)
    }

    /// The contact modulus at a time with its standard deviation, relative: \[Pa, 1\].
    pub fn modulus_band(&self, t: f64) -> [f64; 2] {
        let modulus = self.modulus(t);
        let (count, window) = (self.model().parameters().len(), self.window());
        // derivatives of ln E by the free parameters of the material
        let names = self.model().parameters();
        let slope = |estimate: &Estimate| {
            let Some(at) = names.iter().position(|name| *name == estimate.name) else { return 0.0 };
            let of = |shift: f64| {
                let mut moved = self.values[..count].to_vec();
                moved[at] = estimate.scale.back(estimate.scale.forward(moved[at]) + shift);
                self.model().prony(&moved, window).map_or(f64::NAN, |prony| prony.modulus(t).ln())
            };
            let (up, down) = (of(1e-5), of(-1e-5));
            if up.is_nan() || down.is_nan() { 0.0 } else { (up - down) / 2e-5 }
        };
        let slopes: Vec<f64> = self.estimates.iter().map(slope).collect();
        let sum: f64 = (0..slopes.len())
            .flat_map(|i| (0..slopes.len()).map(move |j| (i, j)))
            .map(|(i, j)| slopes[i] * slopes[j] * self.covariance[(i, j)])
            .sum();
        [modulus, sum.max(0.0).sqrt()]
    }

    /// The shear modulus G(t) = E*(t) (1 − ν)/2 for a known constant Poisson's ratio \[Pa\]. One contact cannot tell ν.
    ///
    /// # Errors
    /// If the ratio is outside (−1, 0.5].
    pub fn shear_modulus(&self, t: f64, poisson: f64) -> Result<f64> {
        crate::error::within("Poisson's ratio", poisson, poisson > -1.0 && poisson <= 0.5, "> -1 and at most 0.5")?;
        Ok(0.5 * self.modulus(t) * (1.0 - poisson))
    }

    /// The material, against a rigid tip, for contacts of the main crate: incompressible, with the identified contact modulus. Its contact
    /// with a rigid body is the contact of every material of this modulus.
    ///
    /// # Errors
    /// If the modulus at t = 0 is not finite.
    pub fn material(&self) -> Result<Material> {
        self.prony.material(0.5)
    }

    /// Force and depth of the fit at each sample of a curve; empty if there is no such curve, as its forces and residuals are.
    pub fn samples(&self, curve: usize) -> &[Sample] {
        self.samples.get(curve).map_or(&[], Vec::as_slice)
    }

    /// Force of the fit at each sample of a curve, offset, drift and drag included \[N\].
    pub fn force(&self, curve: usize) -> &[f64] {
        self.forces.get(curve).map_or(&[], Vec::as_slice)
    }

    /// Measured less fitted force at each sample of a curve \[N\].
    pub fn residuals(&self, curve: usize) -> &[f64] {
        self.residuals.get(curve).map_or(&[], Vec::as_slice)
    }

    /// The curves.
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// Standard deviation of the noise \[N\]: of its independent part, if it is autoregressive. A factor of the given covariance, which is 1.
    /// Of several curves, the geometric mean; [`Fit::sigma_of`] is that of one.
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// Standard deviation of the noise of a curve \[N\].
    pub fn sigma_of(&self, curve: usize) -> f64 {
        self.sigma / self.noise.get(curve).map_or(1.0, |noise| noise.scale)
    }

    /// The autoregressive coefficient of the first curve, if the noise has one; [`Fit::autoregression_of`] is that of another curve.
    pub fn autoregression(&self) -> Option<f64> {
        self.autoregression_of(0)
    }

    /// The autoregressive coefficient of the noise of a curve, if it has one.
    pub fn autoregression_of(&self, curve: usize) -> Option<f64> {
        self.noise.get(curve)?.correlation
    }

    /// Iterations of the search.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Work of the search: exponentials that were advanced by a sample, each derivative counted.
    pub fn work(&self) -> usize {
        self.work
    }

    /// Samples with the tip in contact.
    pub fn points_in_contact(&self) -> usize {
        self.samples.iter().flatten().filter(|sample| sample.contact_depth > 0.0).count()
    }

    /// Runs of residuals of one sign: few of them mean that the model is wrong.
    pub fn runs(&self) -> ResidualTest {
        runs_test(&self.white)
    }

    /// Correlation of residuals: a small probability means that the model is wrong, of the material or of the noise.
    pub fn correlations(&self) -> ResidualTest {
        correlation_test(&self.white, self.noise.iter().filter(|noise| noise.correlation.is_some()).count())
    }

    /// Akaike's criterion, corrected for the number of samples (Hurvich & Tsai 1989). Less is better.
    pub fn aicc(&self) -> f64 {
        let points = self.white.iter().map(Vec::len).sum::<usize>() as f64;
        let known = self.identification.sigma();
        // of each curve
        let of_noise = usize::from(known.is_none()) + usize::from(self.identification.fits_correlation());
        let count = (self.estimates.len() + of_noise * self.curves.len()) as f64;
        let misfit = match known {
            Some(sigma) => self.sum / (sigma * sigma) + 2.0 * points * sigma.ln(),
            None => points * ((self.sum / points).ln() + 1.0),
        };
        misfit - self.log_weight + 2.0 * count + 2.0 * count * (count + 1.0) / (points - count - 1.0)
    }

    /// The problem that was solved.
    pub(crate) fn problem(&self) -> Result<Problem> {
        self.identification.refit_problem(&self.curves, &self.noise)
    }

    /// Values of all parameters.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The exponentials, with moduli of zero or more.
    pub(crate) fn prony(&self) -> Prony {
        self.prony.positive()
    }

    /// Shortest interval and longest curve \[s\].
    pub(crate) fn window(&self) -> [f64; 2] {
        self.window
    }

    /// The value of the contact point of a curve \[m\].
    pub fn contact_point(&self, curve: usize) -> f64 {
        let name = if self.curves.len() == 1 { "contact point".to_string() } else { format!("contact point {curve}") };
        self.estimate(&name)
            .map_or_else(|| self.identification.known(Kind::ContactPoint(curve)), |estimate| estimate.value)
    }
}
