//! Reports of steps, and states of bodies.

use crate::prelude::*;
use viscocontact::contact as ct;

/// The outcome and the cost of one step.
///
/// >>> contact = ViscoelasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> report = contact.step(0.5, Load.force(0.5))
/// >>> report.time, report.as_dict()["force"], report.warnings
/// (0.5, 0.5, [])
#[pyclass(frozen, module = "viscocontact")]
pub struct StepReport(pub ct::StepReport);

#[pymethods]
impl StepReport {
    fn __repr__(&self) -> String {
        self.0.to_string()
    }
}

/// The numbers behind warnings, by their names.
pub fn figures<'py>(py: Python<'py>, of: &ct::Figures) -> PyResult<Dict<'py>> {
    Ok(dict! { py;
        of { max_slope, compression, cells_across, cells_in_wave, periods, cells_in_zone, modulus, touch, unmeasured, wake }
    })
}

numbers!(StepReport);

getters! {StepReport, of, py:
    /// The numbers behind the warnings, None where the scene is far from the limit: "max_slope", "compression", "cells_across", "cells_in_wave", "periods",
    /// "cells_in_zone", "modulus" [Pa], "touch" [m], "unmeasured" and "wake".
    figures: PyResult<Dict<'py>> = figures(py, &of.figures);
    /// Time at the end of the step [s].
    time: f64 = of.time;
    /// Length of the step [s]; 0 for a jump of the load.
    dt: f64 = of.dt;
    /// Normal force on all bodies together [N].
    force: f64 = of.force;
    /// Approach of the first body, at the origin [m].
    approach: f64 = of.approach;
    /// Tilt of the first body along x1 and x2 [rad].
    tilt: (f64, f64) = of.tilt.into();
    /// Cells in contact.
    contact_cells: usize = of.contact_cells;
    /// Estimated relative error in time of the step; None where there is no estimate, as on elastic states by `step` or with `dt`.
    time_error: Option<f64> = of.time_error;
    /// The quantity of which this is the error: "approach", "force", or both.
    estimated: String = of.estimated.to_string();
    /// Iterations of the solver.
    iterations: usize = of.iterations;
    /// Iterations by the fall-back solver.
    fallback_iterations: usize = of.fallback_iterations;
    /// Convolutions with the kernel.
    convolutions: usize = of.convolutions;
    /// Applications of the preconditioner.
    preconditioner_applications: usize = of.preconditioner_applications;
    /// The transforms of the step in units of one convolution.
    convolution_equivalents: f64 = of.convolution_equivalents();
    /// Residual reached, in the measure of the setting `tolerance`.
    residual: f64 = of.residual;
    /// Reasons why the result may be less accurate than expected, a line each.
    warnings: Vec<String> = of.messages().map(in_python).collect();
}

/// The state of one rigid body.
///
/// >>> contact = ElasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), 4e6)
/// >>> _ = contact.solve(Load.force(0.5))
/// >>> contact.bodies[0].force
/// 0.5
#[pyclass(frozen, module = "viscocontact")]
pub struct BodyState(pub ct::BodyState);

#[pymethods]
impl BodyState {
    fn __repr__(&self) -> String {
        let [force, approach] = [self.0.force, self.0.approach].map(digits);
        format!("BodyState(force={force} N, approach={approach} m, contact_cells={})", self.0.contact_cells)
    }
}

numbers!(BodyState);

getters! {BodyState, of:
    /// Approach at the origin of the grid [m].
    approach: f64 = of.approach;
    /// Tilt along x1 and x2 [rad].
    tilt: (f64, f64) = of.tilt.into();
    /// Normal force [N].
    force: f64 = of.force;
    /// Moments of the pressure about the origin, ∬ p x1 and ∬ p x2 [N·m].
    moment: (f64, f64) = of.moment.into();
    /// Cells in contact.
    contact_cells: usize = of.contact_cells;
}
