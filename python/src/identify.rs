//! Moduli from measured indentation curves, with their uncertainty.

use std::sync::Arc;

use numpy::IntoPyArray;
use pyo3::exceptions::{PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact_identify as id;

use crate::arrays::{Array, mapped, to_array};
use crate::curves::{Curve, Experiment, model};
use crate::errors::OrRaise;
use crate::materials::Material;
use crate::recipe::Recipe;
use crate::rheology::Rheology;

/// What is known of a property of the measurement: None (fixed at 0 by default), a number (fixed), True (fitted), or ("from", start).
fn nuisance(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Option<id::Nuisance>> {
    if let Ok(fitted) = given.extract::<bool>() {
        return Ok(fitted.then_some(id::Nuisance::Fitted));
    }
    if let Ok(value) = given.extract::<f64>() {
        return Ok(Some(id::Nuisance::Fixed(value)));
    }
    match given.extract::<(String, f64)>() {
        Ok((word, start)) if word == "from" => Ok(Some(id::Nuisance::FittedFrom(start))),
        _ => {
            Err(PyTypeError::new_err(format!("{name}: a number (known), True (fitted) or (\"from\", start) is needed")))
        }
    }
}

/// A model of the material, and what is known of the measurement: fits curves, and gives bounds before an experiment.
///
/// Parameters
/// ----------
/// model : "elastic", "maxwell", "zener", ("prony", n), ("power_law", cutoff [s]) or "fractional_zener"
/// contact_point, offset, drift, drag, stiffness : float (known), True (fitted), or ("from", start)
///     Drive at first touch [m], force without contact [N], its growth [N/s], force over the speed of the drive [N s/m], and the stiffness
///     of the spring [N/m] in place of that of the experiments.
/// noise : "white" (default), "autoregressive", or the coefficient of an autoregressive noise
/// known_sigma : float, optional
///     Standard deviation of the noise [N].
/// fix, start : dict
///     Parameters of the material that are known, and where the search for others starts.
///
/// >>> import numpy as np
/// >>> tip = ElasticStates.sphere(5e-6)
/// >>> experiment = Experiment.trapezoid(1e-6, (1.0, 3.0, 1.0), 0.01, tip)
/// >>> zener = Identification("zener")
/// >>> force, depth = zener.respond(experiment, {"E0": 4000.0, "Einf": 2000.0, "tau": 0.5})
/// >>> fit = zener.fit(Curve(experiment, force + 1e-11 * np.random.default_rng(0).normal(size=len(force))))
/// >>> abs(fit["tau"].value / 0.5 - 1) < 0.01
/// True
#[pyclass(frozen, module = "viscocontact")]
pub struct Identification(id::Identification);

#[pymethods]
impl Identification {
    #[new]
    #[pyo3(signature = (model, *, contact_point=None, offset=None, drift=None, drag=None, stiffness=None, noise=None, known_sigma=None, fix=None, start=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        model: &Bound<'_, PyAny>,
        contact_point: Option<&Bound<'_, PyAny>>,
        offset: Option<&Bound<'_, PyAny>>,
        drift: Option<&Bound<'_, PyAny>>,
        drag: Option<&Bound<'_, PyAny>>,
        stiffness: Option<&Bound<'_, PyAny>>,
        noise: Option<&Bound<'_, PyAny>>,
        known_sigma: Option<f64>,
        fix: Option<&Bound<'_, PyDict>>,
        start: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Identification> {
        type Setter = fn(id::Identification, id::Nuisance) -> id::Identification;
        let mut identification = id::Identification::new(self::model(model)?);
        let nuisances: [(&str, Option<&Bound<'_, PyAny>>, Setter); 5] = [
            ("contact_point", contact_point, id::Identification::contact_point),
            ("offset", offset, id::Identification::offset),
            ("drift", drift, id::Identification::drift),
            ("drag", drag, id::Identification::drag),
            ("stiffness", stiffness, id::Identification::stiffness),
        ];
        for (name, given, set) in nuisances {
            if let Some(known) = given.map(|given| nuisance(name, given)).transpose()?.flatten() {
                identification = set(identification, known);
            }
        }
        if let Some(noise) = noise {
            identification = identification.noise(match (noise.extract::<f64>(), noise.extract::<&str>()) {
                (Ok(coefficient), _) => id::Noise::AutoregressiveWith(coefficient),
                (_, Ok("white")) => id::Noise::White,
                (_, Ok("autoregressive")) => id::Noise::Autoregressive,
                _ => {
                    return Err(PyTypeError::new_err(
                        "noise: \"white\", \"autoregressive\" or its coefficient is needed",
                    ));
                }
            });
        }
        if let Some(sigma) = known_sigma {
            identification = identification.known_sigma(sigma);
        }
        for (name, value) in fix.into_iter().flatten() {
            identification = identification.fix(name.extract()?, value.extract()?);
        }
        for (name, value) in start.into_iter().flatten() {
            identification = identification.start(name.extract()?, value.extract()?);
        }
        Ok(Identification(identification))
    }

    /// Names of the parameters of the model.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.0.model().parameters()
    }

    /// Fits a curve, or several of one material together.
    ///
    /// Raises ValueError if the curves do not suit, ConvergenceError if the search does not converge.
    fn fit(&self, py: Python<'_>, curves: &Bound<'_, PyAny>) -> PyResult<Fit> {
        let curves = several(curves)?;
        py.detach(|| self.0.fit(&curves)).or_raise().map(Fit)
    }

    /// Fits each curve alone, on all cores, as those of a force map: a list of fits, and of exceptions where one failed.
    fn fit_each(&self, py: Python<'_>, curves: &Bound<'_, PyAny>) -> PyResult<Vec<Py<PyAny>>> {
        let curves = several(curves)?;
        let fits = py.detach(|| self.0.fit_each(&curves, |_| {}));
        let of = |fit: id::Result<id::Fit>| match fit.or_raise() {
            Ok(fit) => Ok(Py::new(py, Fit(fit))?.into_any()),
            Err(error) => Ok(error.into_value(py).into_any()),
        };
        fits.into_iter().map(of).collect()
    }

    /// Force [N] and depth [m] at each time of an experiment, for parameters of the material by name.
    fn respond<'py>(
        &self,
        py: Python<'py>,
        experiment: &Experiment,
        values: &Bound<'py, PyDict>,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let named = named(values)?;
        let named: Vec<(&str, f64)> = named.iter().map(|(name, value)| (&**name, *value)).collect();
        let samples = py.detach(|| self.0.respond(&experiment.0, &named)).or_raise()?;
        let n = [samples.len()];
        let (force, depth) = samples.iter().map(|sample| (sample.force, sample.depth)).unzip();
        Ok((to_array(py, force, &n)?, to_array(py, depth, &n)?))
    }

    /// The least standard deviations that any unbiased estimate from experiments can have, by parameter: relative for moduli, times and
    /// stiffness. `sigma` [N] is the noise.
    fn bounds(
        &self,
        py: Python<'_>,
        experiments: Vec<Bound<'_, Experiment>>,
        values: &Bound<'_, PyDict>,
        sigma: f64,
    ) -> PyResult<std::collections::BTreeMap<String, f64>> {
        let named = named(values)?;
        let named: Vec<(&str, f64)> = named.iter().map(|(name, value)| (&**name, *value)).collect();
        let experiments: Vec<id::Experiment> =
            experiments.iter().map(|experiment| experiment.get().0.clone()).collect();
        let bounds = py.detach(|| self.0.bounds(&experiments, &named, sigma)).or_raise()?;
        Ok(bounds.names.iter().filter_map(|name| Some((name.clone(), bounds.deviation(name)?))).collect())
    }
}

fn several(curves: &Bound<'_, PyAny>) -> PyResult<Vec<id::Curve>> {
    if let Ok(curve) = curves.cast::<Curve>() {
        return Ok(vec![curve.get().0.clone()]);
    }
    let needed = "curves: a Curve or a sequence of them is needed";
    let curves: Vec<Bound<'_, Curve>> = curves.extract().map_err(|_| PyTypeError::new_err(needed))?;
    Ok(curves.iter().map(|curve| curve.get().0.clone()).collect())
}

fn named(values: &Bound<'_, PyDict>) -> PyResult<Vec<(String, f64)>> {
    values.iter().map(|(name, value)| Ok((name.extract()?, value.extract()?))).collect()
}

/// One identified parameter.
#[pyclass(frozen, module = "viscocontact")]
pub struct Estimate(id::Estimate);

#[pymethods]
impl Estimate {
    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Its value, in SI units.
    #[getter]
    fn value(&self) -> f64 {
        self.0.value
    }

    /// Standard deviation: relative for moduli, times and stiffness.
    #[getter]
    fn deviation(&self) -> f64 {
        self.0.deviation
    }

    /// The same from the scatter of the residuals, without an assumption on the noise.
    #[getter]
    fn robust_deviation(&self) -> f64 {
        self.0.robust_deviation
    }

    /// Interval of 95 %.
    #[getter]
    fn interval(&self) -> (f64, f64) {
        self.0.interval.into()
    }

    fn __repr__(&self) -> String {
        format!(
            "Estimate({}={:e}, 95 %: {:e} to {:e})",
            self.0.name, self.0.value, self.0.interval[0], self.0.interval[1]
        )
    }
}

/// The result of a fit: `fit["E0"]` is the estimate of a parameter.
#[pyclass(frozen, module = "viscocontact")]
pub struct Fit(id::Fit);

#[pymethods]
impl Fit {
    /// The identified parameters, of the material first.
    #[getter]
    fn estimates(&self) -> Vec<Estimate> {
        self.0.estimates().iter().cloned().map(Estimate).collect()
    }

    fn __getitem__(&self, name: &str) -> PyResult<Estimate> {
        self.0.estimate(name).cloned().map(Estimate).ok_or_else(|| {
            let names: Vec<&str> = self.0.estimates().iter().map(|estimate| &*estimate.name).collect();
            PyKeyError::new_err(format!("no parameter is named {name:?}: there are {}", names.join(", ")))
        })
    }

    /// Correlation of two parameters; None without one of them.
    fn correlation(&self, one: &str, other: &str) -> Option<f64> {
        self.0.correlation(one, other)
    }

    /// The contact modulus E*(t) [Pa] at times after a sudden step [s].
    fn modulus<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        mapped("t", t, |t| self.0.modulus(t))
    }

    /// The relative standard deviation of `modulus`.
    fn modulus_deviation<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        mapped("t", t, |t| self.0.modulus_band(t)[1])
    }

    /// The shear modulus [Pa] for a known Poisson's ratio, at a time [s].
    fn shear_modulus(&self, t: f64, nu: f64) -> PyResult<f64> {
        self.0.shear_modulus(t, nu).or_raise()
    }

    /// The incompressible body of the identified contact modulus, against a rigid tip, for contacts.
    fn material(&self, py: Python<'_>) -> PyResult<Material> {
        let material = self.0.material().or_raise()?;
        let spectrum = material.contact_spectrum().or_raise()?;
        let spectrum = spectrum.ok_or_else(|| PyTypeError::new_err("this model has no exact exponential series"))?;
        let shear = spectrum.scaled(SHEAR_OVER_CONTACT).or_raise()?;
        let arguments = (shear.glassy(), shear.fluidity(), shear.terms().to_vec());
        let rheology = Py::new(py, Rheology::made(py, "generalized_kelvin", arguments, Arc::new(shear))?)?;
        Ok(Material::by(Recipe::new(py, "", (rheology,))?, material))
    }

    /// Force of the fit at each time of a curve [N], and measured less fitted force.
    #[pyo3(signature = (curve=0))]
    fn force<'py>(&self, py: Python<'py>, curve: usize) -> (Bound<'py, PyAny>, Bound<'py, PyAny>) {
        let array = |values: &[f64]| values.to_vec().into_pyarray(py).into_any();
        (array(self.0.force(curve)), array(self.0.residuals(curve)))
    }

    /// What a user should know before the parameters are used, a line each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings().iter().map(ToString::to_string).collect()
    }

    /// Standard deviation of the noise [N].
    #[getter]
    fn sigma(&self) -> f64 {
        self.0.sigma()
    }

    /// Akaike's criterion, corrected for the number of samples: less is better.
    #[getter]
    fn aicc(&self) -> f64 {
        self.0.aicc()
    }

    /// Probability of residuals as extreme by their runs of one sign, and by their correlations, if the model is right.
    #[getter]
    fn probabilities(&self) -> (f64, f64) {
        (self.0.runs().probability, self.0.correlations().probability)
    }

    /// All values of a parameter for which the best fit of the others is not significantly worse.
    #[pyo3(signature = (name, confidence=0.95))]
    fn profile_interval(&self, py: Python<'_>, name: &str, confidence: f64) -> PyResult<(f64, f64)> {
        py.detach(|| self.0.profile_interval(name, confidence)).or_raise().map(Into::into)
    }

    /// The contact point of a curve [m].
    #[pyo3(signature = (curve=0))]
    fn contact_point(&self, curve: usize) -> f64 {
        self.0.contact_point(curve)
    }

    fn __repr__(&self) -> String {
        let all: Vec<String> =
            self.0.estimates().iter().map(|of| format!("{}={:e} ± {:.1e}", of.name, of.value, of.deviation)).collect();
        format!("Fit({})", all.join(", "))
    }
}

/// J over C of an incompressible body.
const SHEAR_OVER_CONTACT: f64 = 4.0;
