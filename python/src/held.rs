//! A contact, or the run that owns it; what a run is asked for.

use std::sync::atomic::AtomicU64;
use std::time::Duration;

use crate::prelude::*;
use viscocontact as vc;
use viscocontact::load::LoadHistory;
use viscocontact::rheology::{Elastic, Material};
use viscocontact::run::{self as vr, Contact, Crossing, Stepping};
use viscocontact::states::{ElasticStates, StatesContact as InStates};

made! {
    /// Times at which steps end or states are sampled, counted from the start of a run.
    ///
    /// A sequence of times [s] does as well. `+` joins them.
    ///
    /// >>> Times.every(0.1) + Times.decades(1e-6, 10)
    /// Times.every(0.1) + Times.decades(1e-06, 10)
    #[pyclass(frozen, module = "viscocontact")]
    Times(times: vr::Times)
}

makers! {Times, py:
    /// The multiples of an `interval` [s].
    every(interval: f64) = sure(vr::Times::every(interval));

    /// The time `first` [s], and so many in each decade beyond.
    decades(first: f64, per_decade: Count) = sure(vr::Times::decades(first, per_decade.0));
}

#[pymethods]
impl Times {
    fn __add__(slf: Bound<'_, Self>, other: Value<'_>) -> PyResult<Times> {
        let joined = slf.get().times.clone().and(times("times", Some(other.clone()))?.unwrap_or_default());
        Ok(Times::by(Recipe::new(slf.py(), "__add__", (slf, other))?, joined))
    }

    fn __radd__(slf: Bound<'_, Self>, other: Value<'_>) -> PyResult<Times> {
        Times::__add__(slf, other)
    }
}

pub fn times(name: &str, given: Option<Object<'_>>) -> PyResult<Option<vr::Times>> {
    let Some(given) = given else { return Ok(None) };
    match given.cast::<Times>() {
        Ok(times) => Ok(Some(times.get().times.clone())),
        Err(_) => Ok(Some(column(name, &given)?.into())),
    }
}

/// What a run is asked for.
pub struct Options {
    pub histories: Vec<Arc<dyn LoadHistory>>,
    pub stepping: Stepping,
    pub until: f64,
    pub stop_at: Option<vr::Times>,
    pub sample_at: Option<vr::Times>,
    pub fields_to: Option<f64>,
    pub autosave: Option<(PathBuf, Duration)>,
}

/// Equal steps or adaptive ones.
pub fn stepping(dt: Option<f64>, tolerance: Option<f64>) -> PyResult<Stepping> {
    match (dt, tolerance) {
        (Some(dt), None) => Ok(Stepping::fixed(dt)),
        (None, tolerance) => Ok(Stepping::adaptive(tolerance.unwrap_or(1e-3))),
        _ => Err(PyTypeError::new_err("give dt or tolerance, not both")),
    }
}

/// The path of a checkpoint, and how often it is written.
pub fn saved_every(autosave: Option<(PathBuf, f64)>) -> PyResult<Option<(PathBuf, Duration)>> {
    let Some((path, seconds)) = autosave else { return Ok(None) };
    let every = Duration::try_from_secs_f64(seconds);
    every.map(|every| Some((path, every))).map_err(|_| PyTypeError::new_err("autosave: (path, seconds), seconds ≥ 0"))
}

impl Options {
    /// Refuses times that a run would refuse, which would take the contact with it.
    fn check(&self) -> vc::Result<()> {
        let small = InStates::new(&ElasticStates::sphere(1.0)?, &Material::incompressible(Elastic::new(1.0)?))?;
        self.ask(small.into_follow(Arc::clone(&self.histories[0]), self.stepping, self.until)).map(drop)
    }

    fn ask<C: Led>(&self, run: vr::Run<'static, C>) -> vc::Result<vr::Run<'static, C>> {
        let run = run.stop_at(self.stop_at.clone().unwrap_or_default())?;
        let run = run.sample_at(self.sample_at.clone().unwrap_or_default())?;
        match self.fields_to {
            Some(accuracy) => C::with_fields(run, accuracy),
            None => Ok(run),
        }
    }
}

/// A contact that a run can lead, as an object of Python.
pub trait Led: Contact {
    const IN_SPACE: bool;

    fn with_fields(run: vr::Run<'static, Self>, accuracy: f64) -> vc::Result<vr::Run<'static, Self>>;

    /// A run along a history for each body.
    fn along(self, of: &Options) -> vc::Result<vr::Run<'static, Self>>;

    /// The object of Python.
    fn into_object(self, py: Python<'_>, recipe: Recipe) -> PyResult<Py<PyAny>>;

    fn state(&self) -> [f64; 4] {
        [self.time(), self.force(), self.approach(), self.contact_area()]
    }
}

/// The objects of the contact in space and of the one on elastic states.
macro_rules! led {
    ($($contact:ty, $in_space:literal, $along:expr => $class:ty;)*) => {$(
        impl Led for $contact {
            const IN_SPACE: bool = $in_space;

            fn with_fields(run: vr::Run<'static, Self>, accuracy: f64) -> vc::Result<vr::Run<'static, Self>> {
                run.fields_to(accuracy)
            }

            fn along(self, of: &Options) -> vc::Result<vr::Run<'static, Self>> {
                ($along)(self, of)
            }

            fn into_object(self, py: Python<'_>, recipe: Recipe) -> PyResult<Py<PyAny>> {
                Ok(Py::new(py, <$class>::of(self, recipe))?.into_any())
            }
        }
    )*};
}

led! {
    vc::ViscoelasticContact, true, |contact: Self, of: &Options| {
        let histories = of.histories.iter().map(|one| Box::new(Arc::clone(one)) as Box<dyn LoadHistory>);
        contact.into_follow_each(histories.collect(), of.stepping, of.until)
    } => crate::contact::ViscoelasticContact;
    InStates, false, |contact: Self, of: &Options| {
        Ok(contact.into_follow(Arc::clone(&of.histories[0]), of.stepping, of.until))
    } => crate::states_contact::StatesContact;
}

/// What the garbage collector of Python sees of a run: its load, and the functions of its events.
pub type Called = (Py<PyAny>, Vec<Function>);

/// A contact, or the run that owns it.
pub enum Held<C: Led> {
    Free(C),
    Run(Box<vr::Run<'static, C>>, u64, Called),
    Lost,
}

/// Number of the next run.
static NEXT: AtomicU64 = AtomicU64::new(0);

impl<C: Led> Held<C> {
    pub fn contact(&self) -> PyResult<&C> {
        match self {
            Held::Free(contact) => Ok(contact),
            Held::Run(run, ..) => Ok(run.contact()),
            Held::Lost => Err(lost()),
        }
    }

    /// The contact, taken out of its run, which ends.
    pub fn free(&mut self) -> PyResult<&mut C> {
        if let Held::Run(..) = self
            && let Held::Run(run, ..) = std::mem::replace(self, Held::Lost)
        {
            *self = Held::Free(run.into_contact());
        }
        match self {
            Held::Free(contact) => Ok(contact),
            _ => Err(lost()),
        }
    }

    /// The run of this number.
    pub fn run(&mut self, number: u64) -> PyResult<&mut vr::Run<'static, C>> {
        match self {
            Held::Run(run, own, _) if *own == number => Ok(run),
            _ => Err(over()),
        }
    }

    pub fn run_ref(&self, number: u64) -> PyResult<&vr::Run<'static, C>> {
        match self {
            Held::Run(run, own, _) if *own == number => Ok(run),
            _ => Err(over()),
        }
    }

    /// Begins a run, and returns its number.
    pub fn follow(&mut self, options: Options, load: Py<PyAny>, cancel: Arc<AtomicBool>) -> PyResult<u64> {
        options.check().or_raise()?;
        let (bodies, given) = (self.free()?.in_space().map_or(1, |fields| fields.bodies()), options.histories.len());
        one_for_each("body", "load", given, bodies)?;
        let Held::Free(contact) = std::mem::replace(self, Held::Lost) else { return Err(lost()) };
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let run = contact.along(&options).or_raise()?.cancelled_by(cancel);
        let mut run = options.ask(run).or_raise()?;
        if let Some((path, every)) = &options.autosave {
            run = run.autosave_to(path, *every);
        }
        *self = Held::Run(Box::new(run), number, (load, Vec::new()));
        Ok(number)
    }

    pub fn stop_when(
        &mut self,
        number: u64,
        quantity: impl Fn(&C) -> f64 + Send + Sync + 'static,
        function: Option<Function>,
        crossing: Crossing,
    ) -> PyResult<()> {
        self.run(number)?;
        let Held::Run(run, _, (load, mut called)) = std::mem::replace(self, Held::Lost) else { return Err(lost()) };
        called.extend(function);
        *self = Held::Run(Box::new(run.stop_when(quantity, crossing).or_raise()?), number, (load, called));
        Ok(())
    }

    pub fn traverse(&self, visit: &PyVisit<'_>) -> Traversed {
        let Held::Run(_, _, (load, called)) = self else { return Ok(()) };
        visit.call(load)?;
        called.iter().try_for_each(|function| visit.call(&*function.0))
    }
}

fn over() -> PyErr {
    PyRuntimeError::new_err("the run is over: its contact went on by another run or step")
}

/// The error of a contact that a panic has lost.
fn lost() -> PyErr {
    PyRuntimeError::new_err("the contact was lost in a step that panicked: please report the panic")
}
