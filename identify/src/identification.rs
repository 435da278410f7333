//! What is to be identified, and from what.

use crate::bounds::Bounds;
use crate::error::{Error, Result, positive};
use crate::experiment::{Curve, Experiment};
use crate::forward::Sample;
use crate::least_squares::{Minimum, minimise};
use crate::model::Model;
use crate::noise::{CurveNoise, Noise, Whitening};
use crate::parameters::{Chosen, Kind, Nuisance, PerCurve, Size, parameters};
use crate::problem::{Part, Problem};

/// A model of the material with what is known of the measurement: fits curves, and gives bounds before an experiment.
///
/// All curves of one fit have the same material. The contact point is the drive at which the tip first touches. Each curve has its own contact
/// point, offset, drift, tilt and drag; the stiffness of the spring is common. All are known to be 0 unless stated (and the stiffness the stiffness
/// of the experiment).
///
/// ```
/// use viscocontact_identify::{Curve, Experiment, Identification, Model, Nuisance, Protocol};
/// use viscocontact::states::ElasticStates;
///
/// // a ball of 5 µm is pressed 500 nm deep in 0.1 s, held for a second, and retracted
/// let times: Vec<f64> = (0..400).map(|k| 4e-3 * f64::from(k)).collect();
/// let drive = times.iter().map(|t| (5e-6 * t).min(500e-9).min(5e-6 * (1.2 - t))).collect();
/// let experiment = Experiment::new(Protocol::new(times, drive)?, ElasticStates::sphere(5e-6)?);
/// let zener = Identification::new(Model::Zener);
/// // in place of a measurement
/// let force = zener.respond(&experiment, &[("E0", 2e3), ("Einf", 5e2), ("tau", 0.2)])?;
/// let force = force.iter().map(|sample| sample.force).collect();
/// let fit = zener.contact_point(Nuisance::Fitted).fit(&[Curve::new(experiment, force)?])?;
/// assert!((fit.estimate("tau").unwrap().value - 0.2).abs() < 1e-6);
/// # Ok::<(), viscocontact_identify::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Identification {
    model: Model,
    chosen: Chosen,
    noise: Noise,
    sigma: Option<f64>,
    robust: bool,
}

impl Identification {
    /// Identifies the parameters of a model; everything else is known until stated otherwise.
    pub fn new(model: Model) -> Identification {
        Identification { model, chosen: Chosen::default(), noise: Noise::White, sigma: None, robust: false }
    }

    /// Drive at first touch \[m\].
    pub fn contact_point(mut self, contact_point: impl Into<PerCurve>) -> Identification {
        self.chosen.contact_point = contact_point.into();
        self
    }

    /// Force without contact \[N\].
    pub fn offset(mut self, offset: impl Into<PerCurve>) -> Identification {
        self.chosen.offset = offset.into();
        self
    }

    /// Growth of the force without contact \[N/s\].
    pub fn drift(mut self, drift: impl Into<PerCurve>) -> Identification {
        self.chosen.drift = drift.into();
        self
    }

    /// Growth of the force without contact with the drive \[N/m\]: interference of the light on the cantilever, or an actuator that is not straight.
    pub fn tilt(mut self, tilt: impl Into<PerCurve>) -> Identification {
        self.chosen.tilt = tilt.into();
        self
    }

    /// Force over the speed of the drive \[N s/m\]: a cantilever in a liquid.
    pub fn drag(mut self, drag: impl Into<PerCurve>) -> Identification {
        self.chosen.drag = drag.into();
        self
    }

    /// Stiffness of the spring \[N/m\], in place of the stiffness of the experiments.
    pub fn stiffness(mut self, stiffness: Nuisance) -> Identification {
        self.chosen.stiffness = Some(stiffness);
        self
    }

    /// The noise of the forces.
    pub fn noise(mut self, noise: Noise) -> Identification {
        self.noise = noise;
        self
    }

    /// Standard deviation of the noise \[N\] (its independent part, if it is autoregressive), where it is known; else it
    /// is estimated from the residuals.
    pub fn known_sigma(mut self, sigma: f64) -> Identification {
        self.sigma = Some(sigma);
        self
    }

    /// Takes the weight of outliers: Tukey's biweight of the residuals made white. Neither known standard deviations nor the criterion of
    /// Akaike apply then.
    pub fn robust(mut self) -> Identification {
        self.robust = true;
        self
    }

    pub(crate) fn is_robust(&self) -> bool {
        self.robust
    }

    /// Fixes a parameter of the material.
    pub fn fix(mut self, name: &str, value: f64) -> Identification {
        self.chosen.material.push((name.to_string(), value, true));
        self
    }

    /// Starts the search for a parameter of the material here.
    pub fn start(mut self, name: &str, value: f64) -> Identification {
        self.chosen.material.push((name.to_string(), value, false));
        self
    }

    /// The model.
    pub fn model(&self) -> Model {
        self.model
    }

    /// Force and depth at each sample of an experiment, for parameters of the material by name. The contact point is 0 unless it is
    /// fixed.
    ///
    /// # Errors
    /// If a parameter is missing or not allowed, or the tip goes beyond its last elastic state.
    pub fn respond(&self, experiment: &Experiment, values: &[(&str, f64)]) -> Result<Vec<Sample>> {
        let problem = self.problem([(experiment, None)].into_iter())?;
        let values = self.given(&problem, values)?;
        let prony = problem.prony(&values)?;
        problem.samples(0, &values, &prony)
    }

    /// Cramér–Rao bounds of an experiment before it is made: the least standard deviations with which its parameters can be
    /// found, with noise of standard deviation `sigma` \[N\]. `values` are the expected parameters of the material.
    ///
    /// ```
    /// use viscocontact_identify::{Experiment, Identification, Model, Protocol};
    /// use viscocontact::states::ElasticStates;
    ///
    /// let times: Vec<f64> = (0..=1000).map(|k| 3e-3 * f64::from(k)).collect();
    /// let drive = times.iter().map(|t| 1e-6 * t.min(1.0).min(3.0 - t)).collect();
    /// let experiment = Experiment::new(Protocol::new(times, drive)?, ElasticStates::sphere(5e-6)?);
    /// let expected = [("E0", 2e3), ("Einf", 5e2), ("tau", 1.0)];
    /// let bounds = Identification::new(Model::Zener).bounds(&[experiment], &expected, 5e-11)?;
    /// assert!(bounds.deviation("tau").unwrap() < 0.05);
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Identification::respond`]; if the correlation of the noise is unknown.
    pub fn bounds(&self, experiments: &[Experiment], values: &[(&str, f64)], sigma: f64) -> Result<Bounds> {
        positive("standard deviation of the noise", sigma)?;
        if self.fits_correlation() {
            let reason = "bounds need the correlation of the noise: take Noise::AutoregressiveWith";
            return Err(Error::NotConverged { iterations: 0, reason });
        }
        let problem = self.problem(experiments.iter().map(|experiment| (experiment, None)))?;
        let values = self.given(&problem, values)?;
        let jacobian = problem.jacobian(&problem.coordinates(&values))?;
        Bounds::new(&problem, &values, &jacobian, sigma)
    }

    /// The problem of fitted curves with the noise of the fit: whitening, scale and weights of each curve.
    pub(crate) fn refit_problem(&self, curves: &[Curve], noise: &[CurveNoise]) -> Result<Problem> {
        let mut problem = self.problem(curves.iter().map(|curve| (&curve.experiment, Some(&curve.force))))?;
        for (part, noise) in problem.parts.iter_mut().zip(noise) {
            if let Some(phi) = noise.correlation {
                part.whitening = Whitening::Autoregressive(phi);
            }
            part.scale = noise.scale;
            part.outliers.clone_from(&noise.outliers);
            part.weights = noise.outliers.iter().map(|weight| noise.scale * weight).collect();
        }
        Ok(problem)
    }

    /// The value of a known property of a curve.
    pub(crate) fn known(&self, kind: Kind) -> f64 {
        let chosen = &self.chosen;
        let nuisance = match kind {
            Kind::ContactPoint(curve) => chosen.contact_point.of(curve),
            Kind::Offset(curve) => chosen.offset.of(curve),
            Kind::Drift(curve) => chosen.drift.of(curve),
            Kind::Tilt(curve) => chosen.tilt.of(curve),
            Kind::Drag(curve) => chosen.drag.of(curve),
            Kind::Material(_) | Kind::Stiffness => return 0.0,
        };
        if let Nuisance::Fixed(value) = nuisance { value } else { 0.0 }
    }

    pub(crate) fn sigma(&self) -> Option<f64> {
        match self.noise {
            Noise::Covariance(_) => Some(1.0),
            // of residuals without outliers it is found
            _ if self.robust => None,
            _ => self.sigma,
        }
    }

    /// Whether the autoregressive coefficient is fitted, too.
    pub(crate) fn fits_correlation(&self) -> bool {
        self.noise == Noise::Autoregressive
    }

    /// Minimum from a start.
    pub(crate) fn minimum(&self, problem: &Problem, coordinates: Vec<f64>) -> Result<Minimum> {
        minimise(coordinates, [problem.rounding(), problem.enough], |x| problem.residuals(x), |x| problem.jacobian(x))
    }

    /// The problem of some curves, which may have no data yet.
    pub(crate) fn problem<'a>(
        &self,
        curves: impl Iterator<Item = (&'a Experiment, Option<&'a Vec<f64>>)>,
    ) -> Result<Problem> {
        if let Some(sigma) = self.sigma {
            positive("standard deviation of the noise", sigma)?;
        }
        let (mut parts, mut sizes) = (Vec::new(), Vec::new());
        for (curve, (experiment, force)) in curves.enumerate() {
            let (times, drive) = (experiment.protocol.times(), experiment.protocol.drive());
            let data = force.cloned().unwrap_or_else(|| vec![0.0; times.len()]);
            let ends = |values: &[f64]| {
                values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)])
            };
            let range = |[low, high]: [f64; 2]| if high > low { high - low } else { 1.0 };
            let time = times[times.len() - 1] - times[0];
            sizes.push(Size { depth: range(ends(drive)), drive: ends(drive), force: range(ends(&data)), time });
            let whitening = Whitening::of(&self.noise, curve, times.len())?;
            parts.push(Part::new(experiment, data, whitening));
        }
        if parts.is_empty() {
            return Err(Error::TooFewPoints { points: 0, parameters: self.model.parameters().len() });
        }
        let parameters = parameters(self.model, &self.chosen, &sizes)?;
        Ok(Problem::new(self.model, parts, parameters))
    }

    /// Values of all parameters from the material's by name.
    fn given(&self, problem: &Problem, named: &[(&str, f64)]) -> Result<Vec<f64>> {
        let names = || problem.model.parameters().join(", ");
        if let Some((name, _)) = named.iter().find(|(name, _)| problem.parameters.iter().all(|p| p.name != *name)) {
            return Err(Error::UnknownParameter { name: (*name).to_string(), names: names() });
        }
        let value = |parameter: &crate::parameters::Parameter| {
            let named = named.iter().find(|(name, _)| *name == parameter.name).map(|(_, value)| *value);
            let given = named.or(parameter.given);
            match (given, parameter.kind) {
                (Some(value), _) => Ok(value),
                (None, Kind::Material(_) | Kind::Stiffness) => {
                    Err(Error::UnknownParameter { name: format!("{} without a value", parameter.name), names: names() })
                }
                (None, _) => Ok(0.0),
            }
        };
        problem.parameters.iter().map(value).collect()
    }
}
