//! Runs along a load history.

use viscocontact as vc;
use viscocontact::contact::StepReport as Report;
use viscocontact::fields::KeptFields;
use viscocontact::run::{self as vr, Crossing};

use crate::arrays;
use crate::errors::Cancelled;
use crate::held::Led;
use crate::prelude::*;

/// The contact that a run leads.
#[derive(FromPyObject, IntoPyObjectRef)]
pub enum Of {
    Space(Py<ViscoelasticContact>),
    States(Py<StatesContact>),
}

/// A contact on its way along a load: an iterator over the reports of its steps, made by `follow`.
///
/// The contact shows its state after each step. A step or another run of the contact ends the run.
///
/// >>> contact = ViscoelasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> run = contact.follow(Load.force(0.5), 1.0, dt=0.25)
/// >>> [report.time for report in run]
/// [0.0, 0.25, 0.5, 0.75, 1.0]
/// >>> run.progress["share_of_time"]
/// 1.0
#[pyclass(frozen, weakref, module = "viscocontact")]
pub struct Run {
    of: Of,
    number: u64,
    sampled: bool,
    progress: Option<Function>,
    is_told: AtomicBool,
}

/// Evaluates an expression with either contact of a run.
macro_rules! with_contact {
    ($self:ident, $py:ident, $borrow:ident, $contact:ident => $value:expr) => {
        match &$self.of {
            Of::Space(contact) => {
                let $contact = $borrow::try_from(contact.bind($py))?;
                $value
            }
            Of::States(contact) => {
                let $contact = $borrow::try_from(contact.bind($py))?;
                $value
            }
        }
    };
}

/// Evaluates an expression on the run of either contact.
macro_rules! on_run {
    ($self:ident, $py:ident, $run:ident => $value:expr) => {
        with_contact!($self, $py, Shared, contact => {
            let $run = contact.held.run_ref($self.number)?;
            $value
        })
    };
}

impl Run {
    pub fn of(of: Of, number: u64, sampled: bool, progress: Option<Function>) -> Run {
        Run { of, number, sampled, progress, is_told: AtomicBool::new(false) }
    }

    /// Signals are looked for in each step: `list(run)` runs no Python between them.
    fn next(&self, py: Python<'_>) -> PyResult<Option<Report>> {
        py.check_signals()?;
        if self.is_told.load(Ordering::Relaxed) {
            return Err(in_use::<Run>());
        }
        let report =
            with_contact!(self, py, Taken, contact => { let mut contact = contact; contact.next(py, self.number)? });
        if let (Some(progress), Some(_)) = (&self.progress, &report) {
            let share = on_run!(self, py, run => run.progress().share_of_time());
            self.is_told.store(true, Ordering::Relaxed);
            let goes_on = goes_on(Some(progress), (share,));
            self.is_told.store(false, Ordering::Relaxed);
            if !goes_on? {
                return Err(Cancelled::new_err("the run was cancelled by its report of progress"));
            }
        }
        Ok(report)
    }
}

#[pymethods]
impl Run {
    fn __iter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let at = on_run!(self, py, run => run.progress());
        Ok(format!("Run({} steps, time={} s of {} s)", at.steps, digits(at.time), digits(at.until)))
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        match &self.of {
            Of::Space(contact) => visit.call(contact),
            Of::States(contact) => visit.call(contact),
        }?;
        self.progress.iter().try_for_each(|function| visit.call(&*function.0))
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<StepReport>> {
        Ok(self.next(py)?.map(StepReport))
    }

    /// Makes steps end where a quantity crosses a value, upward or downward: "force" [N], "approach" [m], "contact_area" [m²] or
    /// "max_pressure" [Pa] (in space), or a function of the contact that returns a float. Call it before the first step; `events` has the
    /// crossings.
    ///
    /// A quantity beyond the value has to come back first, to it, to 0, or by a millionth of its maximum distance. A function is called with a
    /// copy of the contact, some times a step. An exception of it comes out after the step.
    ///
    /// >>> contact = StatesContact(ElasticStates.sphere(10e-3), Material(Rheology.zener(1e6, 1e6, 1.0)))
    /// >>> drive = LoadHistory.sinusoid(Load.approach(-20e-6), Load.approach(20e-6), 0.2)
    /// >>> run = contact.follow(drive, 20.0, tolerance=1e-4)
    /// >>> run.stop_when("force", down=0.0)
    /// >>> run.stop_when(lambda contact: contact.force / (contact.contact_area + 1e-12), up=1e4)
    /// >>> reports = list(run)
    /// >>> len(run.events[0]) >= 3 and len(run.events[1]) >= 3
    /// True
    #[pyo3(signature = (quantity, *, up=None, down=None))]
    fn stop_when(&self, py: Python<'_>, quantity: &Object<'_>, up: Option<f64>, down: Option<f64>) -> PyResult<()> {
        let crossing = match (up, down) {
            (Some(value), None) if value.is_finite() => Crossing::Up(value),
            (None, Some(value)) if value.is_finite() => Crossing::Down(value),
            _ => return Err(PyTypeError::new_err("give up or down, one of them, a finite value")),
        };
        with_contact!(self, py, Taken, contact => {
            let (quantity, function) = watched(quantity, &contact.recipe)?;
            let mut contact = contact;
            contact.held.stop_when(self.number, quantity, function, crossing)
        })
    }

    /// The times [s] of the crossings of each `stop_when` so far.
    #[getter]
    fn events(&self, py: Python<'_>) -> PyResult<Vec<Vec<f64>>> {
        Ok(on_run!(self, py, run => run.events().iter().map(|event| event.times().to_vec()).collect()))
    }

    /// Whether the quantity lies beyond the value, perhaps since the start of the run, for each `stop_when`.
    #[getter]
    fn is_beyond(&self, py: Python<'_>) -> PyResult<Vec<bool>> {
        Ok(on_run!(self, py, run => run.events().iter().map(|event| event.is_beyond()).collect()))
    }

    /// Whether the last step ended at the event, for each `stop_when`.
    #[getter]
    fn is_met(&self, py: Python<'_>) -> PyResult<Vec<bool>> {
        Ok(on_run!(self, py, run => run.events().iter().map(|event| event.is_met()).collect()))
    }

    /// The states of the last step at the times of `sample_at`, in the order of time.
    fn samples(&self, py: Python<'_>) -> PyResult<Vec<Sample>> {
        with_contact!(self, py, Shared, contact => {
            let run = contact.held.run_ref(self.number)?;
            let taken = free(py, || asked_for(run, kept)).or_raise()?;
            let sample = |(report, field, kept, state): (_, _, Option<KeptFields>, _)| {
                let contact = Led::into_object(state, py, contact.recipe.again(py))?;
                let fields = kept.map(|kept| Py::new(py, Fields(kept))).transpose()?;
                Ok(Sample { report, field, fields, contact })
            };
            taken.into_iter().map(sample).collect()
        })
    }

    /// The contact at a time [s] within the last step, its ends included, as exact as the steps.
    fn within_step(&self, py: Python<'_>, time: f64) -> PyResult<Py<PyAny>> {
        with_contact!(self, py, Shared, contact => {
            let run = contact.held.run_ref(self.number)?;
            let state = free(py, || run.within_step(time)).or_raise()?;
            state.into_object(py, contact.recipe.again(py))
        })
    }

    /// Goes on to the end and returns what it passed: arrays "time" [s], "force" [N], "approach" [m] and "contact_area" [m²], with a
    /// value for each step, or for each time of `sample_at`.
    ///
    /// >>> contact = StatesContact(ElasticStates.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
    /// >>> curve = contact.follow(Load.force(1.0), 10.0, sample_at=[1.0, 2.0, 5.0]).table()
    /// >>> curve["time"]
    /// array([1., 2., 5.])
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Dict<'py>> {
        let mut columns: [Vec<f64>; 4] = Default::default();
        while self.next(py)?.is_some() {
            let passed = on_run!(self, py, run => free(py, || if self.sampled {
                asked_for(run, |sample| sample.contact().state())
            } else {
                Ok(vec![run.contact().state()])
            }))
            .or_raise()?;
            passed.iter().for_each(|row| columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value)));
        }
        arrays::columns(py, ["time", "force", "approach", "contact_area"].into_iter().zip(columns))
    }

    /// The contact that the run leads.
    #[getter]
    fn contact(&self) -> &Of {
        &self.of
    }

    /// A dict of the "steps" taken, "time" [s], its end "until" [s], "share_of_time" and "share_of_decades" that are over.
    #[getter]
    fn progress<'py>(&self, py: Python<'py>) -> PyResult<Dict<'py>> {
        let at = on_run!(self, py, run => run.progress());
        Ok(dict! { py;
            at { steps, time, until },
            "share_of_time": at.share_of_time(),
            "share_of_decades": at.share_of_decades(),
        })
    }

    /// Steps rejected for their error so far.
    #[getter]
    fn rejected_steps(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(on_run!(self, py, run => run.rejected_steps()))
    }

    /// Where the error of a run in space comes from, relative: "time", "solver", and of the mesh "mesh_approach",
    /// "mesh_max_pressure", "mesh_area"; None where there is no estimate. "text" says so in words.
    fn error_budget<'py>(&self, py: Python<'py>) -> PyResult<Dict<'py>> {
        let Of::Space(contact) = &self.of else {
            return Err(PyTypeError::new_err("only runs in space have an error budget"));
        };
        let contact = Shared::try_from(contact.bind(py))?;
        let budget = contact.held.run_ref(self.number)?.error_budget();
        let mesh = budget.mesh.as_ref();
        Ok(dict! { py;
            budget { time, solver },
            "mesh_approach": mesh.map(|mesh| mesh.approach),
            "mesh_max_pressure": mesh.and_then(|mesh| mesh.max_pressure),
            "mesh_area": mesh.map(|mesh| mesh.area),
            "text": budget.to_string(),
        })
    }

    /// Saves the run to a checkpoint now.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        with_contact!(self, py, Taken, contact => {
            let mut contact = contact;
            contact.held.run(self.number)?.save(path).or_raise()
        })
    }
}

type Quantity<C> = Box<dyn Fn(&C) -> f64 + Send + Sync>;
type Named<C> = (&'static str, fn(&C) -> f64);

/// The quantity of a name, or of a function of the contact.
fn watched<C: Led>(given: &Object<'_>, recipe: &Arc<Recipe>) -> PyResult<(Quantity<C>, Option<Function>)> {
    if let Ok(function) = given.extract::<Function>() {
        let (called, recipe) = (function.clone(), Arc::clone(recipe));
        let value = move |contact: &C| {
            let contact = Python::attach(|py| contact.clone().into_object(py, recipe.again(py)))?;
            called.call((contact,))
        };
        return Ok((Box::new(move |contact| raised_number(value(contact), f64::NAN)), Some(function)));
    }
    let needed = "quantity: a name or a function of the contact is needed";
    let name: String = given.extract().map_err(|_| PyTypeError::new_err(needed))?;
    let all: [Named<C>; 4] = [
        ("force", |contact| contact.force()),
        ("approach", |contact| contact.approach()),
        ("contact_area", |contact| contact.contact_area()),
        ("max_pressure", |contact| contact.in_space().map_or(f64::NAN, |fields| fields.max_pressure())),
    ];
    let known = if C::IN_SPACE { &all[..] } else { &all[..3] };
    Ok((Box::new(choice("quantity", &name, known)?), None))
}

/// What is kept of a sample.
fn kept<C: Led>(sample: &vr::Sample<'_, C>) -> (Report, Option<vr::FieldReport>, Option<KeptFields>, C) {
    (*sample.report(), sample.field(), sample.in_space().map(|fields| fields.keep()), sample.contact().clone())
}

/// What the samples that were asked for have.
pub fn asked_for<C: Led, T>(run: &vr::Run<'static, C>, of: impl Fn(&vr::Sample<'_, C>) -> T) -> vc::Result<Vec<T>> {
    let samples = run.samples().filter(|sample| sample.as_ref().map_or(true, |sample| sample.is_asked_for()));
    samples.map(|sample| sample.map(|sample| of(&sample))).collect()
}

/// A state of a run at a time of `sample_at`.
///
/// >>> contact = ViscoelasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> run = contact.follow(Load.force(0.5), 1.0, sample_at=[0.5])
/// >>> [sample.report.time for report in run for sample in run.samples()]
/// [0.5]
#[pyclass(frozen, module = "viscocontact")]
pub struct Sample {
    report: Report,
    field: Option<vr::FieldReport>,
    fields: Option<Py<Fields>>,
    contact: Py<PyAny>,
}

#[pymethods]
impl Sample {
    /// The fields of a contact in space at this time: with `fields_to` to that accuracy. None on elastic states, whose contact has them.
    #[getter]
    fn fields(&self, py: Python<'_>) -> Option<Py<Fields>> {
        self.fields.as_ref().map(|fields| fields.clone_ref(py))
    }

    /// The contact at this time; in space its pressure is that of the steps.
    #[getter]
    fn contact(&self, py: Python<'_>) -> Py<PyAny> {
        self.contact.clone_ref(py)
    }

    /// The report of the step from the start of the run's step to this time.
    #[getter]
    fn report(&self) -> StepReport {
        StepReport(self.report)
    }

    /// With `fields_to` how exact the pressure is: "error" in time, relative (None without an estimate), and the "elastic_contacts" and
    /// "convolutions" that it took.
    #[getter]
    fn field<'py>(&self, py: Python<'py>) -> PyResult<Option<Dict<'py>>> {
        let Some(of) = self.field else { return Ok(None) };
        Ok(Some(dict! { py; of { error, elastic_contacts, convolutions } }))
    }

    fn __repr__(&self) -> String {
        format!("Sample(time={} s)", self.report.time)
    }
}
