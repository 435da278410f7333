//! Friction and gradients of contacts on elastic states.

use viscocontact::states as st;

use crate::prelude::*;
use crate::states_contact::on_grid;

/// A contact with the friction of keywords.
pub fn rubbing(
    contact: st::StatesContact,
    friction: Option<f64>,
    estimated_friction: Option<f64>,
    sheared_by: Option<&Bound<'_, LoadHistory>>,
) -> PyResult<st::StatesContact> {
    let contact = match (friction, estimated_friction) {
        (None, None) => contact,
        (Some(coefficient), None) => contact.with_friction(coefficient).or_raise()?,
        (None, Some(coefficient)) => contact.with_estimated_friction(coefficient).or_raise()?,
        _ => return Err(PyTypeError::new_err("give friction or estimated_friction, not both")),
    };
    match sheared_by {
        Some(load) => contact.sheared_by(Arc::clone(&load.get().history)).or_raise(),
        None => Ok(contact),
    }
}

#[pymethods]
impl StatesContact {
    /// `step`, with a load along the surface: a force, an approach as its displacement, or a spring.
    ///
    /// Raises `Slides` if the force is more than friction carries.
    fn step_sheared(
        mut slf: Taken<'_, Self>,
        py: Python<'_>,
        dt: f64,
        load: &Load,
        along: &Load,
    ) -> PyResult<StepReport> {
        let (contact, load, along) = (slf.held.free()?, load.load, along.load);
        free(py, || contact.step_sheared(dt, load, along)).or_raise().map(StepReport)
    }

    /// The traction along the surface as a sum of elastic pressures: rows (level [m²], traction [Pa]), as of `tractions`.
    fn shear_tractions<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        rows_of(py, slf.get()?.shear_tractions())
    }

    /// How the approach of the load point would change now, ∂ω/∂g, had each cell been higher by a little from the start: of the shape of
    /// the grid, of the sum 1 in contact. Right for any history of forces, on states of a sweep of this process.
    ///
    /// It takes an elastic contact for each group of levels. Ctrl-C ends it within an iteration.
    ///
    /// >>> rubber = Material(Rheology.zener(1e6, 1e6, 1.0))
    /// >>> contact = StatesContact(ElasticStates.sweep(Grid(32, 4e-3), Shape.sphere(10e-3), level=6e-7), rubber)
    /// >>> for dt, force in [(0.0, 0.5), (1.0, 0.5), (1.0, 0.1)]:
    /// ...     report = contact.step(dt, Load.force(force))
    /// >>> gradient = contact.approach_gradient()
    /// >>> gradient.shape, round(float(gradient.sum()), 9)
    /// ((32, 32), 1.0)
    fn approach_gradient<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        let (contact, cancel) = (slf.get()?, &*slf.cancel);
        let gradient = interruptible(py, true, cancel, || contact.approach_gradient_unless(cancel))?;
        on_grid(py, contact, gradient)
    }
}

getters! {by get StatesContact, of, py:
    /// Where the work along the surface went since the contact was made [J]: "work" = "slip" + "stored" + "creep".
    lateral_work: Dict<'py> = {
        let of = of.lateral_work();
        dict! { py; of { work, slip, stored, creep } }
    };
    /// The traction along the surface [Pa], of the shape of the grid, from the states of a sweep with `keep_pressures`.
    shear: Array<'py> = on_grid(py, of, free(py, || of.shear()).or_raise()?)?;
    /// Force along the surface that moves the body [N]; 0 without friction.
    lateral_force: f64 = of.lateral_force();
    /// Displacement of the body along the surface [m], how far it has slid included.
    lateral_displacement: f64 = of.lateral_displacement();
    /// How far the whole contact has slid [m], beyond its partial slip; of bodies apart, how far they moved freely.
    slid: f64 = of.slid();
    /// Level up to which the contact sticks [m²]: 0 where all of it slides, `level` where nothing slips.
    stick_level: f64 = of.stick_level();
    /// Area that sticks [m²].
    stick_area: f64 = of.stick_area();
}

#[pymethods]
impl ElasticContact {
    /// How the approach changes with the height of each cell, ∂ω/∂g, under a force on a body that does not tilt: of the shape of the grid,
    /// of the sum 1 in contact. The gap is greater where the body is higher. Held at its approach, the body changes its force by
    /// −modulus · `stiffness_over_modulus()` · ∂ω/∂g.
    ///
    /// >>> contact = ElasticContact(Grid(32, 3e-3), Shape.sphere(10e-3), 4e6)
    /// >>> _ = contact.solve(Load.force(0.3))
    /// >>> round(float(contact.approach_gradient().sum()), 9)
    /// 1.0
    fn approach_gradient<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        let fields = slf.contact.fields();
        let gradient = free(py, || fields.approach_gradient()).or_raise()?;
        to_array(py, gradient, &fields.grid().cells())
    }
}
