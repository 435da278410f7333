//! Steady sliding and rolling: one problem a velocity.

use numpy::Complex64;
use viscocontact::fields as vf;
use viscocontact::sliding as sl;

use crate::arrays::{number, vectors};
use crate::pictures::{Picture, quantity};
use crate::prelude::*;
use crate::reports::figures;

/// The complex number that a function in Python gives at a frequency.
pub fn complex(function: &Function, omega: f64, kept: &Kept) -> Complex64 {
    kept.number(function.call((omega,)), Complex64::new(f64::NAN, f64::NAN))
}

/// A velocity along x1, or along x1 and x2.
pub fn velocity(given: &Object<'_>) -> PyResult<[f64; 2]> {
    let along = number(given).map(|speed| [speed, 0.0]);
    let needed = "velocity: a speed along x1, or a pair along x1 and x2 [m/s], is needed";
    along.map_or_else(|| given.extract(), Ok).map_err(|_: PyErr| PyTypeError::new_err(needed))
}

impl Shown for SteadySliding {
    fn shown(&self) -> PyResult<vf::Fields<'_>> {
        let needed = || PyRuntimeError::new_err("no state has been found yet: call at or sweep first");
        if self.has_state { Ok(self.sliding.fields()) } else { Err(needed()) }
    }
}

/// The state of a steady motion, in numbers. `lateral_force` is the integral of the pressure times the slope of the deformed surface, which converges fast
/// with the cells; `Fields.slope_force(shape)` takes the slopes of the shape instead, and agrees where cells resolve the contact.
///
/// >>> grid = Grid(32, 1e-3)
/// >>> rubber = Material(Rheology.generalized_maxwell(1e6, [(1e7, 1e-4)]))
/// >>> sliding = SteadySliding(grid, Shape.wavy((2e-6, 2e-6), (1e-3, 1e-3)), rubber, kernel=InfluenceKernel.periodic(grid))
/// >>> report = sliding.at(0.5, Load.force(0.02))
/// >>> abs(report.dissipation / 0.5 / report.lateral_force[0] - 1) < 1e-9
/// True
#[pyclass(frozen, module = "viscocontact")]
pub struct SlidingReport(sl::SlidingReport);

#[pymethods]
impl SlidingReport {
    fn __repr__(&self) -> String {
        let of = &self.0;
        let ([v1, v2], numbers) = (of.velocity.map(digits), [of.force, of.friction(), of.contact_area].map(digits));
        let [force, friction, area] = numbers;
        format!(
            "SlidingReport(velocity=({v1}, {v2}) m/s, force={force} N, friction={friction}, contact_area={area} m²)"
        )
    }
}

numbers!(SlidingReport);

getters! {SlidingReport, of, py:
    /// The numbers behind the warnings, as those of a step.
    figures: PyResult<Dict<'py>> = figures(py, &of.figures);
    /// Velocity of the indenter over the bodies [m/s].
    velocity: (f64, f64) = of.velocity.into();
    /// Normal force [N].
    force: f64 = of.force;
    /// Approach [m].
    approach: f64 = of.approach;
    /// Force along x1 and x2 [N] that moves the body.
    lateral_force: (f64, f64) = of.lateral_force.into();
    /// The coefficient of friction: lateral force against the motion over normal force.
    friction: f64 = of.friction();
    /// Power that the bodies dissipate [W].
    dissipation: f64 = of.dissipation();
    /// Cells in contact.
    contact_cells: usize = of.contact_cells;
    /// Contact area [m²].
    contact_area: f64 = of.contact_area;
    /// Mean gap over the grid [m].
    mean_gap: f64 = of.mean_gap;
    /// Root mean square of the gap in contact, over the range of the gap that the contact closes.
    residual: f64 = of.residual;
    /// Sets of cells that were tried, and pairs of transforms.
    cost: (usize, usize) = (of.sets, of.transforms);
    /// Reasons why the state may be less accurate than expected, a line each.
    warnings: Vec<String> = of.messages().map(in_python).collect();
}

/// A contact that moves steadily over creeping bodies: the friction of rubber on a road, at any velocity, by one contact problem each.
///
/// Takes the arguments of `ViscoelasticContact`, and
///
/// Parameters
/// ----------
/// modulus : function, optional
///     The complex contact modulus E′ + i E″ [Pa] at frequencies ≥ 0 [rad/s], in place of that of the material.
/// counter_motion : "slides" or "rolls", optional
///     What a counter-body that creeps does.
///
/// >>> grid = Grid(32, 1e-3)
/// >>> rubber = Material(Rheology.generalized_maxwell(1e6, [(1e7, 1e-4)]))
/// >>> road = Shape.wavy((2e-6, 2e-6), (1e-3, 1e-3))
/// >>> sliding = SteadySliding(grid, road, rubber, kernel=InfluenceKernel.periodic(grid))
/// >>> sliding.at((0.5, 0.0), Load.force(0.02)).friction > 0
/// True
#[pyclass(module = "viscocontact")]
pub struct SteadySliding {
    sliding: sl::SteadySliding,
    cancel: Arc<AtomicBool>,
    /// What the modulus raised.
    kept: Kept,
    recipe: Recipe,
    has_state: bool,
}

#[pymethods]
impl SteadySliding {
    #[new]
    #[pyo3(
        signature = (grid, geometry, material, *, modulus=None, counter_motion=None, **options),
        text_signature = "(grid, geometry, material, *, modulus=None, counter_motion=None, **options)"
    )]
    fn new(
        py: Python<'_>,
        grid: Bound<'_, Grid>,
        geometry: Object<'_>,
        material: Bound<'_, Material>,
        modulus: Option<Function>,
        counter_motion: Option<&str>,
        options: Option<&Dict<'_>>,
    ) -> PyResult<SteadySliding> {
        let mut builder = builder(grid.get(), &geometry, material.get(), options)?;
        if let Some(name) = counter_motion {
            let motions = [("slides", sl::CounterMotion::Slides), ("rolls", sl::CounterMotion::Rolls)];
            builder = builder.counter_motion(choice("counter_motion", name, &motions)?);
        }
        let kept = Kept::default();
        let raised = kept.clone();
        let sliding = match modulus.clone() {
            None => free(py, || builder.build_sliding()),
            Some(modulus) => free(py, || builder.build_sliding_by(move |omega| complex(&modulus, omega, &raised))),
        };
        let cancel = Arc::<AtomicBool>::default();
        let sliding = kept.raise_or(sliding.or_raise())?.cancelled_by(Arc::clone(&cancel));
        let (keywords, called) = (PyDict::new(py), modulus.iter().cloned().collect::<Vec<_>>());
        options.map_or(Ok(()), |options| keywords.update(options.as_mapping()))?;
        keywords.set_item("modulus", modulus)?;
        keywords.set_item("counter_motion", counter_motion)?;
        let recipe = Recipe::new(py, "", (grid, geometry, material))?.with_keywords(Some(&keywords))?.calling(called);
        Ok(SteadySliding { sliding, cancel, kept, recipe, has_state: false })
    }

    /// The motion before its first state.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        Shared::try_from(slf)?.recipe.reduce(slf.get_type())
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        self.recipe.traverse(&visit)
    }

    /// The state under a load, a force or an approach, of the indenter that moves with `velocity` [m/s]: along x1, or a pair along x1 and
    /// x2. Ctrl-C ends the search within an iteration, and keeps the state found last.
    fn at(mut slf: Taken<'_, Self>, py: Python<'_>, velocity: &Object<'_>, load: &Load) -> PyResult<SlidingReport> {
        let (velocity, load) = (self::velocity(velocity)?, load.load);
        let SteadySliding { sliding, cancel, kept, has_state, .. } = &mut *slf;
        let found = kept.raise_or(interruptible(py, true, cancel, || sliding.at(velocity, load)));
        *has_state |= found.is_ok();
        found.map(SlidingReport)
    }

    /// The states of all velocities [m/s] along x1, or pairs along x1 and x2, under each of the loads, at each of the temperatures [K].
    ///
    /// `progress` is called after each state with the part that is done; where it returns False, the sweep ends with the states so far.
    /// Ctrl-C ends it within a state.
    ///
    /// Returns the table of the states, each found from the one before: neighbours cost least.
    #[pyo3(signature = (velocities, loads, *, law=None, temperatures=None, progress=None))]
    fn sweep(
        mut slf: Taken<'_, Self>,
        py: Python<'_>,
        velocities: &Object<'_>,
        loads: &Object<'_>,
        law: Option<&TimeTemperature>,
        temperatures: Option<Vec<f64>>,
        progress: Option<Function>,
    ) -> PyResult<SlidingTable> {
        let velocities = vectors("velocities", velocities)?;
        let mut sweep = sl::SlidingSweep::new(velocities, self::loads(loads)?);
        match (law, temperatures) {
            (None, None) => {}
            (Some(law), Some(temperatures)) => sweep = sweep.at_temperatures(law.law.clone(), temperatures),
            _ => return Err(PyTypeError::new_err("law and temperatures belong together")),
        }
        let mut listener = Listener::new(progress);
        let SteadySliding { sliding, cancel, kept, has_state, .. } = &mut *slf;
        let table =
            interruptible(py, true, cancel, || sliding.sweep_with(&sweep, |_, share| listener.goes_on((share,))));
        let table = listener.result(kept.raise_or(table))?;
        *has_state |= !table.states().is_empty();
        Ok(SlidingTable(table))
    }

    /// The fields of the state found last, with all that a contact shows: patches, profiles, distributions, stress.
    #[getter]
    fn fields(slf: Shared<'_, Self>) -> PyResult<Fields> {
        Ok(Fields(slf.shown()?.keep()))
    }

    /// Bytes that a contact in steady motion takes at most, before it is built. Takes the arguments of `ViscoelasticContact`.
    #[staticmethod]
    #[pyo3(signature = (grid, geometry, material, **options))]
    fn memory(grid: &Grid, geometry: &Object<'_>, material: &Material, options: Option<&Dict<'_>>) -> PyResult<u64> {
        builder(grid, geometry, material, options)?.sliding_memory().or_raise()
    }

    fn __repr__(slf: Shared<'_, Self>) -> String {
        let [n1, n2] = slf.sliding.fields().grid().cells();
        format!("SteadySliding({n1} × {n2} cells)")
    }
}

/// A column of a table, by name.
type Column = (&'static str, fn(&sl::SweptState) -> f64);

/// A column in a picture: name, unit and value.
type Charted = (&'static str, &'static str, fn(&sl::SlidingReport) -> f64);

const COLUMNS: [Column; 11] = [
    ("velocity1", |state| state.report.velocity[0]),
    ("velocity2", |state| state.report.velocity[1]),
    ("temperature", |state| state.temperature.unwrap_or(f64::NAN)),
    ("force", |state| state.report.force),
    ("approach", |state| state.report.approach),
    ("friction", |state| state.report.friction()),
    ("lateral_force1", |state| state.report.lateral_force[0]),
    ("lateral_force2", |state| state.report.lateral_force[1]),
    ("contact_area", |state| state.report.contact_area),
    ("mean_gap", |state| state.report.mean_gap),
    ("dissipation", |state| state.report.dissipation()),
];

/// The states of a sweep.
///
/// >>> grid = Grid(32, 1e-3)
/// >>> rubber = Material(Rheology.generalized_maxwell(1e6, [(1e7, 1e-4)]))
/// >>> sliding = SteadySliding(grid, Shape.wavy((2e-6, 2e-6), (1e-3, 1e-3)), rubber, kernel=InfluenceKernel.periodic(grid))
/// >>> table = sliding.sweep([0.1, 1.0], Load.force(0.02))
/// >>> len(table), table.columns()["velocity1"]
/// (2, array([0.1, 1. ]))
#[pyclass(frozen, module = "viscocontact")]
pub struct SlidingTable(sl::SlidingTable);

numbers!(SlidingTable);

#[pymethods]
impl SlidingTable {
    /// Arrays with a value for each state: "velocity1", "velocity2" [m/s], "temperature" [K] (NaN without), "force" [N], "approach" [m],
    /// "friction", "lateral_force1", "lateral_force2" [N], "contact_area" [m²], "mean_gap" [m] and "dissipation" [W].
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Dict<'py>> {
        crate::arrays::columns(py, COLUMNS.map(|(name, of)| (name, self.0.states().iter().map(of).collect())))
    }

    /// A picture of a column over the speed, a curve for each temperature and load.
    #[pyo3(signature = (column="friction"))]
    fn picture(&self, py: Python<'_>, column: &str) -> PyResult<Picture> {
        let charts: [(&str, Charted); 5] = [
            ("friction", ("coefficient of friction", "", sl::SlidingReport::friction)),
            ("approach", ("approach", "m", |report| report.approach)),
            ("contact_area", ("contact area", "m²", |report| report.contact_area)),
            ("mean_gap", ("mean gap", "m", |report| report.mean_gap)),
            ("dissipation", ("dissipation", "W", sl::SlidingReport::dissipation)),
        ];
        let (name, unit, value) = choice("column", column, &charts)?;
        free(py, || self.0.chart(quantity(name, unit), value).draw()).or_raise().map(Picture)
    }

    /// Writes the table as a CSV file.
    fn write_csv(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        free(py, || self.0.write_csv(path)).or_raise()
    }

    fn __repr__(&self) -> String {
        format!("SlidingTable({} states)", self.__len__())
    }

    fn __len__(&self) -> usize {
        self.0.states().len()
    }

    fn __getitem__(&self, index: isize) -> PyResult<SlidingReport> {
        let n = self.0.states().len();
        let at = if index < 0 { index + n as isize } else { index };
        let state = usize::try_from(at).ok().and_then(|at| self.0.states().get(at));
        let beyond = || pyo3::exceptions::PyIndexError::new_err(format!("index {index} of {n} states"));
        state.map(|state| SlidingReport(state.report)).ok_or_else(beyond)
    }
}
