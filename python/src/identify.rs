//! Moduli from measured indentation curves, with their uncertainty.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact_identify as id;

use crate::arrays::{Array, to_array};
use crate::curves::{Curve, Experiment, model};
use crate::errors::OrRaise;
use crate::fits::Fit;

/// What is known of a property of each curve: one for all, or a list with one for each.
fn per_curve(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Option<id::PerCurve>> {
    match given.cast::<pyo3::types::PyList>() {
        Ok(each) => {
            let each = each.iter().map(|known| Ok(nuisance(name, &known)?.unwrap_or(id::Nuisance::Fixed(0.0))));
            each.collect::<PyResult<Vec<_>>>().map(|each| Some(each.into()))
        }
        Err(_) => Ok(nuisance(name, given)?.map(Into::into)),
    }
}

/// What is known of a property of the measurement: None (fixed at 0 by default), a number (fixed), True (fitted), or ("from", start).
fn nuisance(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Option<id::Nuisance>> {
    if given.is_none() {
        return Ok(None);
    }
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
/// model : "elastic", "maxwell", "zener", ("prony", n), ("power_law", cutoff [s]), ("power_law_solid", cutoff [s]), "stretched" or "fractional_zener"
/// contact_point, offset, drift, tilt, drag, stiffness : float (known), True (fitted), or ("from", start)
///     Drive at first touch [m], force without contact [N], its growth in time [N/s] and with the drive [N/m], force over the speed of the
///     drive [N s/m], and the stiffness of the spring [N/m] in place of that of the experiments. A list has one for each curve.
/// noise : "white" (default), "autoregressive", or the coefficient of an autoregressive noise
/// known_sigma : float, optional
///     Standard deviation of the noise [N].
/// robust : bool
///     Whether outliers lose their weight.
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
    #[pyo3(signature = (model, *, contact_point=None, offset=None, drift=None, tilt=None, drag=None, stiffness=None, noise=None, known_sigma=None, robust=false, fix=None, start=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        model: &Bound<'_, PyAny>,
        contact_point: Option<&Bound<'_, PyAny>>,
        offset: Option<&Bound<'_, PyAny>>,
        drift: Option<&Bound<'_, PyAny>>,
        tilt: Option<&Bound<'_, PyAny>>,
        drag: Option<&Bound<'_, PyAny>>,
        stiffness: Option<&Bound<'_, PyAny>>,
        noise: Option<&Bound<'_, PyAny>>,
        known_sigma: Option<f64>,
        robust: bool,
        fix: Option<&Bound<'_, PyDict>>,
        start: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Identification> {
        type Setter = fn(id::Identification, id::PerCurve) -> id::Identification;
        let mut identification = id::Identification::new(self::model(model)?);
        let nuisances: [(&str, Option<&Bound<'_, PyAny>>, Setter); 6] = [
            ("contact_point", contact_point, id::Identification::contact_point),
            ("offset", offset, id::Identification::offset),
            ("drift", drift, id::Identification::drift),
            ("tilt", tilt, id::Identification::tilt),
            ("drag", drag, id::Identification::drag),
            ("stiffness", stiffness, id::Identification::stiffness),
        ];
        for (name, given, set) in nuisances {
            if let Some(known) = given.map(|given| per_curve(name, given)).transpose()?.flatten() {
                identification = set(identification, known);
            }
        }
        if robust {
            identification = identification.robust();
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
        let names = identification.model().parameters();
        if let (Some(fix), Some(start)) = (fix, start) {
            for name in start.keys() {
                if fix.contains(&name)? {
                    return Err(PyTypeError::new_err(format!("give {name} in fix or in start, not in both")));
                }
            }
        }
        type Give = fn(id::Identification, &str, f64) -> id::Identification;
        for (given, give) in [(fix, id::Identification::fix as Give), (start, id::Identification::start)] {
            for (name, value) in given.map(named).transpose()?.unwrap_or_default() {
                if !names.contains(&name) {
                    return Err(id::Error::UnknownParameter { name, names: names.join(", ") }).or_raise();
                }
                identification = give(identification, &name, value);
            }
        }
        Ok(Identification(identification))
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

getters! {Identification, of:
    /// Names of the parameters of the model.
    parameters: Vec<String> = of.model().parameters();
}

/// Fits of the same curves, best first, each with its difference of Akaike's criterion from the best and its weight among all: a list of
/// (fit, difference, weight). Exceptions, as `Identification.fit_each` returns them, are left out.
///
/// Raises ValueError if fits are of different curves.
#[pyfunction]
pub fn ranked(fits: Vec<Bound<'_, PyAny>>) -> PyResult<Vec<(Fit, f64, f64)>> {
    let fits: Vec<id::Fit> =
        fits.iter().filter_map(|fit| fit.cast::<Fit>().ok()).map(|fit| fit.get().0.clone()).collect();
    let ranked = id::ranked(fits.into_iter().map(Ok)).or_raise()?;
    Ok(ranked.into_iter().map(|(fit, difference, weight)| (Fit(fit), difference, weight)).collect())
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
