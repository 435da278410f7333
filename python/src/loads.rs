//! Loads and their histories.

use std::sync::Arc;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use viscocontact::load::{self as ld, LoadHistory as History};

use crate::arrays::column;
use crate::errors::{OrRaise, raise};
use crate::recipe::{Recipe, Reduced};

/// The load on a rigid body at the end of a step: a force, an approach, or a spring that drives it.
///
/// >>> Load.force(1.0), Load.approach(1e-6), Load.spring(10.0, 2e-6)
/// (Load.force(1.0), Load.approach(1e-06), Load.spring(10.0, 2e-06))
#[pyclass(frozen, module = "viscocontact")]
pub struct Load {
    pub load: ld::Load,
    recipe: Recipe,
}

#[pymethods]
impl Load {
    /// A normal force [N] on a body that cannot tilt; with `at` [m], at this point of a body that tilts freely; with `tilt` [rad], on
    /// a body of these tilts.
    #[staticmethod]
    #[pyo3(signature = (normal, *, at=None, tilt=None))]
    fn force(py: Python<'_>, normal: f64, at: Option<[f64; 2]>, tilt: Option<[f64; 2]>) -> PyResult<Load> {
        let load = match (at, tilt) {
            (None, None) => ld::Load::force(normal),
            (Some(at), None) => ld::Load::eccentric_force(normal, at),
            (None, Some(tilt)) => ld::Load::force_and_tilt(normal, tilt),
            _ => return Err(PyTypeError::new_err("give at or tilt, not both")),
        };
        let keywords = pyo3::types::PyDict::new(py);
        for (name, value) in [("at", at), ("tilt", tilt)] {
            if let Some(value) = value {
                keywords.set_item(name, value)?;
            }
        }
        Ok(Load { load, recipe: Recipe::new(py, "force", (normal,))?.with_keywords(Some(&keywords)) })
    }

    /// An approach of the origin [m], and tilts along x1 and x2 [rad].
    #[staticmethod]
    #[pyo3(signature = (approach, tilt=[0.0; 2]))]
    fn approach(py: Python<'_>, approach: f64, tilt: [f64; 2]) -> PyResult<Load> {
        let recipe = if tilt == [0.0; 2] {
            Recipe::new(py, "approach", (approach,))?
        } else {
            Recipe::new(py, "approach", (approach, tilt))?
        };
        Ok(Load { load: ld::Load::approach_and_tilt(approach, tilt), recipe })
    }

    /// A spring of `stiffness` [N/m] whose far end is at `drive` [m].
    #[staticmethod]
    fn spring(py: Python<'_>, stiffness: f64, drive: f64) -> PyResult<Load> {
        Ok(Load { load: ld::Load::spring(stiffness, drive), recipe: Recipe::new(py, "spring", (stiffness, drive))? })
    }

    fn __eq__(&self, other: &Load) -> bool {
        self.load == other.load
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.get().recipe.repr(&slf.get_type())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        slf.get().recipe.reduce(slf.get_type())
    }
}

/// A load for every time [s].
///
/// Wherever a history is needed, a `Load` (held from t = 0 on), a sequence of (time, load) joined by straight lines, and a function of
/// time that returns a `Load` do as well.
///
/// >>> ramp = LoadHistory.ramp(Load.force(0), Load.force(2), 1.0)
/// >>> ramp.at(0.25)
/// Load.force(0.5)
#[pyclass(frozen, module = "viscocontact")]
pub struct LoadHistory {
    pub history: Arc<dyn History>,
    recipe: Recipe,
}

impl LoadHistory {
    fn made<'py>(
        py: Python<'py>,
        maker: &'static str,
        arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
        history: Arc<dyn History>,
    ) -> PyResult<LoadHistory> {
        Ok(LoadHistory { history, recipe: Recipe::new(py, maker, arguments)? })
    }
}

/// Loads at times, from a sequence of (time, load).
fn rows(table: &Bound<'_, PyAny>) -> PyResult<Vec<(f64, ld::Load)>> {
    let rows: Vec<(f64, Bound<'_, Load>)> = table.extract()?;
    Ok(rows.into_iter().map(|(t, load)| (t, load.get().load)).collect())
}

#[pymethods]
impl LoadHistory {
    /// Loads at ascending times, linear in between, from a sequence of (time [s], load). Two rows of the same time are a jump.
    #[staticmethod]
    fn table(py: Python<'_>, table: Bound<'_, PyAny>) -> PyResult<LoadHistory> {
        let history = ld::PiecewiseLinear::new(&rows(&table)?).or_raise()?;
        LoadHistory::made(py, "table", (table,), Arc::new(history))
    }

    /// Forces [N] at times [s], two arrays, linear in between.
    #[staticmethod]
    fn forces(py: Python<'_>, times: Bound<'_, PyAny>, forces: Bound<'_, PyAny>) -> PyResult<LoadHistory> {
        let history = of_columns(&times, "forces", &forces, ld::Load::force)?;
        LoadHistory::made(py, "forces", (times, forces), Arc::new(history))
    }

    /// Approaches [m] at times [s], two arrays, linear in between.
    #[staticmethod]
    fn approaches(py: Python<'_>, times: Bound<'_, PyAny>, approaches: Bound<'_, PyAny>) -> PyResult<LoadHistory> {
        let history = of_columns(&times, "approaches", &approaches, ld::Load::approach)?;
        LoadHistory::made(py, "approaches", (times, approaches), Arc::new(history))
    }

    /// A load held from t = 0 on.
    #[staticmethod]
    fn held(py: Python<'_>, load: Bound<'_, Load>) -> PyResult<LoadHistory> {
        let history = ld::StepLoad::new(load.get().load).or_raise()?;
        LoadHistory::made(py, "held", (load,), Arc::new(history))
    }

    /// Linear from one load to another from t = 0 on within `duration` [s], then constant.
    #[staticmethod]
    fn ramp(py: Python<'_>, start: Bound<'_, Load>, end: Bound<'_, Load>, duration: f64) -> PyResult<LoadHistory> {
        let history = ld::Ramp::new(start.get().load, end.get().load, duration).or_raise()?;
        LoadHistory::made(py, "ramp", (start, end, duration), Arc::new(history))
    }

    /// Oscillation between two loads with `frequency` [Hz], from their mean at t = 0, rising.
    #[staticmethod]
    fn sinusoid(py: Python<'_>, low: Bound<'_, Load>, high: Bound<'_, Load>, frequency: f64) -> PyResult<LoadHistory> {
        let history = ld::Sinusoid::new(low.get().load, high.get().load, frequency).or_raise()?;
        LoadHistory::made(py, "sinusoid", (low, high, frequency), Arc::new(history))
    }

    /// A sequence of (time [s], load) that repeats without end.
    #[staticmethod]
    fn periodic(py: Python<'_>, table: Bound<'_, PyAny>) -> PyResult<LoadHistory> {
        let history = ld::Periodic::new(&rows(&table)?).or_raise()?;
        LoadHistory::made(py, "periodic", (table,), Arc::new(history))
    }

    /// The first load for the part `duty` of each `period` [s], then the second.
    #[staticmethod]
    #[pyo3(signature = (first, second, period, duty=0.5))]
    fn square(
        py: Python<'_>,
        first: Bound<'_, Load>,
        second: Bound<'_, Load>,
        period: f64,
        duty: f64,
    ) -> PyResult<LoadHistory> {
        let history = ld::Periodic::square(first.get().load, second.get().load, period, duty).or_raise()?;
        LoadHistory::made(py, "square", (first, second, period, duty), Arc::new(history))
    }

    /// Linear from one load to another in half of each `period` [s], and back.
    #[staticmethod]
    fn triangle(py: Python<'_>, start: Bound<'_, Load>, end: Bound<'_, Load>, period: f64) -> PyResult<LoadHistory> {
        let history = ld::Periodic::triangle(start.get().load, end.get().load, period).or_raise()?;
        LoadHistory::made(py, "triangle", (start, end, period), Arc::new(history))
    }

    /// Linear from one load to another in each `period` [s], and back at once.
    #[staticmethod]
    fn sawtooth(py: Python<'_>, start: Bound<'_, Load>, end: Bound<'_, Load>, period: f64) -> PyResult<LoadHistory> {
        let history = ld::Periodic::sawtooth(start.get().load, end.get().load, period).or_raise()?;
        LoadHistory::made(py, "sawtooth", (start, end, period), Arc::new(history))
    }

    /// A function of time [s] that returns a `Load`, smooth but for corners at `breakpoints` [s], where steps end.
    ///
    /// An exception of the function comes out of the step that needed the load.
    #[staticmethod]
    #[pyo3(signature = (load, breakpoints=vec![]))]
    fn function(py: Python<'_>, load: Py<PyAny>, breakpoints: Vec<f64>) -> PyResult<LoadHistory> {
        let kept = load.clone_ref(py);
        let call = move |t: f64| {
            Python::attach(|py| {
                let load = load.call1(py, (t,))?;
                let load = load.bind(py);
                load.cast::<Load>().map(|load| load.get().load).map_err(|_| {
                    let class = load.get_type();
                    PyTypeError::new_err(format!("the load history returned {class} at {t} s, not a Load"))
                })
            })
        };
        let history = ld::FnHistory::fallible(call).with_breakpoints(&breakpoints).or_raise()?;
        LoadHistory::made(py, "function", (kept, breakpoints), Arc::new(history))
    }

    /// The load at a time [s].
    fn at(&self, py: Python<'_>, t: f64) -> PyResult<Load> {
        let load = self.history.at(t);
        if let Some(failure) = self.history.failure() {
            return Err(raise(&failure.into()));
        }
        let numbers = |tilt: [ld::Tilt; 2]| -> PyResult<([f64; 2], bool)> {
            match tilt {
                [ld::Tilt::Fixed(a), ld::Tilt::Fixed(b)] => Ok(([a, b], false)),
                [ld::Tilt::Free { at: a }, ld::Tilt::Free { at: b }] => Ok(([a, b], true)),
                _ => Err(PyValueError::new_err("one tilt is fixed and the other free")),
            }
        };
        match load {
            ld::Load::Force { normal, tilt } => match numbers(tilt)? {
                ([0.0, 0.0], false) => Load::force(py, normal, None, None),
                (tilt, false) => Load::force(py, normal, None, Some(tilt)),
                (at, true) => Load::force(py, normal, Some(at), None),
            },
            ld::Load::Approach { approach, tilt } => Load::approach(py, approach, numbers(tilt)?.0),
            ld::Load::Spring { stiffness, drive, .. } => Load::spring(py, stiffness, drive),
            _ => Err(PyValueError::new_err("this kind of load has no name in Python")),
        }
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.get().recipe.repr(&slf.get_type())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        slf.get().recipe.reduce(slf.get_type())
    }
}

fn of_columns(
    times: &Bound<'_, PyAny>,
    name: &str,
    values: &Bound<'_, PyAny>,
    load: fn(f64) -> ld::Load,
) -> PyResult<ld::PiecewiseLinear> {
    let (times, values) = (column("times", times)?, column(name, values)?);
    if times.len() != values.len() {
        let (n, m) = (times.len(), values.len());
        return Err(PyValueError::new_err(format!("{name}: {m} given, {n} needed, one for each time")));
    }
    ld::PiecewiseLinear::new(&times.into_iter().zip(values.into_iter().map(load)).collect::<Vec<_>>()).or_raise()
}

/// Any history: a `LoadHistory`, a load that is held, a sequence of (time, load), or a function.
pub fn history(given: &Bound<'_, PyAny>) -> PyResult<Arc<dyn History>> {
    let py = given.py();
    if let Ok(history) = given.cast::<LoadHistory>() {
        return Ok(Arc::clone(&history.get().history));
    }
    if let Ok(load) = given.cast::<Load>() {
        return Ok(Arc::new(ld::StepLoad::new(load.get().load).or_raise()?));
    }
    if given.is_callable() {
        return Ok(LoadHistory::function(py, given.clone().unbind(), vec![])?.history);
    }
    let needed =
        "load: a Load, a LoadHistory, a sequence of (time, Load), or a function of time that returns a Load is needed";
    let rows = rows(given).map_err(|_| PyTypeError::new_err(needed))?;
    Ok(Arc::new(ld::PiecewiseLinear::new(&rows).or_raise()?))
}

/// The loads of a step: one, or one for each body.
pub fn loads(given: &Bound<'_, PyAny>) -> PyResult<Vec<ld::Load>> {
    if let Ok(load) = given.cast::<Load>() {
        return Ok(vec![load.get().load]);
    }
    let needed = "load: a Load is needed, or a sequence with one for each body";
    let loads: Vec<Bound<'_, Load>> = given.extract().map_err(|_| PyTypeError::new_err(needed))?;
    Ok(loads.iter().map(|load| load.get().load).collect())
}
