//! A contact of one material on elastic states.

use viscocontact::contact as ct;
use viscocontact::run::Contact as _;
use viscocontact::states as st;

use crate::held::Held;
use crate::prelude::*;
use crate::sheared::rubbing;

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
/// friction : float, optional
///     Coefficient of friction of bodies that respond alike to normal and to tangential loads: in line contact, and at ν = 0, of ν = ½ on a
///     rigid body or of two bodies of one material.
/// estimated_friction : float, optional
///     The same of any constant ν, as an estimate: the displacement of a rough surface of ν = ½ is off by 1.7 % in the median of 12.
/// sheared_by : as the load of `follow`, optional
///     What acts along the surface in all steps: forces, approaches as displacements, springs.
///
/// >>> contact = StatesContact(ElasticStates.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> report = contact.step(0.0, Load.force(1.0))
/// >>> report = contact.step(2.0, Load.force(1.0))
/// >>> f"{contact.contact_area * 1e6:.2f} mm²"
/// '9.94 mm²'
#[pyclass(module = "viscocontact")]
pub struct StatesContact {
    pub held: Held<st::StatesContact>,
    /// Shared with the functions of its run alone.
    pub recipe: Arc<Recipe>,
    pub cancel: Arc<AtomicBool>,
}

impl StatesContact {
    pub fn get(&self) -> PyResult<&st::StatesContact> {
        self.held.contact()
    }

    pub fn of(contact: st::StatesContact, recipe: Recipe) -> StatesContact {
        StatesContact { held: Held::Free(contact), recipe: Arc::new(recipe), cancel: Arc::default() }
    }

    pub fn next(&mut self, py: Python<'_>, run: u64) -> PyResult<Option<ct::StepReport>> {
        let run = self.held.run(run)?;
        free(py, || run.next_step()).or_raise()
    }
}

#[pymethods]
impl StatesContact {
    #[new]
    #[pyo3(signature = (states, material, *, temperature=None, linear_steps=false, merge_error=None, exact_states=false, friction=None, estimated_friction=None, sheared_by=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        states: Bound<'_, ElasticStates>,
        material: Bound<'_, Material>,
        temperature: Option<Bound<'_, TemperatureHistory>>,
        linear_steps: bool,
        merge_error: Option<f64>,
        exact_states: bool,
        friction: Option<f64>,
        estimated_friction: Option<f64>,
        sheared_by: Option<Object<'_>>,
    ) -> PyResult<StatesContact> {
        let mut contact = st::StatesContact::new(&states.get().states, &material.get().material).or_raise()?;
        contact =
            if_given(contact, temperature.as_ref(), |contact, of| contact.with_temperature(of.get().history.clone()));
        contact = if_given(contact, linear_steps.then_some(()), |contact, ()| contact.with_linear_steps());
        if let Some(error) = merge_error {
            contact = contact.with_merge_error(error).or_raise()?;
        }
        if exact_states {
            contact = contact.with_exact_states().or_raise()?;
        }
        let sheared_by = sheared_by.map(|load| LoadHistory::any(&load)).transpose()?;
        contact = rubbing(contact, friction, estimated_friction, sheared_by.as_ref())?;
        let keywords = dict! { py;
            "temperature": temperature,
            "linear_steps": linear_steps,
            "merge_error": merge_error,
            "exact_states": exact_states,
            "friction": friction,
            "estimated_friction": estimated_friction,
            "sheared_by": sheared_by,
        };
        let recipe = Recipe::new(py, "", (states, material))?.with_keywords(Some(&keywords))?;
        Ok(StatesContact::of(contact, recipe))
    }

    /// Advances by `dt` [s] to a load; `dt` = 0 is a jump.
    fn step(mut slf: Taken<'_, Self>, py: Python<'_>, dt: f64, load: &Load) -> PyResult<StepReport> {
        let (contact, load) = (slf.held.free()?, load.load);
        free(py, || contact.step(dt, load)).or_raise().map(StepReport)
    }

    /// The fields within a relative `accuracy`.
    #[pyo3(signature = (accuracy=1e-3))]
    fn fields(slf: Shared<'_, Self>, py: Python<'_>, accuracy: f64) -> PyResult<Fields> {
        let contact = slf.get()?;
        free(py, || contact.fields(accuracy)).or_raise().map(Fields)
    }

    /// The state as it is, to come back to by `restore`: a copy of the contact.
    fn snapshot(slf: Shared<'_, Self>, py: Python<'_>) -> PyResult<StatesContact> {
        Ok(StatesContact::of(slf.get()?.clone(), slf.recipe.again(py)))
    }

    /// Goes back to a state of this contact, or of a copy of it. Raises ValueError if the snapshot is of another contact.
    fn restore(mut slf: Taken<'_, Self>, snapshot: Shared<'_, StatesContact>) -> PyResult<()> {
        slf.held.free()?.restore(snapshot.get()?).or_raise()
    }

    /// The pressure as a sum of elastic ones, p = Σ w_i (p_e(l_i) − p_e(l_i−1)): rows (level l_i [m²], traction w_i [Pa]), where p_e(l) is
    /// the pressure of the elastic contact of unit compliance.
    ///
    /// >>> import numpy as np
    /// >>> tip = ElasticStates.sphere(10e-3)
    /// >>> contact = StatesContact(tip, Material(Rheology.maxwell(1e6, 1.0)))
    /// >>> for _ in range(3):
    /// ...     report = contact.step(0.5, Load.force(1.0))
    /// >>> level, traction = contact.tractions().T
    /// >>> bool(np.isclose((traction * np.diff(level, prepend=0.0)).sum(), contact.force))    # the force of p_e(l) is l
    /// True
    fn tractions<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        rows_of(py, slf.get()?.tractions())
    }

    fn __repr__(slf: Shared<'_, Self>) -> PyResult<String> {
        let of = slf.get()?;
        let [time, force, approach] = [of.time(), of.force(), of.approach()].map(digits);
        Ok(format!("StatesContact(time={time} s, force={force} N, approach={approach} m)"))
    }
}

getters! {by get StatesContact, of, py:
    /// The pressure [Pa] of the shape of the grid, from the states of a sweep with `keep_pressures`.
    pressure: Array<'py> = on_grid(py, of, free(py, || of.pressure()).or_raise()?)?;
    /// Time [s].
    time: f64 = of.time();
    /// Normal force [N].
    force: f64 = of.force();
    /// Approach of the origin [m].
    approach: f64 = of.approach();
    /// Tilt along x1 and x2 [rad].
    tilt: (f64, f64) = of.tilt().into();
    /// Level: the elastic contact at this level has the same area [m²].
    level: f64 = of.level();
    /// Number of groups of levels, each with its own past.
    groups: usize = of.groups();
    /// Contact area [m²].
    contact_area: f64 = of.contact_area();
    /// Stiffness over the contact modulus [m].
    stiffness_over_modulus: f64 = of.stiffness_over_modulus();
    /// Whether the bodies are apart.
    is_separated: bool = of.is_separated();
}

/// A field on the grid of the states.
pub fn on_grid<'py>(py: Python<'py>, of: &st::StatesContact, field: Vec<f64>) -> PyResult<Array<'py>> {
    let grid = of.states().grid();
    to_array(py, field, &grid.map_or_else(Vec::new, |grid| grid.cells().to_vec()))
}
