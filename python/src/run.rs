//! Runs along a load history.

use std::path::PathBuf;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact::contact::StepReport as Report;
use viscocontact::run::{self as vr, Crossing};
use viscocontact::states::StatesContact as InStates;
use viscocontact::{self as vc, ViscoelasticContact as InSpace};

use crate::arrays::{Array, to_array};
use crate::contact::ViscoelasticContact;
use crate::errors::{Cancelled, OrRaise, choice};
use crate::held::{Led, Options};
use crate::reports::StepReport;
use crate::states_contact::StatesContact;

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
