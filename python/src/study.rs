//! Convergence studies: the measured error of a result in mesh and time.

use std::collections::BTreeMap;

use viscocontact::plot::Chart;
use viscocontact::run::Stepping;
use viscocontact::study::{self as vs, Cost, Observable, StudyResult};
use viscocontact::{Axis, Error, ViscoelasticContact as Contact};

use crate::prelude::*;

const QUANTITIES: [(&str, Observable); 4] = [
    ("approach", Observable::Approach),
    ("force", Observable::Force),
    ("contact area", Observable::ContactArea),
    ("maximum pressure", Observable::MaxPressure),
];

/// A convergence study: runs on finer meshes and in shorter steps, until the measured errors of what is asked are below the accuracy. The result is the finest run.
///
/// Parameters
/// ----------
/// shape : Shape
/// material : Material
/// load : as of `follow`
/// until : float
///     The end of the run [s].
/// accuracy : float, default 1e-3
///     Of approach and force, relative to their maxima; in [1e-6, 0.1].
/// ask : list of str
///     What else has this accuracy: "contact area", "maximum pressure".
/// quantities : dict of functions, optional
///     Quantities of one's own that have it: functions of `Fields` that return a number, by their names.
/// fields : list of float
///     Times [s] at which the pressure field has this accuracy too, in L1 over its load.
/// kernel : function, optional
///     Another body than a half-space: a function of a `Grid` that returns its `InfluenceKernel`.
/// domain : (float, float), optional
///     Both sides of the domain [m]; found where they are not given.
/// periods : (float or None, float or None)
///     Sides of the domain that are periods of the body [m].
/// line : float, optional
///     The length of a line contact [m].
/// temperature : TemperatureHistory, optional
/// cells : int
///     Most cells of a mesh.
/// work : float, optional
///     Most convolutions of the whole study, each times the cells of its mesh.
/// progress : function, optional
///     Called after each step with the number of runs done, cells, steps, time and work so far, and the cells, steps and work of the run that is
///     expected to be the last, or None; the study ends with `Cancelled` where it returns False. Ctrl-C ends it between two steps.
///
/// >>> body = Material(Rheology.maxwell(1e6, 1.0))
/// >>> study = Study(Shape.sphere(10e-3), body, Load.force(1.0), 2.0, accuracy=1e-2)
/// >>> study.is_converged and study.errors["approach"] < 1e-2
/// True
/// >>> approach = study.contact().approach
#[pyclass(frozen, module = "viscocontact")]
pub struct Study {
    study: StudyResult,
    parts: (Py<Shape>, Py<Material>),
    kernel: Option<Py<PyAny>>,
    temperature: Option<Py<TemperatureHistory>>,
}

#[pymethods]
impl Study {
    #[new]
    #[pyo3(signature = (shape, material, load, until, *, accuracy=1e-3, ask=Vec::new(), quantities=None, fields=Vec::new(), kernel=None, domain=None, periods=(None, None), line=None, temperature=None, cells=262_144, work=None, progress=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        shape: Py<Shape>,
        material: Py<Material>,
        load: &Object<'_>,
        until: f64,
        accuracy: f64,
        ask: Vec<String>,
        quantities: Option<&Dict<'_>>,
        fields: Vec<f64>,
        kernel: Option<Py<PyAny>>,
        domain: Option<[f64; 2]>,
        periods: (Option<f64>, Option<f64>),
        line: Option<f64>,
        temperature: Option<Py<TemperatureHistory>>,
        #[pyo3(from_py_with = count)] cells: usize,
        work: Option<f64>,
        progress: Option<Function>,
    ) -> PyResult<Study> {
        let history = history(load)?;
        let (geometry, body) = (&*shape.get().geometry, &material.get().material);
        let (made, temperature_of) =
            (kernel.as_ref(), temperature.as_ref().map(|temperature| &temperature.get().history));
        let own = |(name, of): (Object<'_>, Object<'_>)| Ok((name.extract::<String>()?, of.extract::<Function>()?));
        let own: Vec<(String, Function)> = quantities.into_iter().flatten().map(own).collect::<PyResult<_>>()?;
        let asked = ask.iter().map(|name| choice("ask", name, &QUANTITIES)).collect::<PyResult<Vec<_>>>()?;
        let mut listener = Listener::new(progress);
        let study = free(py, || {
            let scene = |grid: viscocontact::Grid, settings| {
                let kernel = kernel_on(made, &grid)?;
                let builder = Contact::builder(grid).geometry(geometry).material(body.clone()).settings(settings);
                let builder = if_given(builder, kernel, |builder, kernel| builder.kernel(kernel));
                Ok(if_given(builder, temperature_of, |builder, history| builder.temperature(history.clone())))
            };
            let mut study = vs::Study::new(scene, &*history, until).accuracy(accuracy).cells(cells).fields_at(&fields);
            study = asked.into_iter().fold(study, vs::Study::ask);
            for (name, of) in &own {
                study = study.ask_own(name, |fields| value_of(of, fields));
            }
            for (axis, period) in Axis::BOTH.into_iter().zip([periods.0, periods.1]) {
                study = if_given(study, period, |study, length| study.period(axis, length));
            }
            study = if_given(if_given(study, domain, vs::Study::domain), line, vs::Study::line);
            if_given(study, work, vs::Study::work).run_with(|at| {
                let expected = at.expected.map(|cost| (cost.cells, cost.steps, cost.work));
                listener.goes_on((at.runs, at.cells, at.steps, at.time, at.work, expected))
            })
        });
        Ok(Study { study: listener.result(study.or_raise())?, parts: (shape, material), kernel, temperature })
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        visit.call(&self.parts.0)?;
        visit.call(&self.parts.1)?;
        visit.call(&self.kernel)?;
        visit.call(&self.temperature)
    }

    /// The contact of the finest run: at its end, or at rest, to run it again with `tolerance` and `stops`.
    #[pyo3(signature = (*, at_rest=false))]
    fn contact(&self, py: Python<'_>, at_rest: bool) -> PyResult<ViscoelasticContact> {
        let contact = if at_rest {
            let builder = self.study.builder().clone();
            free(py, || builder.build()).or_raise()?
        } else {
            self.study.contact().clone()
        };
        let (grid, settings, keywords) =
            (Grid(self.study.contact().grid().clone()), contact.fields().settings(), PyDict::new(py));
        keywords.set_item("tolerance", settings.tolerance())?;
        keywords.set_item("series_tolerance", settings.series_tolerance())?;
        if let Some(kernel) = &self.kernel {
            keywords.set_item("kernel", kernel.call1(py, (Grid(grid.0.clone()),))?)?;
        }
        if let Some(temperature) = &self.temperature {
            keywords.set_item("temperature", temperature.clone_ref(py))?;
        }
        let parts = (Py::new(py, grid)?, self.parts.0.clone_ref(py), self.parts.1.clone_ref(py));
        Ok(ViscoelasticContact::of(contact, Recipe::new(py, "", parts)?.with_keywords(Some(&keywords))?))
    }

    /// The pressure fields of the finest run at the times that were asked for.
    fn fields(&self) -> Vec<Fields> {
        self.study.fields().map(|fields| Fields(fields.keep())).collect()
    }

    /// A quantity at `times` in the finest run, by its name; the maximum pressure is one number.
    fn values(&self, name: &str) -> PyResult<Vec<f64>> {
        self.study.values(name).map(<[f64]>::to_vec).ok_or_else(|| {
            let names: Vec<_> = self.study.quantities.iter().map(|own| own.name.as_str()).collect();
            PyValueError::new_err(format!("quantity = {name:?} is not known: it must be one of {}", names.join(", ")))
        })
    }

    /// The cells, steps and work that a run to an accuracy is expected to take; None where a quantity that is asked for does not converge.
    fn cost_for(&self, accuracy: f64) -> PyResult<Option<([usize; 2], usize, f64)>> {
        let cost = self.study.cost_for(accuracy).or_raise()?;
        Ok(cost.map(|Cost { cells, steps, work, .. }| (cells, steps, work)))
    }

    /// Writes the table as a CSV file.
    fn write_csv(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        free(py, || self.study.write_csv(&path)).or_raise()
    }

    /// Draws the changes from mesh to mesh over the cells, as a PNG or SVG file.
    fn save_picture(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        free(py, || Chart::save(&self.study.chart(), &path)).or_raise()
    }

    fn __str__(&self) -> String {
        self.study.to_string()
    }

    fn __repr__(&self) -> String {
        let [n1, n2] = self.study.contact().grid().cells();
        format!("Study({}: {n1} × {n2} cells, {} steps)", self.study.ending, self.study.times().len())
    }
}

getters! {Study.study, of:
    /// Whether all that was asked for is met.
    is_converged: bool = of.is_converged();
    /// Why it ended.
    ending: String = of.ending.to_string();
    /// The measured error of each quantity, in mesh and time together; None where it does not converge.
    errors: BTreeMap<String, Option<f64>> = of.quantities.iter().map(|own| (own.name.clone(), own.error())).collect();
    /// The observed order of each quantity in the side of the cells; None where three meshes show none.
    orders: BTreeMap<String, Option<f64>> = of.quantities.iter().map(|own| (own.name.clone(), own.order)).collect();
    /// The measured error of each quantity in time.
    time_errors: BTreeMap<String, f64> = of.quantities.iter().map(|own| (own.name.clone(), own.time)).collect();
    /// The cells of all meshes.
    meshes: Vec<[usize; 2]> = of.meshes.iter().map(|mesh| mesh.cells).collect();
    /// The grid of the finest run.
    grid: Grid = Grid(of.contact().grid().clone());
    /// Ends of the steps of the finest run [s].
    times: Vec<f64> = of.times().to_vec();
    /// The tolerance of its steps, for `follow`.
    tolerance: f64 = match of.stepping() {
        Stepping::Adaptive { tolerance } => tolerance,
        _ => f64::NAN,
    };
    /// Times at which its steps end besides, for `follow` [s].
    stops: Vec<f64> = of.stops().to_vec();
    /// Runs of the whole study.
    runs: usize = of.runs;
    /// Convolutions of the whole study, each times the cells of its mesh.
    work: f64 = of.work;
    /// Memory of the contact of the finest run [bytes].
    bytes: u64 = of.bytes();
}

/// The value of a function in Python of the fields.
fn value_of(of: &Function, fields: viscocontact::fields::Fields<'_>) -> f64 {
    let kept = fields.keep();
    raised_number(of.call((Fields(kept),)), f64::NAN)
}

/// The kernel that a function in Python makes on a grid.
fn kernel_on(
    function: Option<&Py<PyAny>>,
    grid: &viscocontact::Grid,
) -> viscocontact::Result<Option<viscocontact::InfluenceKernel>> {
    let Some(function) = function else { return Ok(None) };
    let what = "the kernel of a study";
    let made = Python::attach(|py| {
        let made = function.call1(py, (Grid(grid.clone()),))?;
        Ok(Some(Arc::clone(&made.bind(py).cast::<InfluenceKernel>()?.get().kernel)))
    });
    raised_number(made, None).map(|kernel| Some(Arc::unwrap_or_clone(kernel))).ok_or(Error::Cancelled { what })
}
