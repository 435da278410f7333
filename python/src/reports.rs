//! Reports of steps, and states of bodies.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact::contact as ct;

/// The outcome and the cost of one step.
#[pyclass(frozen, module = "viscocontact")]
pub struct StepReport(pub ct::StepReport);

#[pymethods]
impl StepReport {
    /// Time at the end of the step [s].
    #[getter]
    fn time(&self) -> f64 {
        self.0.time
    }

    /// Length of the step [s]; 0 for a jump of the load.
    #[getter]
    fn dt(&self) -> f64 {
        self.0.dt
    }

    /// Normal force on all bodies together [N].
    #[getter]
    fn force(&self) -> f64 {
        self.0.force
    }

    /// Approach of the first body, at the origin [m].
    #[getter]
    fn approach(&self) -> f64 {
        self.0.approach
    }

    /// Tilt of the first body along x1 and x2 [rad].
    #[getter]
    fn tilt(&self) -> (f64, f64) {
        self.0.tilt.into()
    }

    /// Cells in contact.
    #[getter]
    fn contact_cells(&self) -> usize {
        self.0.contact_cells
    }

    /// Estimated relative error in time of the step; None where there is no estimate.
    #[getter]
    fn time_error(&self) -> Option<f64> {
        self.0.time_error
    }

    /// Iterations of the solver.
    #[getter]
    fn iterations(&self) -> usize {
        self.0.iterations
    }

    /// Iterations by the fall-back solver.
    #[getter]
    fn fallback_iterations(&self) -> usize {
        self.0.fallback_iterations
    }

    /// The transforms of the step in units of one convolution.
    #[getter]
    fn convolution_equivalents(&self) -> f64 {
        self.0.convolution_equivalents()
    }

    /// Residual reached, in the measure of the setting `tolerance`.
    #[getter]
    fn residual(&self) -> f64 {
        self.0.residual
    }

    /// Reasons why the result may be less accurate than expected, a line each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.messages().collect()
    }

    /// The numbers by name: a row of a `pandas.DataFrame`.
    fn as_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (all, of) = (PyDict::new(py), &self.0);
        let numbers = [
            ("time", of.time),
            ("dt", of.dt),
            ("force", of.force),
            ("approach", of.approach),
            ("tilt1", of.tilt[0]),
            ("tilt2", of.tilt[1]),
            ("convolution_equivalents", of.convolution_equivalents()),
            ("residual", of.residual),
        ];
        for (name, value) in numbers {
            all.set_item(name, value)?;
        }
        all.set_item("contact_cells", of.contact_cells)?;
        all.set_item("time_error", of.time_error)?;
        all.set_item("iterations", of.iterations)?;
        all.set_item("fallback_iterations", of.fallback_iterations)?;
        all.set_item("warnings", of.messages().collect::<Vec<_>>())?;
        Ok(all)
    }

    fn __repr__(&self) -> String {
        self.0.to_string()
    }
}

/// The state of one rigid body.
#[pyclass(frozen, module = "viscocontact")]
pub struct BodyState(pub ct::BodyState);

#[pymethods]
impl BodyState {
    /// Approach at the origin of the grid [m].
    #[getter]
    fn approach(&self) -> f64 {
        self.0.approach
    }

    /// Tilt along x1 and x2 [rad].
    #[getter]
    fn tilt(&self) -> (f64, f64) {
        self.0.tilt.into()
    }

    /// Normal force [N].
    #[getter]
    fn force(&self) -> f64 {
        self.0.force
    }

    /// Moments of the pressure about the origin, ∬ p x1 and ∬ p x2 [N·m].
    #[getter]
    fn moment(&self) -> (f64, f64) {
        self.0.moment.into()
    }

    /// Cells in contact.
    #[getter]
    fn contact_cells(&self) -> usize {
        self.0.contact_cells
    }

    fn __repr__(&self) -> String {
        let of = &self.0;
        format!(
            "BodyState(force={:e}, approach={:e}, tilt={:?}, contact_cells={})",
            of.force, of.approach, of.tilt, of.contact_cells
        )
    }
}
