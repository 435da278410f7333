//! Plans: domain, mesh and steps for an accuracy.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact::plan::{self as vp, Accuracy};
use viscocontact::run::Stepping;
use viscocontact::{Axis, Error};

use crate::contact::ViscoelasticContact;
use crate::errors::{OrRaise, raised_number};
use crate::grid::Grid;
use crate::interrupt::Listener;
use crate::kernels::InfluenceKernel;
use crate::loads::history;
use crate::materials::Material;
use crate::recipe::Recipe;
use crate::shapes::Shape;
use crate::temperature::TemperatureHistory;

/// A run planned for an accuracy: the domain, the cells and the steps that it needs, and their cost.
///
/// Parameters
/// ----------
/// shape : Shape
/// material : Material
/// load : as of `follow`
/// until : float
///     The end of the run [s].
/// accuracy : float, default 1e-3
///     Of approach, force and, where it is finite, peak pressure, relative to their greatest values; in [1e-6, 0.1].
/// area : bool
///     Whether the contact radius has this accuracy, too, at all times.
/// fields : list of float
///     Times [s] at which the pressure field has this accuracy too, in L1 over its load, in a run that is sampled there with
///     `fields_to=plan.fields_to`.
/// kernel : function, optional
///     Another body than a half-space: a function of a `Grid` that returns its `InfluenceKernel`.
/// periods : (float or None, float or None)
///     Sides of the domain that are periods of the body [m].
/// line : float, optional
///     The length of a line contact [m].
/// temperature : TemperatureHistory, optional
/// progress : function, optional
///     Called with the number of steps tried, cells, time and work so far; the plan ends with `Cancelled` where it returns False. Ctrl-C
///     ends it between two contact problems.
///
/// >>> body = Material(Rheology.maxwell(1e6, 1.0))
/// >>> plan = Plan(Shape.sphere(10e-3), body, Load.force(1.0), 2.0, accuracy=1e-2)
/// >>> run = plan.contact().follow(Load.force(1.0), 2.0, tolerance=plan.tolerance)
/// >>> table = run.table()
#[pyclass(frozen, module = "viscocontact")]
pub struct Plan {
    plan: vp::Plan,
    parts: (Py<Shape>, Py<Material>),
    kernel: Option<Py<PyAny>>,
    temperature: Option<Py<TemperatureHistory>>,
}

#[pymethods]
impl Plan {
    #[new]
    #[pyo3(signature = (shape, material, load, until, *, accuracy=1e-3, area=false, fields=Vec::new(), kernel=None, periods=(None, None), line=None, temperature=None, progress=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        shape: Py<Shape>,
        material: Py<Material>,
        load: &Bound<'_, PyAny>,
        until: f64,
        accuracy: f64,
        area: bool,
        fields: Vec<f64>,
        kernel: Option<Py<PyAny>>,
        periods: (Option<f64>, Option<f64>),
        line: Option<f64>,
        temperature: Option<Py<TemperatureHistory>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Plan> {
        let (history, accuracy) = (history(load)?, Accuracy::new(accuracy).or_raise()?);
        let (geometry, body) = (&*shape.get().geometry, &material.get().material);
        let (made, temperature_of) =
            (kernel.as_ref(), temperature.as_ref().map(|temperature| &temperature.get().history));
        let mut listener = Listener::new(progress);
        let plan = py.detach(|| {
            let of_grid = |grid: &viscocontact::Grid| kernel_on(made, grid);
            let mut plan =
                vp::Plan::builder(geometry, body, &*history, until).accuracy(accuracy).area(area).fields_at(&fields);
            for (axis, period) in Axis::BOTH.into_iter().zip([periods.0, periods.1]) {
                if let Some(length) = period {
                    plan = plan.period(axis, length);
                }
            }
            if made.is_some() {
                plan = plan.kernel(&of_grid);
            }
            if let Some(length) = line {
                plan = plan.line(length);
            }
            if let Some(temperature) = temperature_of {
                plan = plan.temperature(temperature);
            }
            plan.build_with(|at| listener.goes_on((at.steps, at.cells, at.time, at.work)))
        });
        Ok(Plan { plan: listener.result(plan.or_raise())?, parts: (shape, material), kernel, temperature })
    }

    /// The contact of the plan, at rest.
    fn contact(&self, py: Python<'_>) -> PyResult<ViscoelasticContact> {
        let builder = self.plan.builder.clone();
        let contact = py.detach(|| builder.build()).or_raise()?;
        let (grid, settings, keywords) = (self.grid(), contact.settings(), PyDict::new(py));
        keywords.set_item("tolerance", settings.tolerance())?;
        keywords.set_item("series_tolerance", settings.series_tolerance())?;
        if let Some(kernel) = &self.kernel {
            keywords.set_item("kernel", kernel.call1(py, (self.grid(),))?)?;
        }
        if let Some(temperature) = &self.temperature {
            keywords.set_item("temperature", temperature.clone_ref(py))?;
        }
        let parts = (Py::new(py, grid)?, self.parts.0.clone_ref(py), self.parts.1.clone_ref(py));
        Ok(ViscoelasticContact::of(contact, Recipe::new(py, "", parts)?.with_keywords(Some(&keywords))?))
    }

    fn __str__(&self) -> String {
        self.plan.to_string()
    }

    fn __repr__(&self) -> String {
        let [n1, n2] = self.plan.grid.cells();
        format!(
            "Plan({n1} × {n2} cells, {} steps, {:.0} convolutions, {} bytes)",
            self.plan.steps, self.plan.convolutions, self.plan.bytes
        )
    }
}

getters! {Plan.plan, of:
    /// The grid.
    grid: Grid = Grid(of.grid.clone());
    /// The tolerance of the steps, for `follow`.
    tolerance: f64 = match of.stepping {
        Stepping::Adaptive { tolerance } => tolerance,
        Stepping::Fixed { .. } => f64::NAN,
        _ => f64::NAN,
    };
    /// Expected extent of the contact from the middle of the grid, along x1 and x2 [m].
    reach: (f64, f64) = of.reach.into();
    /// Approximate number of steps.
    steps: usize = of.steps;
    /// Approximate number of convolution equivalents.
    convolutions: f64 = of.convolutions;
    /// Approximate memory [bytes].
    bytes: u64 = of.bytes;
    /// Expected error in time of approach and force, relative to their greatest values.
    time_error: Option<f64> = of.time_error;
    /// Expected error of the mesh of approach and force, relative to their greatest values.
    mesh_error: f64 = of.mesh_error.approach;
    /// The accuracy in time of fields, for `follow`; None if no fields were asked for.
    fields_to: Option<f64> = of.fields;
    /// Expected error of the mesh of the pressure field, in L1 over its load, at the times asked for or at the end.
    field_error: f64 = of.mesh_error.pressure_field;
    /// Times at which steps end besides, for `follow`: with them the run has the greatest pressure that is promised [s].
    stops: Vec<f64> = of.stops.clone();
    /// Whether the greatest pressure of the run is promised.
    pressure_converges: bool = of.pressure_converges();
    /// Why the greatest pressure of the run is not promised.
    pressure_doubt: Option<&'static str> = of.pressure_doubt();
}

/// The kernel that a function in Python makes on a grid.
fn kernel_on(
    function: Option<&Py<PyAny>>,
    grid: &viscocontact::Grid,
) -> viscocontact::Result<viscocontact::InfluenceKernel> {
    let what = "the kernel of a plan";
    let made = Python::attach(|py| {
        let made = function.map(|function| function.call1(py, (Grid(grid.clone()),))).transpose()?;
        made.map(|made| Ok(Arc::clone(&made.bind(py).cast::<InfluenceKernel>()?.get().kernel))).transpose()
    });
    raised_number(made, None).map(Arc::unwrap_or_clone).ok_or(Error::Cancelled { what })
}
