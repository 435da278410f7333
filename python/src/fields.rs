//! Fields and numbers of the state of a contact.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact as vc;

use crate::arrays::{Array, to_array};
use crate::contact::ViscoelasticContact;
use crate::errors::OrRaise;
use crate::grid::Grid;
use crate::loads::Load;
use crate::reports::BodyState;
use crate::sliding::SteadySliding;

/// The fields of a class that has a contact in space.
macro_rules! fields {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            /// Pressure [Pa], of the shape of the grid.
            #[getter]
            fn pressure<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
                let contact = self.get()?;
                to_array(py, contact.pressure().to_vec(), &contact.grid().cells())
            }

            /// Displacement of the surface, positive into the bodies [m], of the shape of the grid.
            #[getter]
            fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
                let contact = self.get()?;
                to_array(py, contact.displacement().to_vec(), &contact.grid().cells())
            }

            /// Gap between the deformed bodies [m], of the shape of the grid; +inf where there is nothing to touch.
            #[getter]
            fn gap<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
                field(py, self.get()?, vc::ViscoelasticContact::gap_into)
            }

            /// Net traction [Pa]: the pressure less the attraction, of the shape of the grid.
            #[getter]
            fn traction<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
                field(py, self.get()?, vc::ViscoelasticContact::traction_into)
            }
        }
    };
}

fields!(ViscoelasticContact);
fields!(SteadySliding);

/// A field that a contact writes.
fn field<'py>(
    py: Python<'py>,
    contact: &vc::ViscoelasticContact,
    write: fn(&vc::ViscoelasticContact, &mut [f64]) -> vc::Result<()>,
) -> PyResult<Array<'py>> {
    let mut values = vec![0.0; contact.grid().len()];
    py.detach(|| write(contact, &mut values)).or_raise()?;
    to_array(py, values, &contact.grid().cells())
}

#[pymethods]
impl ViscoelasticContact {
    /// The state of each rigid body.
    #[getter]
    fn bodies(&self) -> PyResult<Vec<BodyState>> {
        let contact = self.get()?;
        Ok((0..contact.bodies()).filter_map(|body| contact.body(body)).map(BodyState).collect())
    }

    /// The load of the last step.
    #[getter]
    fn load(&self, py: Python<'_>) -> PyResult<Load> {
        Load::of(py, self.get()?.load())
    }

    /// How the last step of surfaces that attract each other went: contact problems ("passes"), those given up ("rejected"), the greatest
    /// "rise" of the energy over the sum of its parts, the energy "released" [J], and whether the surfaces "jumped". None without attraction.
    #[getter]
    fn passes<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(of) = self.get()?.passes() else { return Ok(None) };
        Ok(Some(dict! { py;
            "passes": of.passes,
            "rejected": of.rejected,
            "rise": of.rise,
            "released": of.released,
            "jumped": of.jumped,
        }))
    }
}

getters! {try ViscoelasticContact, of:
    /// Time [s].
    time: f64 = of.time();
    /// Reduced time of the material [s].
    reduced_time: f64 = of.reduced_time();
    /// The grid of every field.
    grid: Grid = Grid(of.grid().clone());
    /// Normal force on all bodies [N].
    force: f64 = of.force();
    /// Approach of the first body, at the origin [m].
    approach: f64 = of.approach();
    /// Tilt of the first body along x1 and x2 [rad].
    tilt: (f64, f64) = of.tilt().into();
    /// Moments of the pressure about the origin, ∬ p x1 and ∬ p x2 [N·m].
    moment: (f64, f64) = of.moment().into();
    /// Cells in contact.
    contact_cells: usize = of.contact_cells();
    /// Area of contact [m²], fractions of cells included.
    contact_area: f64 = of.contact_area();
    /// Mean pressure over the contact [Pa].
    mean_pressure: f64 = of.mean_pressure();
    /// Greatest pressure of any cell [Pa].
    max_pressure: f64 = of.max_pressure();
    /// Whether the bodies are apart.
    is_separated: bool = of.is_separated();
    /// The errors of exponential series that were fitted for this contact, a line each.
    fit_reports: Vec<String> = of.material().fit_reports().map(ToString::to_string).collect();
}
