//! Loads and their histories.

use crate::prelude::*;
use viscocontact::load::{self as ld, LoadHistory as History};

made! {
    /// The load on a rigid body at the end of a step: a force, an approach, or a spring that drives it.
    ///
    /// >>> Load.force(1.0), Load.approach(1e-6), Load.spring(10.0, 2e-6)
    /// (Load.force(1.0), Load.approach(1e-06), Load.spring(10.0, 2e-06))
    #[pyclass(frozen, module = "viscocontact")]
    Load(pub load: ld::Load)
}

/// A number for each axis; None where another property of the axis is given.
pub type Tilts = Option<[Option<f64>; 2]>;

/// The tilt along each axis: free about the coordinate of `at`, or the angle of `tilt`, 0 without.
pub fn tilts(at: Tilts, tilt: Tilts) -> PyResult<[ld::Tilt; 2]> {
    let (at, tilt) = (at.unwrap_or_default(), tilt.unwrap_or_default());
    let along = |axis: usize| match (at[axis], tilt[axis]) {
        (Some(_), Some(_)) => Err(PyTypeError::new_err("give at or tilt along an axis, not both: None for the other")),
        (Some(at), None) => Ok(ld::Tilt::Free { at }),
        (None, tilt) => Ok(ld::Tilt::Fixed(tilt.unwrap_or(0.0))),
    };
    Ok([along(0)?, along(1)?])
}

impl Load {
    pub fn of(py: Python<'_>, load: ld::Load) -> PyResult<Load> {
        let recipe = match load {
            ld::Load::Force { normal, .. } => Recipe::new(py, "force", (normal,)),
            ld::Load::Approach { approach, .. } => Recipe::new(py, "approach", (approach,)),
            ld::Load::Spring { stiffness, drive, .. } => Recipe::new(py, "spring", (stiffness, drive)),
            _ => Err(PyValueError::new_err("this kind of load has no name in Python")),
        }?;
        let free = load.tilt().map(|tilt| if let ld::Tilt::Free { at } = tilt { Some(at) } else { None });
        let fixed = load.tilt().map(|tilt| if let ld::Tilt::Fixed(angle) = tilt { Some(angle) } else { None });
        let keywords = PyDict::new(py);
        if free != [None; 2] {
            keywords.set_item("at", PyTuple::new(py, free)?)?;
        }
        if fixed.iter().flatten().any(|angle| *angle != 0.0) {
            keywords.set_item("tilt", PyTuple::new(py, fixed)?)?;
        }
        Ok(Load::by(recipe.with_keywords(Some(&keywords))?, load))
    }
}

#[pymethods]
impl Load {
    /// A normal force [N] on a body that cannot tilt; with `at` [m], at this point of a body that tilts freely; with `tilt` [rad], on
    /// a body of these tilts. Both are pairs along x1 and x2, with None along an axis of the other kind.
    ///
    /// >>> Load.force(5.0, at=(1e-3, None))    # a hinge: free along x1, guided along x2
    /// Load.force(5.0, at=(0.001, None))
    #[staticmethod]
    #[pyo3(signature = (normal, *, at=None, tilt=None))]
    fn force(py: Python<'_>, normal: f64, at: Tilts, tilt: Tilts) -> PyResult<Load> {
        Load::of(py, ld::Load::Force { normal, tilt: tilts(at, tilt)? })
    }

    /// An approach of the origin [m], or of the point `at` [m] of a body that tilts freely, and tilts along x1 and x2 [rad].
    #[staticmethod]
    #[pyo3(signature = (approach, tilt=None, *, at=None))]
    fn approach(py: Python<'_>, approach: f64, tilt: Tilts, at: Tilts) -> PyResult<Load> {
        Load::of(py, ld::Load::Approach { approach, tilt: tilts(at, tilt)? })
    }

    /// A spring of `stiffness` [N/m] whose far end is at `drive` [m]; `at` and `tilt` as of `force`.
    #[staticmethod]
    #[pyo3(signature = (stiffness, drive, *, at=None, tilt=None))]
    fn spring(py: Python<'_>, stiffness: f64, drive: f64, at: Tilts, tilt: Tilts) -> PyResult<Load> {
        Load::of(py, ld::Load::Spring { stiffness, drive, tilt: tilts(at, tilt)? })
    }
}

made! {
    /// A load for every time [s].
    ///
    /// Wherever a history is needed, a `Load` (held from t = 0 on), a sequence of (time, load) joined by straight lines, and a function of
    /// time that returns a `Load` do as well.
    ///
    /// >>> ramp = LoadHistory.ramp(Load.force(0), Load.force(2), 1.0)
    /// >>> ramp.at(0.25)
    /// Load.force(0.5)
    #[pyclass(frozen, module = "viscocontact")]
    LoadHistory(pub history: Arc<dyn History>) of impl History + 'static => Arc::new
}

/// Loads at times, from a sequence of (time, load).
fn rows(table: &Object<'_>) -> PyResult<Vec<(f64, ld::Load)>> {
    let rows: Vec<(f64, Bound<'_, Load>)> = table.extract()?;
    Ok(rows.into_iter().map(|(t, load)| (t, load.get().load)).collect())
}

makers! {LoadHistory, py:
    /// Loads at ascending times, linear in between, from a sequence of (time [s], load). Two rows of the same time are a jump.
    table(table: Value<'_>) = ld::PiecewiseLinear::new(&rows(&table)?);

    /// A load held from t = 0 on.
    held(load: Bound<'_, Load>) = ld::StepLoad::new(load.get().load);

    /// Linear from one load to another from t = 0 on within `duration` [s], then constant.
    ramp(start: Bound<'_, Load>, end: Bound<'_, Load>, duration: f64) =
        ld::Ramp::new(start.get().load, end.get().load, duration);

    /// Oscillation between two loads with `frequency` [Hz], from their mean at t = 0, rising.
    sinusoid(low: Bound<'_, Load>, high: Bound<'_, Load>, frequency: f64) =
        ld::Sinusoid::new(low.get().load, high.get().load, frequency);

    /// Oscillation about the load `mean` with an `amplitude` of its force, approach or drive and a `frequency` [Hz], from the mean at t = 0.
    sinusoid_about(mean: Bound<'_, Load>, amplitude: f64, frequency: f64) =
        ld::Sinusoid::about(mean.get().load, amplitude, frequency);

    /// A sequence of (time [s], load) that repeats without end.
    periodic(table: Value<'_>) = ld::Periodic::new(&rows(&table)?);

    /// The first load for the part `duty` of each `period` [s], then the second.
    #[pyo3(signature = (first, second, period, duty=0.5))]
    square(first: Bound<'_, Load>, second: Bound<'_, Load>, period: f64, duty: f64) =
        ld::Periodic::square(first.get().load, second.get().load, period, duty);

    /// Linear from one load to another in half of each `period` [s], and back.
    triangle(start: Bound<'_, Load>, end: Bound<'_, Load>, period: f64) =
        ld::Periodic::triangle(start.get().load, end.get().load, period);

    /// Linear from one load to another in each `period` [s], and back at once.
    sawtooth(start: Bound<'_, Load>, end: Bound<'_, Load>, period: f64) =
        ld::Periodic::sawtooth(start.get().load, end.get().load, period);

    /// Forces [N] at times [s], two arrays, linear in between.
    forces(times: Value<'_>, forces: Value<'_>) = of_columns(&times, "forces", &forces, ld::Load::force)?;

    /// Approaches [m] at times [s], two arrays, linear in between.
    approaches(times: Value<'_>, approaches: Value<'_>) =
        of_columns(&times, "approaches", &approaches, ld::Load::approach)?;

}

#[pymethods]
impl LoadHistory {
    /// A function of time [s] that returns a `Load`, smooth but for corners at `breakpoints` [s], where steps end.
    ///
    /// A run asks for loads of its whole time before the first step, for the maximum ones: the function must be defined up to `until` and
    /// depend on the time alone. (A load that depends on the contact is for a loop over `step`.) An exception comes out of the step that
    /// needed the load, in a run often the first.
    #[staticmethod]
    #[pyo3(signature = (load, breakpoints=vec![]))]
    fn function(py: Python<'_>, load: Function, breakpoints: Vec<f64>) -> PyResult<LoadHistory> {
        let function = load.clone();
        let call = move |t: f64| {
            Python::attach(|py| {
                let load = function.0.bind(py).call1((t,))?;
                load.cast::<Load>().map(|load| load.get().load).map_err(|_| {
                    let class = load.get_type();
                    PyTypeError::new_err(format!("the load history returned {class} at {t} s, not a Load"))
                })
            })
        };
        let made = ld::FnHistory::fallible(call).with_breakpoints(&breakpoints).or_raise()?;
        Ok(LoadHistory::by(Recipe::new(py, "function", (load.clone(), breakpoints))?.calling([load]), made))
    }

    /// The load at a time [s].
    fn at(&self, py: Python<'_>, t: f64) -> PyResult<Load> {
        let load = self.history.at(t);
        nothing_raised(self.history.failure())?;
        Load::of(py, load)
    }

    /// Checks the laws of histories at times [s]: a load everywhere, breakpoints that ascend, smooth in between. Raises ValueError with the
    /// first violation.
    fn check(&self, py: Python<'_>, times: &Object<'_>) -> PyResult<()> {
        let times = column("times", times)?;
        let verdict = free(py, || ld::laws::all(&*self.history, &times));
        no_violation(self.history.failure(), verdict)
    }
}

fn of_columns(
    times: &Object<'_>,
    name: &str,
    values: &Object<'_>,
    load: fn(f64) -> ld::Load,
) -> PyResult<viscocontact::Result<ld::PiecewiseLinear>> {
    let rows = together(["times", name], times, values)?.into_iter().map(|(t, value)| (t, load(value)));
    Ok(ld::PiecewiseLinear::new(&rows.collect::<Vec<_>>()))
}

impl LoadHistory {
    /// Any history: a `LoadHistory`, a load that is held, a sequence of (time, load), or a function.
    pub fn any<'py>(given: &Object<'py>) -> PyResult<Bound<'py, LoadHistory>> {
        let py = given.py();
        if let Ok(history) = given.cast::<LoadHistory>() {
            return Ok(history.clone());
        }
        let made = if let Ok(load) = given.cast::<Load>() {
            LoadHistory::held(py, load.clone())
        } else if given.is_callable() {
            LoadHistory::function(py, given.extract()?, vec![])
        } else {
            let given: Value<'_> = given.extract()?;
            let needed = "load: a Load, a LoadHistory, a sequence of (time, Load), or a function of time that returns a Load is needed";
            rows(&given).map_err(|_| PyTypeError::new_err(needed))?;
            LoadHistory::table(py, given)
        };
        Bound::new(py, made?)
    }
}

/// The history of the crate.
pub fn history(given: &Object<'_>) -> PyResult<Arc<dyn History>> {
    Ok(Arc::clone(&LoadHistory::any(given)?.get().history))
}

/// The histories of a run: one, or a sequence with one for each body.
pub fn histories<'py>(given: &Object<'py>) -> PyResult<Vec<Bound<'py, LoadHistory>>> {
    let one = match LoadHistory::any(given) {
        Ok(one) => return Ok(vec![one]),
        Err(error) => error,
    };
    let each = given.extract::<Vec<Object<'_>>>().ok().filter(|each| !each.is_empty());
    let each = each.and_then(|each| each.iter().map(LoadHistory::any).collect::<PyResult<_>>().ok());
    each.ok_or(one)
}

/// The loads of a step: one, or one for each body.
pub fn loads(given: &Object<'_>) -> PyResult<Vec<ld::Load>> {
    if let Ok(load) = given.cast::<Load>() {
        return Ok(vec![load.get().load]);
    }
    let needed = || {
        PyTypeError::new_err(format!(
            "load: Load.force or Load.approach of a number is needed, or a sequence with one for each body, not {given}"
        ))
    };
    let loads: Vec<Bound<'_, Load>> = given.extract().map_err(|_| needed())?;
    Ok(loads.iter().map(|load| load.get().load).collect())
}
