//! Moduli from measured indentation curves, with their uncertainty.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicUsize;

use viscocontact_identify as id;

use crate::curves::{Curve, Experiment, model};
use crate::fits::Fit;
use crate::prelude::*;

/// What is known of a property of each curve: one for all, or a list with one for each.
fn per_curve(name: &str, given: &Object<'_>) -> PyResult<Option<id::PerCurve>> {
    match given.cast::<pyo3::types::PyList>() {
        Ok(each) => {
            let each = each.iter().map(|known| Ok(nuisance(name, &known)?.unwrap_or(id::Nuisance::Fixed(0.0))));
            each.collect::<PyResult<Vec<_>>>().map(|each| Some(each.into()))
        }
        Err(_) => Ok(nuisance(name, given)?.map(Into::into)),
    }
}

/// What is known of a property of the measurement: None (fixed at 0 by default), a number (fixed), True (fitted), or ("from", start).
fn nuisance(name: &str, given: &Object<'_>) -> PyResult<Option<id::Nuisance>> {
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

/// A property of the measurement, by name.
type OfCurves = (&'static str, fn(id::Identification, id::PerCurve) -> id::Identification);

const OF_CURVES: [OfCurves; 6] = [
    ("contact_point", id::Identification::contact_point),
    ("offset", id::Identification::offset),
    ("drift", id::Identification::drift),
    ("tilt", id::Identification::tilt),
    ("drag", id::Identification::drag),
    ("stiffness", id::Identification::stiffness),
];

const OPTIONS: &str = "contact_point offset drift tilt drag stiffness noise known_sigma robust fix start";

/// The identification with an option of this name.
fn option(of: id::Identification, name: &str, given: &Object<'_>) -> PyResult<id::Identification> {
    let mut curves = OF_CURVES.iter();
    if let Some((_, set)) = curves.find(|(own, _)| *own == name) {
        return Ok(if_given(of, per_curve(name, given)?, set));
    }
    let names = of.model().parameters();
    let each = |of: id::Identification, give: fn(id::Identification, &str, f64) -> id::Identification| {
        named(given.cast()?)?.into_iter().try_fold(of, |of, (name, value)| match names.contains(&name) {
            true => Ok(give(of, &name, value)),
            false => Err(id::Error::UnknownParameter { name, names: names.join(", ") }).or_raise(),
        })
    };
    match name {
        "noise" => Ok(of.noise(match (given.extract::<f64>(), given.extract::<&str>()) {
            (Ok(coefficient), _) => id::Noise::AutoregressiveWith(coefficient),
            (_, Ok("white")) => id::Noise::White,
            (_, Ok("autoregressive")) => id::Noise::Autoregressive,
            _ => return Err(PyTypeError::new_err("noise: \"white\", \"autoregressive\" or its coefficient is needed")),
        })),
        "known_sigma" => Ok(of.known_sigma(given.extract()?)),
        "robust" => Ok(if given.extract()? { of.robust() } else { of }),
        "fix" => each(of, id::Identification::fix),
        "start" => each(of, id::Identification::start),
        _ => Err(unexpected("Identification", name, OPTIONS)),
    }
}

made! {
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
    Identification(pub of: id::Identification)
}

#[pymethods]
impl Identification {
    #[new]
    #[pyo3(
        signature = (model, **options),
        text_signature = "(model, *, contact_point=None, offset=None, drift=None, tilt=None, drag=None, stiffness=None, noise=None, known_sigma=None, robust=False, fix=None, start=None)"
    )]
    fn new(py: Python<'_>, model: Value<'_>, options: Option<Value<'_>>) -> PyResult<Identification> {
        let options =
            options.map_or_else(|| Ok(PyDict::new(py)), |given| Ok::<_, PyErr>(given.0.cast_into::<PyDict>()?))?;
        let mut of = id::Identification::new(self::model(&model)?);
        let twice = |name: Object<'_>| PyTypeError::new_err(format!("give {name} in fix or in start, not in both"));
        if let (Ok(Some(fix)), Ok(Some(start))) = (options.get_item("fix"), options.get_item("start")) {
            let both = fix.try_iter()?.flatten().find(|name| start.contains(name).unwrap_or(false));
            both.map_or(Ok(()), |name| Err(twice(name)))?;
        }
        for (name, given) in &options {
            if !given.is_none() {
                of = option(of, name.extract()?, &given)?;
            }
        }
        of.check().or_raise()?;
        Ok(Identification::by(Recipe::new(py, "", (model,))?.with_keywords(Some(&options))?, of))
    }

    /// Fits a curve, or several of one material together.
    ///
    /// `progress` is called without arguments, some times in each step of the search; the fit ends with `Cancelled` where it returns False. Ctrl-C
    /// ends it, too.
    ///
    /// Raises ValueError if the curves do not suit, ConvergenceError if the search does not converge.
    #[pyo3(signature = (curves, *, progress=None))]
    fn fit(slf: Bound<'_, Self>, curves: &Object<'_>, progress: Option<Function>) -> PyResult<Fit> {
        let (curves, tips) = several(curves)?;
        let of = slf.get().of.clone();
        let fit = watched(slf.py(), progress, |watch| of.watched(watch).fit(&curves))?;
        Ok(Fit { fit, by: slf.unbind(), of_curve: None, tips })
    }

    /// Fits each curve alone, on all cores, as those of a force map: a list of fits, and of exceptions where one failed.
    ///
    /// `progress` is called after each fit with the part that is done; where it returns False, the others are not fitted: `Cancelled` is in their
    /// place. Ctrl-C ends the call.
    #[pyo3(signature = (curves, *, progress=None))]
    fn fit_each(slf: Bound<'_, Self>, curves: &Object<'_>, progress: Option<Function>) -> PyResult<Vec<Py<PyAny>>> {
        let (py, (curves, tips)) = (slf.py(), several(curves)?);
        let (done, total) = (AtomicUsize::new(0), curves.len() as f64);
        let (ended, kept) = (Arc::new(AtomicBool::new(false)), Kept::default());
        let told = |_: &id::Result<id::Fit>| {
            let share = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / total;
            if !kept.number(goes_on(progress.as_ref(), (share,)), false) {
                ended.store(true, Ordering::Relaxed);
            }
        };
        let own = slf.get().of.clone();
        let fits = kept.raise_or(watched(py, None, |watch| {
            let ended = Arc::clone(&ended);
            let goes_on = move || if ended.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { watch() };
            Ok(own.watched(goes_on).fit_each(&curves, told))
        }))?;
        let of = |(curve, fit): (usize, id::Result<id::Fit>)| match fit.or_raise() {
            Ok(fit) => {
                let (by, tips) = (slf.clone().unbind(), vec![tips[curve].clone_ref(py)]);
                Ok(Py::new(py, Fit { fit, by, of_curve: Some(curve), tips })?.into_any())
            }
            Err(error) => Ok(error.into_value(py).into_any()),
        };
        fits.into_iter().enumerate().map(of).collect()
    }

    /// Force [N] and depth [m] at each time of an experiment, for parameters of the material by name.
    fn respond<'py>(
        &self,
        py: Python<'py>,
        experiment: &Experiment,
        values: &Dict<'py>,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let named = named(values)?;
        let named: Vec<(&str, f64)> = named.iter().map(|(name, value)| (&**name, *value)).collect();
        let samples = free(py, || self.of.respond(&experiment.of, &named)).or_raise()?;
        let (force, depth) = samples.iter().map(|sample| (sample.force, sample.depth)).unzip();
        Ok((line(py, force)?, line(py, depth)?))
    }

    /// The minimum standard deviations that any unbiased estimate from experiments can have, by parameter: relative for moduli, times and
    /// stiffness. `sigma` [N] is the noise.
    fn bounds(
        &self,
        py: Python<'_>,
        experiments: Vec<Bound<'_, Experiment>>,
        values: &Dict<'_>,
        sigma: f64,
    ) -> PyResult<std::collections::BTreeMap<String, f64>> {
        let named = named(values)?;
        let named: Vec<(&str, f64)> = named.iter().map(|(name, value)| (&**name, *value)).collect();
        let experiments: Vec<id::Experiment> =
            experiments.iter().map(|experiment| experiment.get().of.clone()).collect();
        let bounds = free(py, || self.of.bounds(&experiments, &named, sigma)).or_raise()?;
        Ok(bounds.names.iter().filter_map(|name| Some((name.clone(), bounds.deviation(name)?))).collect())
    }
}

getters! {Identification.of, of:
    /// Names of the parameters of the model.
    parameters: Vec<String> = of.model().parameters();
}

/// Fits of the same curves, best first, each with its difference of Akaike's criterion from the best and its weight among all: a list of
/// (fit, difference, weight). Exceptions, as `Identification.fit_each` returns them, are left out.
///
/// Raises ValueError if fits are of different curves.
///
/// >>> experiment = Experiment.trapezoid(1e-6, (0.2, 0.5, 0.2), 0.05, ElasticStates.sphere(5e-6))
/// >>> force, _ = Identification("maxwell").respond(experiment, {"E0": 2e3, "tau": 0.5})
/// >>> fits = [Identification(model).fit(Curve(experiment, force)) for model in ("elastic", "maxwell")]
/// >>> ranked(fits)[0][0].model
/// 'Maxwell'
#[pyfunction]
pub fn ranked(fits: Vec<Object<'_>>) -> PyResult<Vec<(Bound<'_, Fit>, f64, f64)>> {
    let fits: Vec<Bound<'_, Fit>> = fits.into_iter().filter_map(|fit| fit.cast_into::<Fit>().ok()).collect();
    let ranked = id::ranked(fits.iter().map(|fit| Ok(fit.get().fit.clone()))).or_raise()?;
    let place = |(fit, difference, weight): (id::Fit, f64, f64)| {
        let own = fits.iter().find(|own| own.get().fit.state() == fit.state() && own.get().fit.model() == fit.model());
        own.map(|own| (own.clone(), difference, weight))
    };
    Ok(ranked.into_iter().filter_map(place).collect())
}

type Several = (Vec<id::Curve>, Vec<Py<ElasticStates>>);

/// The curves of the crate, and their tips.
pub fn several(curves: &Object<'_>) -> PyResult<Several> {
    let own = |curve: &Bound<'_, Curve>| (curve.get().of.clone(), curve.get().tip.clone_ref(curve.py()));
    if let Ok(curve) = curves.cast::<Curve>() {
        return Ok([own(curve)].into_iter().unzip());
    }
    let needed = "curves: a Curve or a sequence of them is needed";
    let curves: Vec<Bound<'_, Curve>> = curves.extract().map_err(|_| PyTypeError::new_err(needed))?;
    Ok(curves.iter().map(own).unzip())
}

/// What ends a search where it breaks.
pub type Watch = Box<dyn Fn() -> ControlFlow<()> + Send + Sync>;

/// Computes what is watched: Ctrl-C ends it, and a report of progress that returns False.
pub fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<Function>,
    job: impl FnOnce(Watch) -> id::Result<T> + Send,
) -> PyResult<T> {
    let cancel = Arc::<AtomicBool>::default();
    let (flag, kept) = (Arc::clone(&cancel), Kept::default());
    let kept_of = kept.clone();
    let watch = move || {
        let is_on = !flag.load(Ordering::Relaxed) && kept_of.number(goes_on(progress.as_ref(), ()), false);
        // once it has ended, it does not go on
        flag.store(!is_on, Ordering::Relaxed);
        if is_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let mut failed = None;
    let result = kept.raise_or(interruptible(py, true, &cancel, || match job(Box::new(watch)) {
        Ok(value) => Ok(Some(value)),
        Err(id::Error::Contact(error)) => Err(error),
        Err(error) => {
            failed = Some(error);
            Ok(None)
        }
    }))?;
    match failed {
        Some(error) => Err(error).or_raise(),
        None => result.ok_or_else(|| PyRuntimeError::new_err("the fit has no result")),
    }
}

fn named(values: &Dict<'_>) -> PyResult<Vec<(String, f64)>> {
    values.iter().map(|(name, value)| Ok((name.extract()?, value.extract()?))).collect()
}
