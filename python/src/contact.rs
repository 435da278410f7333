//! The contact, and its steps.

use std::time::{Duration, Instant};

use viscocontact::contact as ct;
use viscocontact::{self as vc, motion};

use crate::held::Held;
use crate::prelude::*;

/// Steps on more cells, ...
const MANY_CELLS: usize = 1 << 17;
/// ... and steps after one that took longer are computed while the thread that called listens for Ctrl-C.
const LONG: Duration = Duration::from_millis(10);

/// A rigid body, or several, pressed onto a creeping body: the pressure between them and how it evolves in time.
///
/// Parameters
/// ----------
/// grid : Grid
/// geometry : Shape, array of the shape of the grid, or sequence of shapes
///     The gap before deformation [m], +inf where there is nothing to touch. An array is a gap: heights are for `HeightMap`. A sequence makes several rigid bodies, each with a load.
/// material : Material
///     The creeping body.
/// counter_body : Material, optional
///     The material of the body with the shape; it is rigid without.
/// kernel : InfluenceKernel, optional
///     The bodies, if they are not half-spaces.
/// attraction : Attraction, optional
/// temperature : TemperatureHistory, optional
/// times : (float, float) or (load, float), optional
///     The loading times over which the material is needed [s]: from the first to the last, or those of a load to the time `until`.
/// tolerance : float, default 1e-6
///     Of the contact problem, relative to the displacement. Runs (`follow`) solve it no more accurately than their own tolerance in time needs:
///     `StepReport.residual` has what was reached.
/// max_iterations : int, default 1000
/// time_rule : "exponential" (default) or "exponential_linear"
/// edge : "refuse" (default) or "allow"
///     What happens when contact reaches the edge of the grid.
/// series_tolerance : float, default 1e-4
/// symmetry, window : bool, default True
///     Whether cells that symmetry gives, or that contact cannot reach, are left out.
/// frame : "bodies" (default) or "indenter"
///
/// Raises ValueError if a part is not allowed, MemoryError if the contact does not fit.
///
/// >>> grid = Grid(64, 4e-3)
/// >>> contact = ViscoelasticContact(grid, Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> report = contact.step(0.0, Load.force(1.0))          # dt = 0: the load jumps
/// >>> for _ in range(10):
/// ...     report = contact.step(0.2, Load.force(1.0))      # hold it
/// >>> f"{report.time:.1f} s {contact.contact_area * 1e6:.2f} mm²"
/// '2.0 s 9.94 mm²'
/// >>> contact.pressure.shape
/// (64, 64)
#[pyclass(module = "viscocontact")]
pub struct ViscoelasticContact {
    pub held: Held<vc::ViscoelasticContact>,
    /// Shared with the functions of its run alone.
    pub recipe: Arc<Recipe>,
    pub cancel: Arc<AtomicBool>,
    last: Duration,
}

impl ViscoelasticContact {
    pub fn of(contact: vc::ViscoelasticContact, recipe: Recipe) -> ViscoelasticContact {
        ViscoelasticContact {
            held: Held::Free(contact),
            recipe: Arc::new(recipe),
            cancel: Arc::default(),
            last: Duration::ZERO,
        }
    }

    pub fn get(&self) -> PyResult<&vc::ViscoelasticContact> {
        self.held.contact()
    }

    /// Computes what may take long, on the contact taken out of its run.
    pub fn compute<T: Send>(
        &mut self,
        py: Python<'_>,
        job: impl FnOnce(&mut vc::ViscoelasticContact, &AtomicBool) -> vc::Result<T> + Send,
    ) -> PyResult<T> {
        let ViscoelasticContact { held, cancel, last, .. } = self;
        let contact = held.free()?;
        timed(last, contact.grid().len(), |slow| interruptible(py, slow, cancel, || job(contact, cancel)))
    }

    /// Takes the next step of its run.
    pub fn next(&mut self, py: Python<'_>, run: u64) -> PyResult<Option<ct::StepReport>> {
        let ViscoelasticContact { held, cancel, last, .. } = self;
        let run = held.run(run)?;
        let cells = run.contact().grid().len();
        timed(last, cells, |slow| interruptible(py, slow, cancel, || run.next_step()))
    }
}

/// Computes what is slow if there are many cells, or the last computation was long.
pub fn timed<T>(last: &mut Duration, cells: usize, compute: impl FnOnce(bool) -> T) -> T {
    let start = Instant::now();
    let result = compute(cells >= MANY_CELLS || *last > LONG);
    *last = start.elapsed();
    result
}

#[pymethods]
impl ViscoelasticContact {
    #[new]
    #[pyo3(
        signature = (grid, geometry, material, **options),
        text_signature = "(grid, geometry, material, *, counter_body=None, kernel=None, attraction=None, temperature=None, times=None, tolerance=1e-6, max_iterations=1000, time_rule='exponential', edge='refuse', series_tolerance=1e-4, symmetry=True, window=True, frame='bodies')"
    )]
    fn new(
        py: Python<'_>,
        grid: Bound<'_, Grid>,
        geometry: Object<'_>,
        material: Bound<'_, Material>,
        options: Option<&Dict<'_>>,
    ) -> PyResult<ViscoelasticContact> {
        let builder = builder(grid.get(), &geometry, material.get(), options)?;
        let contact = free(py, || builder.build()).or_raise()?;
        let recipe = Recipe::new(py, "", (grid, geometry, material))?.with_keywords(options)?;
        Ok(ViscoelasticContact::of(contact, recipe))
    }

    /// Advances by `dt` [s] to a state that carries `load`: a `Load`, or a sequence with one for each body. `dt` = 0 is a jump.
    ///
    /// Ctrl-C ends the step within an iteration. A step that fails leaves the contact as it was.
    ///
    /// Raises ValueError if the load is not allowed or contact reaches the edge of the grid, ConvergenceError if the solver does not
    /// converge.
    ///
    /// >>> contact = ViscoelasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), Material(Rheology.elastic(1e6)))
    /// >>> contact.step(0.0, Load.force(float("nan")))
    /// Traceback (most recent call last):
    /// ValueError: ...
    /// >>> contact.time, contact.force
    /// (0.0, 0.0)
    fn step(mut slf: Taken<'_, Self>, py: Python<'_>, dt: f64, load: &Object<'_>) -> PyResult<StepReport> {
        let loads = loads(load)?;
        slf.compute(py, |contact, cancel| contact.step_unless(cancel, dt, &loads)).map(StepReport)
    }

    /// A step in which the indenter and the grid move over the bodies by whole cells along x1 and x2. Needs frame="indenter". Ctrl-C waits for its end.
    fn step_over(
        mut slf: Taken<'_, Self>,
        py: Python<'_>,
        cells: [isize; 2],
        dt: f64,
        load: &Object<'_>,
    ) -> PyResult<StepReport> {
        let loads = loads(load)?;
        slf.compute(py, |contact, _| contact.step_over(cells, dt, &loads)).map(StepReport)
    }

    /// A step at whose end `shape` is where `position(t)` [m] puts it, a function of time that returns (x1, x2), or a pair of start
    /// [m] and velocity [m/s]; `track` adds the gap of a fixed shape. The bodies do not move. Ctrl-C waits for the end of the step.
    ///
    /// Returns the report, and a dict of the "position" [m], the "lateral_force" [N] (`slope_force` of the shape) and the "power" [W].
    #[pyo3(signature = (shape, position, dt, load, *, track=None))]
    fn step_along<'py>(
        mut slf: Taken<'_, Self>,
        py: Python<'py>,
        shape: &Shape,
        position: Object<'py>,
        dt: f64,
        load: &Load,
        track: Option<&Shape>,
    ) -> PyResult<(StepReport, Dict<'py>)> {
        let shape = Arc::clone(&shape.geometry);
        let mut travel = if position.is_callable() {
            let function: Function = position.extract()?;
            motion::Travel::new(shape, motion::FnPath::fallible(move |t: f64| function.call::<[f64; 2]>((t,))))
        } else {
            let (start, velocity) = position.extract()?;
            motion::Travel::new(shape, motion::Straight::new(start, velocity).or_raise()?)
        };
        if let Some(track) = track {
            travel = travel.over(Arc::clone(&track.geometry));
        }
        let load = load.load;
        let report = slf.compute(py, |contact, _| contact.step_along(&travel, dt, load))?;
        Ok((StepReport(report.step), dict! { py; report { position, lateral_force, power } }))
    }

    /// Replaces the shapes between two steps, moved or changed: a shape, an array of gaps, or a sequence with one for each body.
    fn set_geometry(mut slf: Taken<'_, Self>, py: Python<'_>, geometry: &Object<'_>) -> PyResult<()> {
        let contact = slf.held.free()?;
        let shapes = geometries(contact.grid(), geometry)?;
        let shapes: Vec<&dyn vc::geometry::Geometry> = shapes.iter().map(|shape| &**shape as _).collect();
        free(py, || contact.set_geometries(&shapes)).or_raise()
    }

    /// The state as it is, to come back to by `restore`.
    ///
    /// >>> contact = ViscoelasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
    /// >>> _ = contact.step(0.0, Load.force(0.5))
    /// >>> before = contact.snapshot()
    /// >>> _ = contact.step(1.0, Load.force(0.2))
    /// >>> contact.restore(before)
    /// >>> contact.time
    /// 0.0
    fn snapshot(slf: Shared<'_, Self>) -> PyResult<Snapshot> {
        slf.get().map(|contact| Snapshot(contact.snapshot()))
    }

    /// Goes back to a state. Raises ValueError if the snapshot is of another contact.
    fn restore(mut slf: Taken<'_, Self>, snapshot: &Snapshot) -> PyResult<()> {
        slf.held.free()?.restore(&snapshot.0).or_raise()
    }

    /// The contact at a time [s] within the last step, its ends included.
    fn within_step(slf: Shared<'_, Self>, py: Python<'_>, time: f64) -> PyResult<ViscoelasticContact> {
        let contact = slf.get()?;
        let within = free(py, || contact.within_step(time)).or_raise()?;
        Ok(ViscoelasticContact::of(within, slf.recipe.again(py)))
    }

    fn __repr__(slf: Shared<'_, Self>) -> PyResult<String> {
        let of = slf.get()?;
        let [n1, n2] = of.grid().cells();
        let [time, force, approach] = [of.time(), of.force(), of.approach()].map(digits);
        Ok(format!("ViscoelasticContact({n1} × {n2} cells, time={time} s, force={force} N, approach={approach} m)"))
    }
}

/// A state of a contact in memory.
///
/// >>> contact = ViscoelasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> contact.snapshot()
/// Snapshot(time=0 s)
#[pyclass(frozen, module = "viscocontact")]
pub struct Snapshot(ct::Snapshot);

#[pymethods]
impl Snapshot {
    fn __repr__(&self) -> String {
        format!("Snapshot(time={} s)", self.0.time())
    }
}

getters! {Snapshot, of:
    /// The time of the state [s].
    time: f64 = of.time();
}
