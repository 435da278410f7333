//! Fits: identified parameters, and what the curves determine.

use pyo3::exceptions::{PyIndexError, PyKeyError};
use viscocontact_identify as id;

use crate::curves::Curve;
use crate::errors::replace;
use crate::identify::{Identification, several, watched};
use crate::pictures::Picture;
use crate::prelude::*;

/// One identified parameter.
///
/// >>> experiment = Experiment.trapezoid(1e-6, (0.2, 0.5, 0.2), 0.05, ElasticStates.sphere(5e-6))
/// >>> maxwell = Identification("maxwell")
/// >>> fit = maxwell.fit(Curve(experiment, maxwell.respond(experiment, {"E0": 2e3, "tau": 0.5})[0]))
/// >>> fit["tau"].name, round(fit["tau"].value, 6), fit["tau"].scale
/// ('tau', 0.5, 'logarithm')
#[pyclass(frozen, module = "viscocontact")]
pub struct Estimate {
    of: id::Estimate,
    fit: Py<Fit>,
}

#[pymethods]
impl Estimate {
    fn __repr__(&self) -> String {
        format!("Estimate({})", self.of)
    }

    #[allow(clippy::type_complexity)]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Object<'py>, (Py<Fit>, &str))> {
        Ok((py.get_type::<Fit>().getattr("__getitem__")?, (self.fit.clone_ref(py), &self.of.name)))
    }

    fn __eq__(&self, other: &Estimate) -> bool {
        self.of == other.of
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        visit.call(&self.fit)
    }
}

getters! {Estimate.of, of:
    /// Its name.
    name: &str = &of.name;
    /// Its value, in SI units.
    value: f64 = of.value;
    /// Standard deviation on its `scale`: relative for moduli, times and stiffness, of ln(x/(1 − x)) for exponents, else in the unit of the value. Infinite
    /// of a parameter without effect at its `limit`.
    deviation: f64 = of.deviation;
    /// Interval of 95 %.
    interval: (f64, f64) = of.interval.into();
    /// The scale of the deviations: "logarithm", "logit" (ln(x/(1 − x)), of exponents) or "linear".
    scale: String = format!("{:?}", of.scale).to_lowercase();
    /// The limit at which the parameter is, where the model is a simpler one; None elsewhere.
    limit: Option<&'static str> = of.limit;
}

/// The result of a fit: `fit["E0"]` is the estimate of a parameter, `fit["contact_point"]` that of a keyword, `fit.material()` the body for a contact.
///
/// >>> experiment = Experiment.trapezoid(1e-6, (0.2, 0.5, 0.2), 0.05, ElasticStates.sphere(5e-6))
/// >>> maxwell = Identification("maxwell")
/// >>> fit = maxwell.fit(Curve(experiment, maxwell.respond(experiment, {"E0": 2e3, "tau": 0.5})[0]))
/// >>> round(fit.modulus(0.5) / fit.modulus(0.0), 4)     # exp(-1)
/// 0.3679
#[pyclass(frozen, module = "viscocontact")]
pub struct Fit {
    pub fit: id::Fit,
    pub by: Py<Identification>,
    /// The curve of a list that it was, for which the identification may have values of its own.
    pub of_curve: Option<usize>,
    pub tips: Vec<Py<ElasticStates>>,
}

/// A fit in a pickle: what makes it again, and the identification, its curves, the one of a list that it was, and the numbers found.
type Pickled<'py> = (Object<'py>, (Py<Identification>, Vec<Curve>, Option<usize>, State));
type State = (Vec<f64>, Vec<(f64, [f64; 2], Vec<f64>)>, bool, usize, Option<f64>);

#[pymethods]
impl Fit {
    fn __getitem__(slf: Bound<'_, Self>, name: &str) -> PyResult<Estimate> {
        let fit = &slf.get().fit;
        let Some(of) = fit.estimate(&slf.get().named(name)).cloned() else {
            let names: Vec<&str> = fit.estimates().iter().map(|estimate| &*estimate.name).collect();
            return Err(PyKeyError::new_err(format!("no parameter is named {name:?}: there are {}", names.join(", "))));
        };
        Ok(Estimate { of, fit: slf.unbind() })
    }

    /// The identified parameters, of the material first.
    #[getter]
    fn estimates(slf: Bound<'_, Self>) -> Vec<Estimate> {
        let all = slf.get().fit.estimates().iter();
        all.map(|of| Estimate { of: of.clone(), fit: slf.clone().unbind() }).collect()
    }

    /// The fit of a pickle: without a search.
    #[staticmethod]
    fn _again(
        by: Bound<'_, Identification>,
        curves: &Object<'_>,
        of_curve: Option<usize>,
        state: State,
    ) -> PyResult<Fit> {
        let (coordinates, noise, means, iterations, above) = state;
        let (curves, tips) = several(curves)?;
        let state = id::FitState { coordinates, noise, means, iterations, above };
        let own = of_curve.map_or_else(|| by.get().of.clone(), |curve| by.get().of.of_curve(curve));
        Ok(Fit { fit: state.fit(&own, &curves).or_raise()?, by: by.unbind(), of_curve, tips })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        let curve = |(of, tip): (&id::Curve, &Py<ElasticStates>)| Curve { of: of.clone(), tip: tip.clone_ref(py) };
        let curves = self.fit.curves().iter().zip(&self.tips).map(curve).collect();
        let state = self.fit.state();
        let state = (state.coordinates, state.noise, state.means, state.iterations, state.above);
        let again = py.get_type::<Fit>().getattr("_again")?;
        Ok((again, (self.by.clone_ref(py), curves, self.of_curve, state)))
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        visit.call(&self.by)?;
        self.tips.iter().try_for_each(|tip| visit.call(tip))
    }

    /// Covariance of two parameters on their scales (`Estimate.scale`); None without one of them.
    fn covariance(&self, one: &str, other: &str) -> Option<f64> {
        self.fit.covariance(&self.named(one), &self.named(other))
    }

    /// Correlation of two parameters; None without one of them.
    fn correlation(&self, one: &str, other: &str) -> Option<f64> {
        self.fit.correlation(&self.named(one), &self.named(other))
    }

    /// The contact modulus E*(t) [Pa] at times after a sudden step [s].
    fn modulus<'py>(&self, t: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("t", t, FROM_ZERO, |t| self.fit.modulus(t), never)
    }

    /// The relative standard deviation of `modulus`.
    fn modulus_deviation<'py>(&self, t: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("t", t, FROM_ZERO, |t| self.fit.modulus_band(t)[1], never)
    }

    /// The shear modulus [Pa] for a known Poisson's ratio, at a time [s].
    fn shear_modulus(&self, t: f64, nu: f64) -> PyResult<f64> {
        self.fit.shear_modulus(t, nu).or_raise()
    }

    /// The incompressible body of the identified contact modulus, against a rigid tip, for contacts.
    fn material(&self, py: Python<'_>) -> PyResult<Material> {
        let material = self.fit.material().or_raise()?;
        let spectrum = material.contact_spectrum().or_raise()?;
        let spectrum = spectrum.ok_or_else(|| PyTypeError::new_err("this model has no exact exponential series"))?;
        let shear = spectrum.scaled(SHEAR_OVER_CONTACT).or_raise()?;
        let arguments = (shear.glassy(), shear.fluidity(), shear.terms().to_vec());
        let rheology = Py::new(py, Rheology::by(Recipe::new(py, "generalized_kelvin", arguments)?, shear))?;
        Ok(Material::by(Recipe::new(py, "", (rheology,))?, material))
    }

    /// Force of the fit at each time of a curve [N], and measured less fitted force.
    #[pyo3(signature = (curve=0))]
    fn force<'py>(&self, py: Python<'py>, curve: usize) -> PyResult<(Object<'py>, Object<'py>)> {
        self.check(curve)?;
        let array = |values: &[f64]| values.to_vec().into_pyarray(py).into_any();
        Ok((array(self.fit.force(curve)), array(self.fit.residuals(curve))))
    }

    /// All values of a parameter for which the best fit of the others is not significantly worse.
    #[pyo3(signature = (name, confidence=0.95))]
    fn profile_interval(&self, py: Python<'_>, name: &str, confidence: f64) -> PyResult<(f64, f64)> {
        let name = self.named(name);
        self.watched(py, |fit| fit.profile_interval(&name, confidence)).map(Into::into)
    }

    /// The decades of time that the curves determine: dicts of "times" [s], "modulus" that relaxes there [Pa], its "deviation" [Pa], and
    /// "is_determined".
    fn decades<'py>(&self, py: Python<'py>) -> PyResult<Vec<Dict<'py>>> {
        let decades = self.watched(py, id::Fit::decades)?;
        let of = |of: id::Decade| {
            let times: (f64, f64) = of.times.into();
            Ok(dict! { py; of { modulus, deviation, is_determined }, "times": times })
        };
        decades.into_iter().map(of).collect()
    }

    /// Computes a curve once more in space, cell by cell, with the identified material under a `shape` on a `grid`: the force at each sample
    /// [N], and the maximum difference from the fit over its maximum force. Keywords are those of `ViscoelasticContact`.
    ///
    /// >>> experiment = Experiment.trapezoid(1e-6, (0.2, 0.5, 0.2), 0.05, ElasticStates.sphere(5e-6))
    /// >>> maxwell = Identification("maxwell")
    /// >>> fit = maxwell.fit(Curve(experiment, maxwell.respond(experiment, {"E0": 2e3, "tau": 0.5})[0]))
    /// >>> force, difference = fit.verify(Grid(64, 6e-6), Shape.sphere(5e-6))
    /// >>> difference < 0.02
    /// True
    #[pyo3(signature = (grid, shape, *, curve=0, **options))]
    fn verify<'py>(
        &self,
        py: Python<'py>,
        grid: &Grid,
        shape: &Object<'py>,
        curve: usize,
        options: Option<&Dict<'py>>,
    ) -> PyResult<(Array<'py>, f64)> {
        let scene = builder(grid, shape, &self.material(py)?, options)?;
        let of = self.watched(py, |fit| fit.verify(curve, &scene))?;
        Ok((line(py, of.force)?, of.difference))
    }

    /// What the answer depends on: fits of the same curves under another assumption ("drift", "tilt", "correlated noise", "no outliers"):
    /// dicts of the "assumption", "times" [s], the "ratios" of their moduli to those of this fit, and "aicc_difference".
    fn variants<'py>(&self, py: Python<'py>) -> PyResult<Vec<Dict<'py>>> {
        let of = |of: id::Variant| {
            let (times, ratios) = (of.times.to_vec(), of.ratios.to_vec());
            Ok(dict! { py; of { assumption, aicc_difference }, "times": times, "ratios": ratios })
        };
        self.watched(py, |fit| fit.variants())?.into_iter().map(of).collect()
    }

    /// The fit of a curve at each of its times, as arrays: "time" [s], "force" [N], "depth" and "contact_depth" [m].
    #[pyo3(signature = (curve=0))]
    fn samples<'py>(&self, py: Python<'py>, curve: usize) -> PyResult<Dict<'py>> {
        self.check(curve)?;
        let samples = self.fit.samples(curve);
        let column = |of: fn(&id::Sample) -> f64| samples.iter().map(of).collect::<Vec<_>>().into_pyarray(py);
        Ok(dict! { py;
            "time": self.fit.curves()[curve].experiment().protocol().times().to_vec().into_pyarray(py),
            "force": column(|sample| sample.force),
            "depth": column(|sample| sample.depth),
            "contact_depth": column(|sample| sample.contact_depth),
        })
    }

    /// A picture of a curve: measured and fitted force, residuals and modulus.
    #[pyo3(signature = (curve=0))]
    fn picture(&self, py: Python<'_>, curve: usize) -> PyResult<Picture> {
        free(py, || self.fit.picture(curve)).or_raise().map(Picture)
    }

    /// The contact point of a curve [m].
    #[pyo3(signature = (curve=0))]
    fn contact_point(&self, curve: usize) -> PyResult<f64> {
        self.check(curve)?;
        Ok(self.fit.contact_point(curve))
    }

    fn __repr__(&self) -> String {
        let all: Vec<String> = self.fit.estimates().iter().map(id::Estimate::to_string).collect();
        format!("Fit({})", all.join("; "))
    }
}

getters! {Fit.fit, of:
    /// The model.
    model: String = of.model().to_string();
    /// Number of curves.
    curves: usize = of.curves().len();
    /// Coefficient of the autoregressive noise; None of white noise.
    autoregression: Option<f64> = of.autoregression_of(0);
    /// Iterations of the search.
    iterations: usize = of.iterations();
    /// Samples with the tip in contact.
    points_in_contact: usize = of.points_in_contact();
    /// Standard deviation of the residuals over that of the noise, 1 if the model is right, and over the maximum force.
    misfit: (f64, f64) = of.misfit().into();
    /// What a user should know before the parameters are used, a line each.
    warnings: Vec<String> = of.warnings().iter().map(in_python).collect();
    /// Standard deviation of the noise [N].
    sigma: f64 = of.sigma();
    /// Akaike's criterion, corrected for the number of samples: less is better.
    aicc: f64 = of.aicc();
    /// Probability of correlations of the residuals as great, if the model is right.
    probability: f64 = of.probability();
}

impl Fit {
    /// Computes what Ctrl-C ends.
    fn watched<T: Send>(&self, py: Python<'_>, job: impl FnOnce(&id::Fit) -> id::Result<T> + Send) -> PyResult<T> {
        watched(py, None, |watch| job(&self.fit.clone().watched(watch)))
    }

    /// The name of a parameter, which may be that of its keyword.
    fn named(&self, name: &str) -> String {
        let spaced = name.replace('_', " ");
        if self.fit.estimate(&spaced).is_some() { spaced } else { name.to_string() }
    }

    fn check(&self, curve: usize) -> PyResult<()> {
        let n = self.fit.curves().len();
        if curve < n { Ok(()) } else { Err(PyIndexError::new_err(format!("curve {curve} of {n}"))) }
    }
}

/// Writes a table of fits as a CSV file with a row for each parameter.
///
/// >>> import pathlib, tempfile
/// >>> experiment = Experiment.trapezoid(1e-6, (0.2, 0.5, 0.2), 0.05, ElasticStates.sphere(5e-6))
/// >>> maxwell = Identification("maxwell")
/// >>> fit = maxwell.fit(Curve(experiment, maxwell.respond(experiment, {"E0": 2e3, "tau": 0.5})[0]))
/// >>> path = pathlib.Path(tempfile.mkdtemp(), "fits.csv")
/// >>> write_fits(path, [fit])
/// >>> "tau" in path.read_text()
/// True
#[pyfunction]
pub fn write_fits(py: Python<'_>, path: PathBuf, fits: Vec<Bound<'_, Fit>>) -> PyResult<()> {
    let summaries: Vec<id::Summary> = fits.iter().map(|fit| fit.get().fit.summary()).collect();
    let mut file = Vec::new();
    free(py, || id::Summary::write_csv(&summaries, &mut file)).or_raise()?;
    replace(&path, &file)
}

/// J over C of an incompressible body.
const SHEAR_OVER_CONTACT: f64 = 4.0;
