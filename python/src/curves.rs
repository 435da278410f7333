//! Measured indentation curves, and the experiments behind them.

use viscocontact::load::LoadHistory as _;
use viscocontact_identify as id;

use crate::measured::text_table;
use crate::prelude::*;

/// A drive and the tip that it presses onto the sample, before the force is measured.
///
/// Parameters
/// ----------
/// times : sequence of float
///     Ascending [s].
/// drive : sequence of float
///     The depth of the tip, or with `stiffness` the position of the base that carries it [m].
/// tip : ElasticStates
/// stiffness : float, optional
///     Of the spring between base and tip [N/m]: the cantilever.
///
/// >>> tip = ElasticStates.sphere(5e-6)
/// >>> experiment = Experiment.trapezoid(1e-6, (1.0, 3.0, 1.0), 0.5, tip)
/// >>> len(experiment.times), float(experiment.drive.max())
/// (11, 1e-06)
#[pyclass(frozen, module = "viscocontact")]
pub struct Experiment {
    pub of: id::Experiment,
    pub tip: Py<ElasticStates>,
}

impl Experiment {
    fn of(protocol: id::Protocol, tip: &Bound<'_, ElasticStates>, stiffness: Option<f64>) -> PyResult<Experiment> {
        let of = id::Experiment::new(protocol, Arc::clone(&tip.get().states));
        let of = stiffness.map_or(Ok(of.clone()), |stiffness| of.with_spring(stiffness)).or_raise()?;
        Ok(Experiment { of, tip: tip.clone().unbind() })
    }

    fn recipe(&self, py: Python<'_>) -> PyResult<Recipe> {
        let keywords = PyDict::new(py);
        // a spring that is rigid is none
        if let Some(stiffness) = Some(self.of.stiffness()).filter(|stiffness| stiffness.is_finite()) {
            keywords.set_item("stiffness", stiffness)?;
        }
        Recipe::new(py, "", (self.times(py), self.drive(py), &self.tip))?.with_keywords(Some(&keywords))
    }
}

calls!(Experiment);

#[pymethods]
impl Experiment {
    #[new]
    #[pyo3(signature = (times, drive, tip, *, stiffness=None))]
    fn new(
        times: &Object<'_>,
        drive: &Object<'_>,
        tip: &Bound<'_, ElasticStates>,
        stiffness: Option<f64>,
    ) -> PyResult<Experiment> {
        let protocol = id::Protocol::new(column("times", times)?, column("drive", drive)?).or_raise()?;
        Experiment::of(protocol, tip, stiffness)
    }

    /// The drive as the load history of a contact: approaches, or springs.
    fn load_history(&self, py: Python<'_>) -> PyResult<LoadHistory> {
        let history = self.of.load_history().or_raise()?;
        let loads = self.of.protocol().times().iter().map(|&t| Ok((t, Load::of(py, history.at(t))?)));
        let rows = loads.collect::<PyResult<Vec<(f64, Load)>>>()?;
        LoadHistory::table(py, Value(rows.into_pyobject(py)?.into_any()))
    }

    /// The times [s].
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Object<'py> {
        self.of.protocol().times().to_vec().into_pyarray(py).into_any()
    }

    /// The drive [m].
    #[getter]
    fn drive<'py>(&self, py: Python<'py>) -> Object<'py> {
        self.of.protocol().drive().to_vec().into_pyarray(py).into_any()
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        visit.call(&self.tip)
    }
}

/// Experiments by their drive, with a tip, perhaps on a spring.
macro_rules! protocols {
    ($($(#[$doc:meta])* $name:ident($($arg:ident: $type:ty),*) = $made:expr;)*) => {
        #[pymethods]
        impl Experiment {
            $(
                $(#[$doc])*
                #[staticmethod]
                #[pyo3(signature = ($($arg,)* tip, *, stiffness=None))]
                #[allow(clippy::too_many_arguments)]
                fn $name($($arg: $type,)* tip: &Bound<'_, ElasticStates>, stiffness: Option<f64>) -> PyResult<Experiment> {
                    Experiment::of($made.or_raise()?, tip, stiffness)
                }
            )*
        }
    };
}

protocols! {
    /// From 0 to `depth` [m], held there, and back, within the `durations` of rise, hold and fall [s], sampled at `interval` [s].
    trapezoid(depth: f64, durations: [f64; 3], interval: f64) = id::Protocol::trapezoid(depth, durations, interval);

    /// A ramp at `speed` [m/s] from `distance` [m] above the surface to the drive `depth` [m], a hold [s], and the way back: the force curve of
    /// an AFM, where the drive is the position of the base.
    ramp_hold_retract(speed: f64, distance: f64, depth: f64, hold: f64, interval: f64) =
        id::Protocol::ramp_hold_retract(speed, [distance, depth], hold, interval);

    /// Each of the `depths` [m] is approached in the time `rise` [s] and held for `dwell` [s]; samples at `interval` [s].
    staircase(depths: Vec<f64>, rise: f64, dwell: f64, interval: f64) =
        id::Protocol::staircase(&depths, rise, dwell, interval);
}

/// A measured curve: an experiment and the force [N] at each of its times, positive where it presses.
///
/// Raises ValueError if the lengths differ or a value is NaN.
///
/// >>> experiment = Experiment([0.0, 0.5, 1.0], [0.0, 0.5e-6, 1e-6], ElasticStates.sphere(5e-6))
/// >>> curve = Curve(experiment, [0.0, 1e-9, 3e-9])
/// >>> len(curve), len(curve.within(0.0, 0.9))
/// (3, 2)
#[pyclass(frozen, module = "viscocontact")]
pub struct Curve {
    pub of: id::Curve,
    pub tip: Py<ElasticStates>,
}

impl Curve {
    /// A part of this curve.
    fn part(&self, py: Python<'_>, of: id::Result<id::Curve>) -> PyResult<Curve> {
        Ok(Curve { of: of.or_raise()?, tip: self.tip.clone_ref(py) })
    }

    fn recipe(&self, py: Python<'_>) -> PyResult<Recipe> {
        Recipe::new(py, "", (self.experiment(py), self.force(py)?))
    }
}

calls!(Curve);

#[pymethods]
impl Curve {
    #[new]
    fn new(experiment: &Experiment, force: &Object<'_>) -> PyResult<Curve> {
        let of = id::Curve::new(experiment.of.clone(), column("force", force)?).or_raise()?;
        Ok(Curve { of, tip: experiment.tip.clone_ref(force.py()) })
    }

    /// The force [N].
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        line(py, self.of.force().to_vec())
    }

    /// The part from the first time to before the last one [s].
    fn within(&self, py: Python<'_>, first: f64, last: f64) -> PyResult<Curve> {
        self.part(py, self.of.within(first..last))
    }

    /// The part until the drive first comes near its maximum.
    fn approach(&self, py: Python<'_>) -> PyResult<Curve> {
        self.part(py, self.of.approach())
    }

    /// The part until the drive leaves its maximum: approach and hold.
    fn loading(&self, py: Python<'_>) -> PyResult<Curve> {
        self.part(py, self.of.loading())
    }

    /// The part until the force returns to the base line: without the pull-off of a tip that sticks.
    fn until_release(&self, py: Python<'_>) -> PyResult<Curve> {
        self.part(py, self.of.until_release())
    }

    /// The force below the base line [N], where the tip is drawn back to the sample; None where noise explains it.
    fn pull_off(&self) -> Option<f64> {
        self.of.pull_off()
    }

    /// Oliver and Pharr: the modulus of the unloading, for comparison; off by the creep meanwhile. `area` is the cross section of the tip [m²]
    /// at a distance from its end [m], a function: 2πR h of a paraboloid. "stiffness" [N/m], "contact_depth" [m], "area" [m²], "modulus" [Pa].
    ///
    /// >>> tip = ElasticStates.sphere(10e-6)
    /// >>> experiment = Experiment.trapezoid(0.2e-6, (1.0, 1.0, 1.0), 0.01, tip)
    /// >>> force, _ = Identification("elastic").respond(experiment, {"E": 1e9})
    /// >>> read = Curve(experiment, force).oliver_pharr(0.0, lambda h: 6.2832 * 10e-6 * h)
    /// >>> abs(read["modulus"] / 1e9 - 1) < 0.02
    /// True
    fn oliver_pharr<'py>(&self, py: Python<'py>, contact_point: f64, area: Function) -> PyResult<Dict<'py>> {
        let area = |h: f64| raised_number(area.call((h,)), f64::NAN);
        let of = free(py, || id::usual::oliver_pharr(&self.of, contact_point, area)).or_raise()?;
        Ok(dict! { py; of { stiffness, contact_depth, area, modulus } })
    }

    /// Checks points, signs and units; raises ValueError with the remedy.
    fn check(&self) -> PyResult<()> {
        self.of.check().or_raise()
    }

    /// The complex contact modulus of an oscillation of the drive at `frequency` [Hz] in a window of times [s], with its drive at first
    /// touch [m]: E′ + iE″ [Pa] and the standard errors of both.
    fn complex_modulus(
        &self,
        frequency: f64,
        window: (f64, f64),
        contact_point: f64,
    ) -> PyResult<(numpy::Complex64, (f64, f64))> {
        let of = self.of.complex_modulus(frequency, window.0..window.1, contact_point).or_raise()?;
        Ok((numpy::Complex64::new(of.storage, of.loss), (of.storage_error, of.loss_error)))
    }

    /// The elastic modulus of the approach: "modulus" [Pa], "offset" [N], "contact_point" [m].
    #[pyo3(signature = (contact_point=None))]
    fn loading_modulus<'py>(&self, py: Python<'py>, contact_point: Option<f64>) -> PyResult<Dict<'py>> {
        let of = free(py, || id::usual::loading_modulus(&self.of, contact_point)).or_raise()?;
        Ok(dict! { py; of { modulus, offset, contact_point } })
    }

    /// The relaxation of a hold as E∞ + E₁ exp(−t/τ), with the `correction` of its ramp ("step", "half_ramp" or "factor"): "equilibrium",
    /// "relaxing" and their sum "glassy" [Pa], "time" [s].
    #[pyo3(signature = (contact_point=0.0, correction="factor"))]
    fn hold_relaxation<'py>(&self, py: Python<'py>, contact_point: f64, correction: &str) -> PyResult<Dict<'py>> {
        use id::usual::RampCorrection::{Factor, HalfRamp, Step};
        let correction =
            choice("correction", correction, &[("step", Step), ("half_ramp", HalfRamp), ("factor", Factor)])?;
        let of = free(py, || id::usual::hold_relaxation(&self.of, contact_point, correction)).or_raise()?;
        Ok(dict! { py; of { equilibrium, glassy, time }, "relaxing": of.glassy - of.equilibrium })
    }

    /// The experiment.
    #[getter]
    fn experiment(&self, py: Python<'_>) -> Experiment {
        Experiment { of: self.of.experiment().clone(), tip: self.tip.clone_ref(py) }
    }

    fn __len__(&self) -> usize {
        self.of.force().len()
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        visit.call(&self.tip)
    }
}

/// A column of a recording, by name.
type Column = (&'static str, fn(&id::Recording) -> Option<&Vec<f64>>);

const COLUMNS: [Column; 5] = [
    ("time", |of| Some(&of.times)),
    ("force", |of| of.force.as_ref()),
    ("deflection", |of| of.deflection.as_ref()),
    ("drive", |of| of.drive.as_ref()),
    ("depth", |of| of.depth.as_ref()),
];

/// The columns of a measured curve, from arrays or a text file with headings.
///
/// Parameters
/// ----------
/// times : sequence of float
///     [s]
/// force, deflection, drive, depth : sequence of float, optional
///     Force [N], positive where it presses; deflection of the spring, position of its base, depth of the tip [m].
///
/// >>> import numpy as np
/// >>> t = np.linspace(0.0, 1.0, 20)
/// >>> recording = Recording(t, force=3e-9 * t**1.5, depth=1e-6 * t)
/// >>> len(recording.curve(ElasticStates.sphere(5e-6)))
/// 20
#[pyclass(frozen, module = "viscocontact")]
pub struct Recording(id::Recording);

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (times, *, force=None, deflection=None, drive=None, depth=None))]
    fn new(
        times: &Object<'_>,
        force: Option<&Object<'_>>,
        deflection: Option<&Object<'_>>,
        drive: Option<&Object<'_>>,
        depth: Option<&Object<'_>>,
    ) -> PyResult<Recording> {
        let times = column("times", times)?;
        let n = times.len();
        let given = |name: &str, values: Option<&Object<'_>>| -> PyResult<Option<Vec<f64>>> {
            let values = values.map(|values| column(name, values)).transpose()?;
            one_for_each("time", name, values.as_ref().map_or(n, Vec::len), n)?;
            Ok(values)
        };
        let (force, deflection) = (given("force", force)?, given("deflection", deflection)?);
        let (drive, depth) = (given("drive", drive)?, given("depth", depth)?);
        let recording = id::Recording { times, force, deflection, drive, depth, columns: Vec::new() };
        let refused = |what: &str| Err(PyValueError::new_err(what.to_owned()));
        if !recording.times.is_sorted_by(|one, next| one < next) {
            return refused("times: they must ascend, each once");
        }
        if COLUMNS[1..].iter().all(|(_, column)| column(&recording).is_none()) {
            return refused("give force or deflection, and drive or depth: there is no column but the times");
        }
        Ok(Recording(recording))
    }

    /// Reads a text file whose headings name the columns and their units, with the keywords of `Measurements.from_csv`.
    #[staticmethod]
    #[pyo3(
        signature = (path, **reading),
        text_signature = "(path, *, decimal_comma=None, delimiter=None, skipped_lines=0, headings=None, only=None)"
    )]
    fn from_csv(py: Python<'_>, path: PathBuf, reading: Option<&Dict<'_>>) -> PyResult<Recording> {
        let table = text_table(&path, None, reading)?;
        free(py, || id::Recording::from_table(&table)).or_raise().map(Recording)
    }

    /// The same with the other sign of force and deflection.
    fn flip_force(&self) -> Recording {
        Recording(self.0.clone().flip_force())
    }

    /// The same with the other sign of drive and depth.
    fn flip_drive(&self) -> Recording {
        Recording(self.0.clone().flip_drive())
    }

    /// The columns taken from a file: name, number of the column from 0, and its heading.
    #[getter]
    fn columns(&self) -> Vec<(&str, usize, &str)> {
        self.0.columns.iter().map(|taken| (taken.name(), taken.index(), taken.heading())).collect()
    }

    /// The arrays of a pickle; what a file named its columns is not kept.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, of) = (slf.py(), &slf.get().0);
        let array = |values: Option<&Vec<f64>>| values.map(|values| values.to_vec().into_pyarray(py));
        let keywords = PyDict::new(py);
        COLUMNS[1..].iter().try_for_each(|(name, column)| keywords.set_item(name, array(column(of))))?;
        let recipe = Recipe::new(py, "", (of.times.clone().into_pyarray(py),))?;
        recipe.with_keywords(Some(&keywords))?.reduce(slf.get_type())
    }

    fn __eq__(&self, other: &Recording) -> bool {
        self.0 == other.0
    }

    fn __repr__(&self) -> String {
        let given = COLUMNS[1..].iter().filter(|(_, column)| column(&self.0).is_some());
        let names: Vec<&str> = given.map(|(name, _)| *name).collect();
        format!("Recording({} times, {})", self.0.times.len(), names.join(", "))
    }

    /// A column by its name: "time", "force", "deflection", "drive" or "depth"; None without it.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Object<'py>>> {
        let column = choice("name", if name == "times" { "time" } else { name }, &COLUMNS)?(&self.0);
        Ok(column.map(|column| column.to_vec().into_pyarray(py).into_any()))
    }

    /// The curve of a `tip`: with the depth as its drive, or with `stiffness` [N/m] the position of the base of a spring.
    #[pyo3(signature = (tip, *, stiffness=None))]
    fn curve(&self, tip: &Bound<'_, ElasticStates>, stiffness: Option<f64>) -> PyResult<Curve> {
        let of = match stiffness {
            Some(stiffness) => self.0.spring_curve(&tip.get().states, stiffness),
            None => self.0.depth_curve(&tip.get().states),
        };
        Ok(Curve { of: of.or_raise()?, tip: tip.clone().unbind() })
    }
}

/// The model of a name, or of a pair of name and number of terms or cutoff [s].
pub fn model(given: &Object<'_>) -> PyResult<id::Model> {
    if let Ok((name, terms)) = given.extract::<(String, i64)>()
        && name == "prony"
    {
        let terms = usize::try_from(terms).ok().filter(|terms| (1..=MOST_TERMS).contains(terms));
        let needed = || {
            PyValueError::new_err(format!(
                "terms of \"prony\" = {given} is not allowed: they must be 1 to {MOST_TERMS}"
            ))
        };
        return terms.map(id::Model::Prony).ok_or_else(needed);
    }
    match given.extract::<(String, f64)>() {
        Ok((name, cutoff)) if name == "power_law" => return Ok(id::Model::PowerLaw { cutoff }),
        Ok((name, cutoff)) if name == "power_law_solid" => return Ok(id::Model::PowerLawSolid { cutoff }),
        _ => {}
    }
    let needed = "model: a name, (\"prony\", terms) or (\"power_law\", cutoff) is needed";
    let name: String = given.extract().map_err(|_| PyTypeError::new_err(needed))?;
    let models = [
        ("elastic", id::Model::Elastic),
        ("maxwell", id::Model::Maxwell),
        ("zener", id::Model::Zener),
        ("stretched", id::Model::Stretched),
        ("fractional_zener", id::Model::FractionalZener),
    ];
    choice("model", &name, &models).map_err(|error| {
        let others = "(\"prony\", terms), (\"power_law\", cutoff), (\"power_law_solid\", cutoff)";
        PyValueError::new_err(format!("{}, or a pair: {others}", error.value(given.py())))
    })
}

/// More relaxation times than a curve can tell from each other, by far.
const MOST_TERMS: usize = 50;
