//! Runs along a load history.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact::contact::{Contact, StepReport as Report};
use viscocontact::load::LoadHistory;
use viscocontact::rheology::{Elastic, Material};
use viscocontact::run::{self as vr, Crossing, RunContact, Stepping};
use viscocontact::states::{ElasticStates, StatesContact as InStates};
use viscocontact::{self as vc, ViscoelasticContact as InSpace};

use crate::arrays::{Array, column, to_array};
use crate::contact::{ViscoelasticContact, lost};
use crate::errors::{Cancelled, OrRaise, choice};
use crate::loads::history;
use crate::reports::StepReport;
use crate::states::StatesContact;

/// Times at which steps end or states are sampled, counted from the start of a run.
///
/// A sequence of times [s] does as well. `+` joins them.
///
/// >>> Times.every(0.1) + Times.decades(1e-6, 10)
/// Times(...)
#[pyclass(frozen, module = "viscocontact")]
pub struct Times(vr::Times);

#[pymethods]
impl Times {
    /// The multiples of an `interval` [s].
    #[staticmethod]
    fn every(interval: f64) -> Times {
        Times(vr::Times::every(interval))
    }

    /// The time `first` [s], and so many in each decade beyond.
    #[staticmethod]
    fn decades(first: f64, per_decade: usize) -> Times {
        Times(vr::Times::decades(first, per_decade))
    }

    fn __add__(&self, other: &Bound<'_, PyAny>) -> PyResult<Times> {
        Ok(Times(self.0.clone().and(times("times", other)?)))
    }

    fn __repr__(&self) -> &'static str {
        "Times(...)"
    }
}

fn times(name: &str, given: &Bound<'_, PyAny>) -> PyResult<vr::Times> {
    match given.cast::<Times>() {
        Ok(times) => Ok(times.get().0.clone()),
        Err(_) => Ok(column(name, given)?.into()),
    }
}

/// What a run is asked for.
pub struct Options {
    history: Arc<dyn LoadHistory>,
    stepping: Stepping,
    until: f64,
    stop_at: Option<vr::Times>,
    sample_at: Option<vr::Times>,
    progress: Option<Py<PyAny>>,
    autosave: Option<(PathBuf, Duration)>,
}

impl Options {
    #[allow(clippy::too_many_arguments)]
    pub fn new(
        load: &Bound<'_, PyAny>,
        until: f64,
        tolerance: Option<f64>,
        dt: Option<f64>,
        stop_at: Option<Bound<'_, PyAny>>,
        sample_at: Option<Bound<'_, PyAny>>,
        progress: Option<Py<PyAny>>,
        autosave: Option<(PathBuf, f64)>,
    ) -> PyResult<Options> {
        let stepping = match (dt, tolerance) {
            (Some(dt), None) => Stepping::fixed(dt),
            (None, tolerance) => Stepping::adaptive(tolerance.unwrap_or(1e-3)),
            _ => return Err(PyTypeError::new_err("give dt or tolerance, not both")),
        };
        let autosave = autosave.map(|(path, every)| {
            let every = Duration::try_from_secs_f64(every);
            every.map(|every| (path, every)).map_err(|_| PyTypeError::new_err("autosave: (path, seconds), seconds ≥ 0"))
        });
        Ok(Options {
            history: history(load)?,
            stepping,
            until,
            stop_at: stop_at.map(|given| times("stop_at", &given)).transpose()?,
            sample_at: sample_at.map(|given| times("sample_at", &given)).transpose()?,
            progress,
            autosave: autosave.transpose()?,
        })
    }

    /// Refuses times that a run would refuse, which would take the contact with it.
    fn check(&self) -> vc::Result<()> {
        let small = InStates::new(&ElasticStates::sphere(1.0)?, &Material::incompressible(Elastic::new(1.0)?))?;
        let run = small.into_follow(Arc::clone(&self.history), self.stepping, self.until);
        let run = run.stop_at(self.stop_at.clone().unwrap_or_default())?;
        run.sample_at(self.sample_at.clone().unwrap_or_default()).map(drop)
    }
}

/// A contact that a run can lead.
pub trait Led: RunContact + Contact + 'static {
    fn led(self, history: Arc<dyn LoadHistory>, stepping: Stepping, until: f64) -> vr::Run<'static, Self>;
    fn state(&self) -> [f64; 4];
    fn max_pressure_or_nan(&self) -> f64;
}

impl Led for InSpace {
    fn led(self, history: Arc<dyn LoadHistory>, stepping: Stepping, until: f64) -> vr::Run<'static, InSpace> {
        self.into_follow(history, stepping, until)
    }

    fn state(&self) -> [f64; 4] {
        [self.time(), self.force(), self.approach(), self.contact_area()]
    }

    fn max_pressure_or_nan(&self) -> f64 {
        self.max_pressure()
    }
}

impl Led for InStates {
    fn led(self, history: Arc<dyn LoadHistory>, stepping: Stepping, until: f64) -> vr::Run<'static, InStates> {
        self.into_follow(history, stepping, until)
    }

    fn state(&self) -> [f64; 4] {
        [self.time(), self.force(), self.approach(), self.contact_area()]
    }

    fn max_pressure_or_nan(&self) -> f64 {
        f64::NAN
    }
}

/// A contact, or the run that owns it.
pub enum Held<C: Led> {
    Free(C),
    Run(Box<vr::Run<'static, C>>, u64),
    Lost,
}

/// Number of the next run.
static NEXT: AtomicU64 = AtomicU64::new(0);

impl<C: Led> Held<C> {
    pub fn contact(&self) -> PyResult<&C> {
        match self {
            Held::Free(contact) => Ok(contact),
            Held::Run(run, _) => Ok(run.contact()),
            Held::Lost => Err(lost()),
        }
    }

    /// The contact, taken out of its run, which ends.
    pub fn free(&mut self) -> PyResult<&mut C> {
        if let Held::Run(..) = self
            && let Held::Run(run, _) = std::mem::replace(self, Held::Lost)
        {
            *self = Held::Free(run.into_contact());
        }
        match self {
            Held::Free(contact) => Ok(contact),
            _ => Err(lost()),
        }
    }

    /// The run of this number.
    pub fn run(&mut self, number: u64) -> PyResult<(&mut vr::Run<'static, C>, u64)> {
        match self {
            Held::Run(run, own) if *own == number => Ok((run, number)),
            _ => Err(PyRuntimeError::new_err("the run is over: its contact went on by another run or step")),
        }
    }

    fn run_ref(&self, number: u64) -> PyResult<&vr::Run<'static, C>> {
        match self {
            Held::Run(run, own) if *own == number => Ok(run),
            _ => Err(PyRuntimeError::new_err("the run is over: its contact went on by another run or step")),
        }
    }

    /// Begins a run, and returns its number.
    pub fn follow(&mut self, options: &Options, cancel: Arc<AtomicBool>) -> PyResult<u64> {
        options.check().or_raise()?;
        self.free()?;
        let Held::Free(contact) = std::mem::replace(self, Held::Lost) else { return Err(lost()) };
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let run = contact.led(Arc::clone(&options.history), options.stepping, options.until).cancelled_by(cancel);
        let run = run.stop_at(options.stop_at.clone().unwrap_or_default()).or_raise()?;
        let mut run = run.sample_at(options.sample_at.clone().unwrap_or_default()).or_raise()?;
        if let Some((path, every)) = &options.autosave {
            run = run.autosave_to(path, *every);
        }
        *self = Held::Run(Box::new(run), number);
        Ok(number)
    }

    fn stop_when(&mut self, number: u64, quantity: fn(&C) -> f64, crossing: Crossing) -> PyResult<()> {
        self.run(number)?;
        let Held::Run(run, _) = std::mem::replace(self, Held::Lost) else { return Err(lost()) };
        *self = Held::Run(Box::new(run.stop_when(quantity, crossing).or_raise()?), number);
        Ok(())
    }
}

enum Of {
    Space(Py<ViscoelasticContact>),
    States(Py<StatesContact>),
}

/// A contact on its way along a load: an iterator over the reports of its steps, made by `follow`.
///
/// The contact shows its state after each step. A step or another run of the contact ends the run.
#[pyclass(module = "viscocontact")]
pub struct Run {
    of: Of,
    number: u64,
    options: Options,
}

/// Evaluates an expression on the run of either contact.
macro_rules! on_run {
    ($self:ident, $py:ident, $run:ident => $value:expr) => {
        match &$self.of {
            Of::Space(contact) => {
                let contact = contact.bind($py).borrow();
                let $run = contact.held.run_ref($self.number)?;
                $value
            }
            Of::States(contact) => {
                let contact = contact.bind($py).borrow();
                let $run = contact.held.run_ref($self.number)?;
                $value
            }
        }
    };
}

impl Run {
    pub fn in_space(contact: Py<ViscoelasticContact>, number: u64, options: Options) -> Run {
        Run { of: Of::Space(contact), number, options }
    }

    pub fn on_states(contact: Py<StatesContact>, number: u64, options: Options) -> Run {
        Run { of: Of::States(contact), number, options }
    }

    /// Signals are looked for in each step: `list(run)` runs no Python between them.
    fn next(&self, py: Python<'_>) -> PyResult<Option<Report>> {
        py.check_signals()?;
        let report = match &self.of {
            Of::Space(contact) => contact.bind(py).borrow_mut().next(py, self.number)?,
            Of::States(contact) => contact.bind(py).borrow_mut().next(py, self.number)?,
        };
        if let (Some(progress), Some(_)) = (&self.options.progress, &report) {
            let share = on_run!(self, py, run => run.progress().share_of_time());
            if progress.call1(py, (share,))?.extract::<bool>(py).is_ok_and(|goes_on| !goes_on) {
                return Err(Cancelled::new_err("the run was cancelled by its report of progress"));
            }
        }
        Ok(report)
    }
}

#[pymethods]
impl Run {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<StepReport>> {
        Ok(self.next(py)?.map(StepReport))
    }

    /// Makes steps end where a quantity crosses a value, upward or downward: "force" [N], "approach" [m], "contact_area" [m²] or
    /// "max_pressure" [Pa] (in space). Call it before the first step; `events` has the crossings.
    ///
    /// >>> contact = StatesContact(ElasticStates.sphere(10e-3), Material(Rheology.zener(1e6, 1e6, 1.0)))
    /// >>> drive = LoadHistory.sinusoid(Load.approach(-20e-6), Load.approach(20e-6), 0.2)
    /// >>> run = contact.follow(drive, 20.0, tolerance=1e-4)
    /// >>> run.stop_when("force", down=0.0)
    /// >>> reports = list(run)
    /// >>> len(run.events[0]) >= 3
    /// True
    #[pyo3(signature = (quantity, *, up=None, down=None))]
    fn stop_when(&self, py: Python<'_>, quantity: &str, up: Option<f64>, down: Option<f64>) -> PyResult<()> {
        let crossing = match (up, down) {
            (Some(value), None) if value.is_finite() => Crossing::Up(value),
            (None, Some(value)) if value.is_finite() => Crossing::Down(value),
            _ => return Err(PyTypeError::new_err("give up or down, one of them, a finite value")),
        };
        match &self.of {
            Of::Space(contact) => {
                let quantity = choice("quantity", quantity, &quantities::<InSpace>())?;
                contact.bind(py).borrow_mut().held.stop_when(self.number, quantity, crossing)
            }
            Of::States(contact) => {
                let quantity = choice("quantity", quantity, &quantities::<InStates>()[..3])?;
                contact.bind(py).borrow_mut().held.stop_when(self.number, quantity, crossing)
            }
        }
    }

    /// The times [s] of the crossings of each `stop_when` so far.
    #[getter]
    fn events(&self, py: Python<'_>) -> PyResult<Vec<Vec<f64>>> {
        Ok(on_run!(self, py, run => run.events().iter().map(|event| event.times().to_vec()).collect()))
    }

    /// Whether the last step ended at the event, for each `stop_when`.
    #[getter]
    fn is_met(&self, py: Python<'_>) -> PyResult<Vec<bool>> {
        Ok(on_run!(self, py, run => run.events().iter().map(|event| event.is_met()).collect()))
    }

    /// The states of the last step at the times of `sample_at`, in the order of time.
    fn samples<'py>(&self, py: Python<'py>) -> PyResult<Vec<Sample>> {
        match &self.of {
            Of::Space(contact) => {
                let contact = contact.bind(py).borrow();
                let run = contact.held.run_ref(self.number)?;
                let taken = py.detach(|| samples(run)).or_raise()?;
                let sample = |(report, state)| -> PyResult<Sample> {
                    let state = Py::new(py, contact.copy_of(py, state))?;
                    Ok(Sample { report, contact: state.into_any() })
                };
                taken.into_iter().map(sample).collect()
            }
            Of::States(contact) => {
                let contact = contact.bind(py).borrow();
                let run = contact.held.run_ref(self.number)?;
                let taken = py.detach(|| samples(run)).or_raise()?;
                let sample = |(report, state)| -> PyResult<Sample> {
                    let state = Py::new(py, contact.copy_of(py, state))?;
                    Ok(Sample { report, contact: state.into_any() })
                };
                taken.into_iter().map(sample).collect()
            }
        }
    }

    /// Goes on to the end and returns what it passed: arrays "time" [s], "force" [N], "approach" [m] and "contact_area" [m²], with a
    /// value for each step, or for each time of `sample_at`.
    ///
    /// >>> contact = StatesContact(ElasticStates.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
    /// >>> curve = contact.follow(Load.force(1.0), 10.0, sample_at=[1.0, 2.0, 5.0]).table()
    /// >>> curve["time"]
    /// array([1., 2., 5.])
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut columns: [Vec<f64>; 4] = Default::default();
        let sampled = self.options.sample_at.is_some();
        while self.next(py)?.is_some() {
            let passed = on_run!(self, py, run => py.detach(|| passed(run, sampled))).or_raise()?;
            passed.iter().for_each(|row| columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value)));
        }
        as_table(py, columns)
    }

    /// The contact that the run leads.
    #[getter]
    fn contact(&self, py: Python<'_>) -> Py<PyAny> {
        match &self.of {
            Of::Space(contact) => contact.clone_ref(py).into_any(),
            Of::States(contact) => contact.clone_ref(py).into_any(),
        }
    }

    /// Steps taken, time [s], end [s], share of the time and share of the decades of time that are over.
    #[getter]
    fn progress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let at = on_run!(self, py, run => run.progress());
        let all = PyDict::new(py);
        all.set_item("steps", at.steps)?;
        all.set_item("time", at.time)?;
        all.set_item("until", at.until)?;
        all.set_item("share_of_time", at.share_of_time())?;
        all.set_item("share_of_decades", at.share_of_decades())?;
        Ok(all)
    }

    /// Steps rejected for their error so far.
    #[getter]
    fn rejected_steps(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(on_run!(self, py, run => run.rejected_steps()))
    }

    /// Where the error of a run in space comes from, relative: "time", "pressure", "solver", and of the mesh "mesh_approach",
    /// "mesh_max_pressure", "mesh_area"; None where there is no estimate. "text" says so in words.
    fn error_budget<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Of::Space(contact) = &self.of else {
            return Err(PyTypeError::new_err("only runs in space have an error budget"));
        };
        let contact = contact.bind(py).borrow();
        let budget = contact.held.run_ref(self.number)?.error_budget();
        let all = PyDict::new(py);
        all.set_item("time", budget.time)?;
        all.set_item("pressure", budget.pressure)?;
        all.set_item("solver", budget.solver)?;
        all.set_item("mesh_approach", budget.mesh.as_ref().map(|mesh| mesh.approach))?;
        all.set_item("mesh_max_pressure", budget.mesh.as_ref().and_then(|mesh| mesh.max_pressure))?;
        all.set_item("mesh_area", budget.mesh.as_ref().map(|mesh| mesh.area))?;
        all.set_item("text", budget.to_string())?;
        Ok(all)
    }

    /// Saves the run to a checkpoint now.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        match &self.of {
            Of::Space(contact) => contact.bind(py).borrow_mut().held.run(self.number)?.0.save(path).or_raise(),
            Of::States(contact) => contact.bind(py).borrow_mut().held.run(self.number)?.0.save(path).or_raise(),
        }
    }
}

/// The columns of a table by name.
pub fn as_table(py: Python<'_>, columns: [Vec<f64>; 4]) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    for (name, column) in ["time", "force", "approach", "contact_area"].into_iter().zip(columns) {
        let n = column.len();
        let array: Array<'_> = to_array(py, column, &[n])?;
        all.set_item(name, array)?;
    }
    Ok(all)
}

type Quantity<C> = (&'static str, fn(&C) -> f64);

fn quantities<C: Led>() -> [Quantity<C>; 4] {
    [
        ("force", |contact| contact.state()[1]),
        ("approach", |contact| contact.state()[2]),
        ("contact_area", |contact| contact.state()[3]),
        ("max_pressure", |contact| contact.max_pressure_or_nan()),
    ]
}

/// The state at the end of the last step, or the states of its samples.
fn passed<C: Led>(run: &vr::Run<'static, C>, sampled: bool) -> vc::Result<Vec<[f64; 4]>> {
    if !sampled {
        return Ok(vec![run.contact().state()]);
    }
    let mut rows = Vec::new();
    for sample in run.samples() {
        let sample = sample?;
        if sample.is_asked_for() {
            rows.push(sample.contact().state());
        }
    }
    Ok(rows)
}

/// The samples that were asked for.
fn samples<C: Led>(run: &vr::Run<'static, C>) -> vc::Result<Vec<(Report, C)>> {
    let mut all = Vec::new();
    for sample in run.samples() {
        let sample = sample?;
        if sample.is_asked_for() {
            all.push((*sample.report(), sample.contact().clone()));
        }
    }
    Ok(all)
}

/// A state of a run at a time of `sample_at`.
#[pyclass(frozen, module = "viscocontact")]
pub struct Sample {
    report: Report,
    contact: Py<PyAny>,
}

#[pymethods]
impl Sample {
    /// The contact at this time.
    #[getter]
    fn contact(&self, py: Python<'_>) -> Py<PyAny> {
        self.contact.clone_ref(py)
    }

    /// The report of the step from the start of the run's step to this time.
    #[getter]
    fn report(&self) -> StepReport {
        StepReport(self.report)
    }

    fn __repr__(&self) -> String {
        format!("Sample(time={} s)", self.report.time)
    }
}
