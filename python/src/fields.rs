//! Fields and numbers of the state of a contact.

use pyo3::prelude::*;
use viscocontact as vc;

use crate::arrays::{Array, to_array};
use crate::contact::ViscoelasticContact;
use crate::errors::OrRaise;
use crate::grid::Grid;
use crate::reports::BodyState;

impl ViscoelasticContact {
    /// A field that the contact writes.
    fn field<'py>(
        &self,
        py: Python<'py>,
        write: impl FnOnce(&vc::ViscoelasticContact, &mut [f64]) -> vc::Result<()> + Send,
    ) -> PyResult<Array<'py>> {
        let contact = self.get()?;
        let mut values = vec![0.0; contact.grid().len()];
        py.detach(|| write(contact, &mut values)).or_raise()?;
        to_array(py, values, &contact.grid().cells())
    }
}

#[pymethods]
impl ViscoelasticContact {
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
        self.field(py, |contact, out| contact.gap_into(out))
    }

    /// Net traction [Pa]: the pressure less the attraction, of the shape of the grid.
    #[getter]
    fn traction<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.field(py, |contact, out| contact.traction_into(out))
    }

    /// Time [s].
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.get()?.time())
    }

    /// Reduced time of the material [s].
    #[getter]
    fn reduced_time(&self) -> PyResult<f64> {
        Ok(self.get()?.reduced_time())
    }

    /// The grid of every field.
    #[getter]
    fn grid(&self) -> PyResult<Grid> {
        Ok(Grid(self.get()?.grid().clone()))
    }

    /// Normal force on all bodies [N].
    #[getter]
    fn force(&self) -> PyResult<f64> {
        Ok(self.get()?.force())
    }

    /// Approach of the first body, at the origin [m].
    #[getter]
    fn approach(&self) -> PyResult<f64> {
        Ok(self.get()?.approach())
    }

    /// Tilt of the first body along x1 and x2 [rad].
    #[getter]
    fn tilt(&self) -> PyResult<(f64, f64)> {
        Ok(self.get()?.tilt().into())
    }

    /// Moments of the pressure about the origin, ∬ p x1 and ∬ p x2 [N·m].
    #[getter]
    fn moment(&self) -> PyResult<(f64, f64)> {
        Ok(self.get()?.moment().into())
    }

    /// Cells in contact.
    #[getter]
    fn contact_cells(&self) -> PyResult<usize> {
        Ok(self.get()?.contact_cells())
    }

    /// Area of contact [m²], fractions of cells included.
    #[getter]
    fn contact_area(&self) -> PyResult<f64> {
        Ok(self.get()?.contact_area())
    }

    /// Mean pressure over the contact [Pa].
    #[getter]
    fn mean_pressure(&self) -> PyResult<f64> {
        Ok(self.get()?.mean_pressure())
    }

    /// Greatest pressure of any cell [Pa].
    #[getter]
    fn max_pressure(&self) -> PyResult<f64> {
        Ok(self.get()?.max_pressure())
    }

    /// Whether the bodies are apart.
    #[getter]
    fn is_separated(&self) -> PyResult<bool> {
        Ok(self.get()?.is_separated())
    }

    /// The state of each rigid body.
    #[getter]
    fn bodies(&self) -> PyResult<Vec<BodyState>> {
        let contact = self.get()?;
        Ok((0..contact.bodies()).filter_map(|body| contact.body(body)).map(BodyState).collect())
    }

    /// The errors of exponential series that were fitted for this contact, a line each.
    #[getter]
    fn fit_reports(&self) -> PyResult<Vec<String>> {
        Ok(self.get()?.material().fit_reports().map(ToString::to_string).collect())
    }
}
