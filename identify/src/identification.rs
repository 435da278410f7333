//! What is to be identified, and from what.

use std::ops::ControlFlow;

use viscocontact::numeric::{LeastSquares, least_squares};

use crate::bounds::{Bounds, inverse_gram};
use crate::error::{Error, Result, positive, unknown, within};
use crate::experiment::{Curve, Experiment};
use crate::forward::Sample;
use crate::model::Model;
use crate::noise::Noise;
use crate::parameters::{Chosen, Kind, Nuisance, Parameter, PerCurve, Property};
use crate::problem::Problem;
use crate::watch::Watch;

/// Steps after which a search has failed, if the last one reduces the sum of squares by more than a fraction.
const MAX_STEPS: usize = 200;
const SLOW: f64 = 1e-6;
/// A search ends where a step reduces the sum of squares by less than this fraction, and by more than half of what the step before did: where the data
/// hardly determine a combination of parameters, hundreds of such steps would change the combination by a small part of its deviation.
const SLOW_ENOUGH: f64 = 1e-7;

/// A model of the material with what is known of the measurement: fits curves, and gives bounds before an experiment.
///
/// All curves of one fit have the same material. The contact point is the drive at which the tip first touches. Each curve has its own contact
/// point, offset, drift, tilt and drag; the stiffness of the spring is common unless it is given for each. All are known to be 0 unless stated (and
/// the stiffness the stiffness of the experiment).
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
    pub(crate) chosen: Chosen,
    pub(crate) noise: Noise,
    sigma: Option<f64>,
    pub(crate) robust: bool,
    pub(crate) watch: Watch,
}

impl Identification {
    /// Identifies the parameters of a model; everything else is known until stated otherwise.
    pub fn new(model: Model) -> Identification {
        let (chosen, watch) = (Chosen::default(), Watch::default());
        Identification { model, chosen, noise: Noise::White, sigma: None, robust: false, watch }
    }

    /// A parameter by its name, of the material or of the measurement. A list has one for each curve: of the material, for each curve of
    /// [`Identification::fit_each`].
    pub fn parameter(mut self, name: &str, each: impl Into<PerCurve>) -> Identification {
        self.chosen.0.push((name.into(), each.into()));
        self
    }

    /// Fixes a parameter of the material.
    pub fn fix(self, name: &str, value: f64) -> Identification {
        self.parameter(name, Nuisance::Fixed(value))
    }

    /// Starts the search for a parameter of the material here.
    pub fn start(self, name: &str, value: f64) -> Identification {
        self.parameter(name, Nuisance::FittedFrom(value))
    }

    /// Drive at first touch \[m\].
    pub fn contact_point(self, contact_point: impl Into<PerCurve>) -> Identification {
        self.parameter(Property::ContactPoint.name(), contact_point)
    }

    /// Force without contact \[N\].
    pub fn offset(self, offset: impl Into<PerCurve>) -> Identification {
        self.parameter(Property::Offset.name(), offset)
    }

    /// Growth of the force without contact \[N/s\].
    pub fn drift(self, drift: impl Into<PerCurve>) -> Identification {
        self.parameter(Property::Drift.name(), drift)
    }

    /// Growth of the force without contact with the drive \[N/m\]: interference of the light on the cantilever, or an actuator that is not straight.
    pub fn tilt(self, tilt: impl Into<PerCurve>) -> Identification {
        self.parameter(Property::Tilt.name(), tilt)
    }

    /// Force over the speed of the drive \[N s/m\]: a cantilever in a liquid.
    pub fn drag(self, drag: impl Into<PerCurve>) -> Identification {
        self.parameter(Property::Drag.name(), drag)
    }

    /// Stiffness of the spring \[N/m\], in place of the stiffness of the experiments: of all curves together, or a list of their springs.
    pub fn stiffness(self, stiffness: impl Into<PerCurve>) -> Identification {
        self.parameter(Property::Stiffness.name(), stiffness)
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

    /// Calls `goes_on` during each step of a search, on the thread of the search: where it breaks, the call ends as a cancelled one
    /// ([`viscocontact::Error::Cancelled`]). For progress bars and interruption, of what a [`Fit`](crate::Fit) computes later, too.
    pub fn watched(mut self, goes_on: impl Fn() -> ControlFlow<()> + Send + Sync + 'static) -> Identification {
        self.watch = Watch::new(goes_on);
        self
    }

    /// Checks what is chosen before there is a curve: values given, the noise, and the numbers of the model.
    ///
    /// # Errors
    /// As of [`Identification::fit`].
    pub fn check(&self) -> Result<()> {
        self.sigma.map(|sigma| positive("standard deviation of the noise", sigma)).transpose()?;
        if let Noise::AutoregressiveWith(phi) = self.noise {
            within("autoregressive coefficient", phi, phi.abs() < 1.0, "between -1 and 1")?;
        }
        self.model.check_cutoff()?;
        Parameter::of_material(self.model, &self.chosen).map(drop)
    }

    /// The model.
    pub fn model(&self) -> Model {
        self.model
    }

    /// The same for one of several curves alone: what [`Identification::fit_each`] fits to it.
    pub fn of_curve(&self, curve: usize) -> Identification {
        let mut alone = self.clone();
        alone.chosen.0.iter_mut().for_each(|(_, each)| *each = each.of(curve));
        alone
    }

    /// Force and depth at each sample of an experiment, for parameters of the material by name. The contact point is 0 unless it is
    /// fixed, or the search for it has a start.
    ///
    /// # Errors
    /// If a parameter has an unknown name, no value or several, or a value that is not allowed, or the tip goes beyond its last elastic state.
    pub fn respond(&self, experiment: &Experiment, values: &[(&str, f64)]) -> Result<Vec<Sample>> {
        // computed forces have no noise
        let problem = self.clone().noise(Noise::White).planned(std::slice::from_ref(experiment))?;
        let values = self.given(&problem, values)?;
        let prony = problem.prony(&values)?.finite()?;
        problem.samples(0, &values, &prony)
    }

    /// Cramér–Rao bounds of an experiment before it is made: the minimum standard deviations with which its parameters can be
    /// found, with noise of standard deviation `sigma` \[N\]. `values` are the
    /// expected parameters of the material.
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
            return Err(Error::UnknownCorrelation);
        }
        let problem = self.planned(experiments)?;
        let values = self.given(&problem, values)?;
        problem.prony(&values)?.finite()?;
        let coordinates = problem.coordinates(&values);
        let inverse = inverse_gram(&problem.jacobian(&coordinates)?, 0.0)?;
        Ok(Bounds::new(&problem, &inverse, &problem.scales(&coordinates), sigma))
    }

    pub(crate) fn sigma(&self) -> Option<f64> {
        // of residuals without outliers it is found
        if self.robust { None } else { self.sigma }
    }

    /// Whether the autoregressive coefficient is fitted, too.
    pub(crate) fn fits_correlation(&self) -> bool {
        self.noise == Noise::Autoregressive
    }

    /// Minimum from a start: a sum of squares that is rounding, or that a step reduces by less than a fraction. What such a step leaves is far less,
    /// but for parameters that go to a limit.
    pub(crate) fn minimum(&self, problem: &Problem, start: Vec<f64>) -> Result<LeastSquares> {
        let rounding = problem.rounding();
        let is_enough = |at: &LeastSquares| {
            let [last, before] = at.reductions;
            let is_slow = last > 0.5 * before && last <= SLOW_ENOUGH;
            at.sum() <= rounding || last <= problem.enough || is_slow || at.steps == MAX_STEPS
        };
        let found = least_squares(start, |x| problem.residuals(x), |x| problem.slopes(x), is_enough)?;
        if found.steps < MAX_STEPS || found.reductions[0] <= SLOW {
            return Ok(found);
        }
        let reason =
            "the sum of squares still falls: give start values, fix parameters, or take a model with fewer of them";
        Err(Error::NotConverged { iterations: MAX_STEPS, reason })
    }

    /// The problem of some curves.
    pub(crate) fn problem(&self, curves: Vec<Curve>) -> Result<Problem> {
        self.check()?;
        Ok(Problem { watch: self.watch.clone(), ..Problem::new(self.model, &self.chosen, curves, self.noise)? })
    }

    /// The problem of experiments that have no data yet.
    fn planned(&self, experiments: &[Experiment]) -> Result<Problem> {
        let no_force = |of: &Experiment| Curve { experiment: of.clone(), force: vec![0.0; of.protocol.times.len()] };
        self.problem(experiments.iter().map(no_force).collect())
    }

    /// Values of all parameters from the material's by name.
    fn given(&self, problem: &Problem, named: &[(&str, f64)]) -> Result<Vec<f64>> {
        if let Some((name, _)) = named.iter().find(|(name, _)| problem.parameters.iter().all(|p| p.name != *name)) {
            return Err(unknown(name, problem.parameters.iter().map(|own| &own.name)));
        }
        let value = |parameter: &Parameter| {
            let own = || named.iter().filter(|(name, _)| *name == parameter.name).map(|(_, value)| *value);
            let is_needed = matches!(parameter.kind, Kind::Material | Kind::Measurement(Property::Stiffness, _));
            match (own().count(), own().next().or(parameter.given)) {
                (0 | 1, Some(value)) => parameter.scale.check(&parameter.name, value).map(|()| value),
                (0, None) if !is_needed => Ok(0.0),
                (values, _) => Err(Error::NotOneValue { name: parameter.name.clone(), values }),
            }
        };
        problem.parameters.iter().map(value).collect()
    }
}
