//! A contact of one material on elastic states.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact::contact as ct;
use viscocontact::states as st;

use crate::arrays::{Array, to_array};
use crate::errors::OrRaise;
use crate::held::{Held, Options};
use crate::loads::Load;
use crate::materials::Material;
use crate::recipe::Recipe;
use crate::reports::StepReport;
use crate::run::Run;
use crate::states::ElasticStates;
use crate::temperature::TemperatureHistory;

/// A contact of one material on elastic states, advanced like a `ViscoelasticContact`.
///
/// Parameters
/// ----------
/// states : ElasticStates
/// material : Material
/// temperature : TemperatureHistory, optional
/// linear_steps : bool
///     Steps that are linear and stay so.
/// merge_error : float, optional
///     Groups of levels merge where this changes force and depth by at most about this.
/// exact_states : bool
///     Whether the elastic state of every step is solved exactly.
///
/// >>> contact = StatesContact(ElasticStates.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> report = contact.step(0.0, Load.force(1.0))
/// >>> report = contact.step(2.0, Load.force(1.0))
/// >>> f"{contact.contact_area * 1e6:.2f} mm²"
/// '9.94 mm²'
#[pyclass(module = "viscocontact")]
pub struct StatesContact {
    pub held: Held<st::StatesContact>,
    pub recipe: Recipe,
    cancel: Arc<AtomicBool>,
}

impl StatesContact {
    pub fn get(&self) -> PyResult<&st::StatesContact> {
        self.held.contact()
    }

    pub fn copy_of(&self, py: Python<'_>, contact: st::StatesContact) -> StatesContact {
        StatesContact { held: Held::Free(contact), recipe: self.recipe.again(py), cancel: Arc::default() }
    }

    pub fn next(&mut self, py: Python<'_>, run: u64) -> PyResult<Option<ct::StepReport>> {
        let (run, _) = self.held.run(run)?;
        py.detach(|| run.next_step()).or_raise()
    }
}

#[pymethods]
impl StatesContact {
    #[new]
    #[pyo3(signature = (states, material, *, temperature=None, linear_steps=false, merge_error=None, exact_states=false))]
    fn new(
        py: Python<'_>,
        states: Bound<'_, ElasticStates>,
        material: Bound<'_, Material>,
        temperature: Option<Bound<'_, TemperatureHistory>>,
        linear_steps: bool,
        merge_error: Option<f64>,
        exact_states: bool,
    ) -> PyResult<StatesContact> {
        let mut contact = st::StatesContact::new(&states.get().states, &material.get().material).or_raise()?;
        if let Some(temperature) = &temperature {
            contact = contact.with_temperature(temperature.get().history.clone());
        }
        if linear_steps {
            contact = contact.with_linear_steps();
        }
        if let Some(error) = merge_error {
            contact = contact.with_merge_error(error).or_raise()?;
        }
        if exact_states {
            contact = contact.with_exact_states().or_raise()?;
        }
        let keywords = PyDict::new(py);
        keywords.set_item("temperature", temperature)?;
        keywords.set_item("linear_steps", linear_steps)?;
        keywords.set_item("merge_error", merge_error)?;
        keywords.set_item("exact_states", exact_states)?;
        let recipe = Recipe::new(py, "", (states, material))?.with_keywords(Some(&keywords));
        Ok(StatesContact { held: Held::Free(contact), recipe, cancel: Arc::default() })
    }

    /// Advances by `dt` [s] to a load; `dt` = 0 is a jump.
    fn step(&mut self, py: Python<'_>, dt: f64, load: &Load) -> PyResult<StepReport> {
        let (contact, load) = (self.held.free()?, load.load);
        py.detach(|| contact.step(dt, load)).or_raise().map(StepReport)
    }

    /// Follows a load, as `ViscoelasticContact.follow`.
    #[pyo3(signature = (load, until, *, tolerance=None, dt=None, stop_at=None, sample_at=None, progress=None, autosave=None))]
    #[allow(clippy::too_many_arguments)]
    fn follow(
        slf: Bound<'_, Self>,
        load: &Bound<'_, PyAny>,
        until: f64,
        tolerance: Option<f64>,
        dt: Option<f64>,
        stop_at: Option<Bound<'_, PyAny>>,
        sample_at: Option<Bound<'_, PyAny>>,
        progress: Option<Py<PyAny>>,
        autosave: Option<(PathBuf, f64)>,
    ) -> PyResult<Run> {
        let options = Options::new(load, until, tolerance, dt, stop_at, sample_at, progress, autosave)?;
        let mut contact = slf.borrow_mut();
        let cancel = Arc::clone(&contact.cancel);
        let run = contact.held.follow(&options, cancel)?;
        Ok(Run::on_states(slf.clone().unbind(), run, options))
    }

    /// Time [s].
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.get()?.time())
    }

    /// Normal force [N].
    #[getter]
    fn force(&self) -> PyResult<f64> {
        Ok(self.get()?.force())
    }

    /// Approach of the origin [m].
    #[getter]
    fn approach(&self) -> PyResult<f64> {
        Ok(self.get()?.approach())
    }

    /// Tilt along x1 and x2 [rad].
    #[getter]
    fn tilt(&self) -> PyResult<(f64, f64)> {
        Ok(self.get()?.tilt().into())
    }

    /// Level: the elastic contact at this level has the same area [m²].
    #[getter]
    fn level(&self) -> PyResult<f64> {
        Ok(self.get()?.level())
    }

    /// Contact area [m²].
    #[getter]
    fn contact_area(&self) -> PyResult<f64> {
        Ok(self.get()?.contact_area())
    }

    /// Stiffness over the contact modulus [m].
    #[getter]
    fn stiffness_over_modulus(&self) -> PyResult<f64> {
        Ok(self.get()?.stiffness_over_modulus())
    }

    /// Whether the bodies are apart.
    #[getter]
    fn is_separated(&self) -> PyResult<bool> {
        Ok(self.get()?.is_separated())
    }

    /// The pressure [Pa] of the shape of the grid, from the states of a sweep with `keep_pressures`.
    #[getter]
    fn pressure<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let contact = self.get()?;
        let pressure = py.detach(|| contact.pressure()).or_raise()?;
        to_array(py, pressure, &self.cells()?)
    }

    /// Arrays "pressure" [Pa], "displacement" [m] and "gap" [m] of the shape of the grid, within a relative `accuracy`.
    #[pyo3(signature = (accuracy=1e-3))]
    fn fields<'py>(&self, py: Python<'py>, accuracy: f64) -> PyResult<Bound<'py, PyDict>> {
        let contact = self.get()?;
        let fields = py.detach(|| contact.fields(accuracy)).or_raise()?;
        let (all, cells) = (PyDict::new(py), self.cells()?);
        for (name, field) in [("pressure", fields.pressure), ("displacement", fields.displacement), ("gap", fields.gap)]
        {
            all.set_item(name, to_array(py, field, &cells)?)?;
        }
        Ok(all)
    }

    fn __copy__(&self, py: Python<'_>) -> PyResult<StatesContact> {
        Ok(self.copy_of(py, self.get()?.clone()))
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: Bound<'_, PyAny>) -> PyResult<StatesContact> {
        self.__copy__(py)
    }

    fn __repr__(&self) -> PyResult<String> {
        let of = self.get()?;
        let (time, force, approach) = (of.time(), of.force(), of.approach());
        Ok(format!("StatesContact(time={time} s, force={force:e} N, approach={approach:e} m)"))
    }
}

impl StatesContact {
    fn cells(&self) -> PyResult<Vec<usize>> {
        let states = self.get()?.states();
        Ok(states.grid().map_or_else(Vec::new, |grid| grid.cells().to_vec()))
    }
}
