//! Influence kernels: the bodies.

use std::sync::{Arc, Mutex, PoisonError};

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use viscocontact::{self as vc, Axis};

use crate::arrays::{Array, field, to_array};
use crate::errors::OrRaise;
use crate::grid::Grid;
use crate::materials::Material;
use crate::recipe::Recipe;

/// The axis of an index, 0 or 1.
pub fn axis(index: usize) -> PyResult<Axis> {
    Axis::BOTH
        .get(index)
        .copied()
        .ok_or_else(|| PyValueError::new_err(format!("axis = {index} is not allowed: it must be 0 (x1) or 1 (x2)")))
}

/// A layer on a base.
///
/// >>> Layer.bonded_to_rigid(1e-3, 0.5).thickness
/// 0.001
#[pyclass(frozen, module = "viscocontact")]
pub struct Layer {
    layer: vc::Layer,
    recipe: Recipe,
}

#[pymethods]
impl Layer {
    /// A layer of `thickness` [m] and Poisson's ratio `nu`, bonded to a rigid base.
    #[staticmethod]
    fn bonded_to_rigid(py: Python<'_>, thickness: f64, nu: f64) -> PyResult<Layer> {
        let layer = vc::Layer::bonded_to_rigid(thickness, nu).or_raise()?;
        Ok(Layer { layer, recipe: Recipe::new(py, "bonded_to_rigid", (thickness, nu))? })
    }

    /// A layer that lies on a rigid base without friction.
    #[staticmethod]
    fn frictionless_on_rigid(py: Python<'_>, thickness: f64, nu: f64) -> PyResult<Layer> {
        let layer = vc::Layer::frictionless_on_rigid(thickness, nu).or_raise()?;
        Ok(Layer { layer, recipe: Recipe::new(py, "frictionless_on_rigid", (thickness, nu))? })
    }

    /// A layer bonded to a half-space of the same creep function: `shear_ratio` is the layer's shear modulus over the base's.
    #[staticmethod]
    fn bonded_to_half_space(
        py: Python<'_>,
        thickness: f64,
        nu: f64,
        shear_ratio: f64,
        base_nu: f64,
    ) -> PyResult<Layer> {
        let layer = vc::Layer::bonded_to_half_space(thickness, nu, shear_ratio, base_nu).or_raise()?;
        Ok(Layer { layer, recipe: Recipe::new(py, "bonded_to_half_space", (thickness, nu, shear_ratio, base_nu))? })
    }

    /// A layer of one material bonded to a half-space of another: for `SteadySliding` with `base`.
    #[staticmethod]
    fn bonded_to_material(
        py: Python<'_>,
        thickness: f64,
        layer: Bound<'_, Material>,
        base: Bound<'_, Material>,
    ) -> PyResult<Layer> {
        let made = vc::Layer::bonded_to_material(thickness, &layer.get().material, &base.get().material).or_raise()?;
        Ok(Layer { layer: made, recipe: Recipe::new(py, "bonded_to_material", (thickness, layer, base))? })
    }

    /// Thickness [m].
    #[getter]
    fn thickness(&self) -> f64 {
        self.layer.thickness()
    }

    /// Poisson's ratio.
    #[getter]
    fn nu(&self) -> f64 {
        self.layer.poisson_ratio()
    }
}

made_by_calls!(Layer);

/// The influence operator K of a grid: the surface displacement under a pressure, over the compliance. Contacts share it.
///
/// Without one a contact is on a half-space.
///
/// >>> import numpy as np
/// >>> grid = Grid(16, 1e-3)
/// >>> bodies = InfluenceKernel.periodic(grid)
/// >>> float(abs(bodies.convolve(np.ones((16, 16)))).max()) < 1e-15    # the mean of periodic bodies is their datum
/// True
#[pyclass(frozen, module = "viscocontact")]
pub struct InfluenceKernel {
    pub kernel: Arc<vc::InfluenceKernel>,
    recipe: Recipe,
}

impl InfluenceKernel {
    fn made<'py>(
        py: Python<'py>,
        maker: &'static str,
        arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
        make: impl FnOnce() -> vc::Result<vc::InfluenceKernel> + Send,
    ) -> PyResult<InfluenceKernel> {
        let kernel = py.detach(make).or_raise()?;
        Ok(InfluenceKernel { kernel: Arc::new(kernel), recipe: Recipe::new(py, maker, arguments)? })
    }
}

#[pymethods]
impl InfluenceKernel {
    /// A half-space, by Love's coefficients.
    #[staticmethod]
    fn half_space(py: Python<'_>, grid: Bound<'_, Grid>) -> PyResult<InfluenceKernel> {
        let on = &grid.clone().get().0.clone();
        InfluenceKernel::made(py, "half_space", (grid,), || vc::InfluenceKernel::half_space(on))
    }

    /// A half-space that is periodic along both axes, the grid being one period.
    #[staticmethod]
    fn periodic(py: Python<'_>, grid: Bound<'_, Grid>) -> PyResult<InfluenceKernel> {
        let on = &grid.get().0.clone();
        InfluenceKernel::made(py, "periodic", (grid,), || vc::InfluenceKernel::periodic(on))
    }

    /// A half-space that is periodic along one axis (0 or 1); displacements are measured from the surface at the distance `datum` [m].
    #[staticmethod]
    fn periodic_along(py: Python<'_>, grid: Bound<'_, Grid>, along: usize, datum: f64) -> PyResult<InfluenceKernel> {
        let (on, axis) = (&grid.get().0.clone(), axis(along)?);
        InfluenceKernel::made(py, "periodic_along", (grid, along, datum), || {
            vc::InfluenceKernel::periodic_along(on, axis, datum)
        })
    }

    /// A line contact in plane strain, on a grid of n × 1 cells; displacements are measured from the surface at the distance `datum` [m].
    #[staticmethod]
    fn line(py: Python<'_>, grid: Bound<'_, Grid>, datum: f64) -> PyResult<InfluenceKernel> {
        let on = &grid.get().0.clone();
        InfluenceKernel::made(py, "line", (grid, datum), || vc::InfluenceKernel::line(on, datum))
    }

    /// A layer, loaded on the grid alone.
    #[staticmethod]
    fn layer(py: Python<'_>, grid: Bound<'_, Grid>, layer: Bound<'_, Layer>) -> PyResult<InfluenceKernel> {
        let (on, of) = (&grid.get().0.clone(), layer.get().layer);
        InfluenceKernel::made(py, "layer", (grid, layer), || vc::InfluenceKernel::layer(on, of))
    }

    /// A layer that is periodic along both axes.
    #[staticmethod]
    fn layer_periodic(py: Python<'_>, grid: Bound<'_, Grid>, layer: Bound<'_, Layer>) -> PyResult<InfluenceKernel> {
        let (on, of) = (&grid.get().0.clone(), layer.get().layer);
        InfluenceKernel::made(py, "layer_periodic", (grid, layer), || vc::InfluenceKernel::layer_periodic(on, of))
    }

    /// A layer in line contact, on a grid of n × 1 cells; on a half-space, with a `datum` [m].
    #[staticmethod]
    #[pyo3(signature = (grid, layer, datum=None))]
    fn layer_line(
        py: Python<'_>,
        grid: Bound<'_, Grid>,
        layer: Bound<'_, Layer>,
        datum: Option<f64>,
    ) -> PyResult<InfluenceKernel> {
        let (on, of) = (&grid.get().0.clone(), layer.get().layer);
        InfluenceKernel::made(py, "layer_line", (grid, layer, datum), || vc::InfluenceKernel::layer_line(on, of, datum))
    }

    /// A layer that is periodic along one axis (0 or 1).
    #[staticmethod]
    #[pyo3(signature = (grid, layer, along, datum=None))]
    fn layer_periodic_along(
        py: Python<'_>,
        grid: Bound<'_, Grid>,
        layer: Bound<'_, Layer>,
        along: usize,
        datum: Option<f64>,
    ) -> PyResult<InfluenceKernel> {
        let (on, of, axis) = (&grid.get().0.clone(), layer.get().layer, axis(along)?);
        InfluenceKernel::made(py, "layer_periodic_along", (grid, layer, along, datum), || {
            vc::InfluenceKernel::layer_periodic_along(on, of, axis, datum)
        })
    }

    /// Your own body: `coefficient(i, j)` [m] is the displacement, over the compliance, of a cell under a unit pressure on the cell
    /// that is i and j cells away.
    #[staticmethod]
    fn from_coefficients(py: Python<'_>, grid: Bound<'_, Grid>, coefficient: Py<PyAny>) -> PyResult<InfluenceKernel> {
        let (on, kept) = (&grid.get().0.clone(), coefficient.clone_ref(py));
        let raised = Mutex::new(None);
        let call =
            |i: isize, j: isize| caught(&raised, || Python::attach(|py| coefficient.call1(py, (i, j))?.extract(py)));
        let kernel = InfluenceKernel::made(py, "from_coefficients", (grid, kept), || {
            vc::InfluenceKernel::from_coefficients(on, call)
        });
        raised_or(raised, kernel)
    }

    /// Your own body, periodic along both axes: `compliance(q1, q2)` [m] is the displacement, over the compliance, under a wave of unit
    /// pressure of these wave numbers [rad/m].
    #[staticmethod]
    fn from_spectrum(py: Python<'_>, grid: Bound<'_, Grid>, compliance: Py<PyAny>) -> PyResult<InfluenceKernel> {
        let (on, kept) = (&grid.get().0.clone(), compliance.clone_ref(py));
        let raised = Mutex::new(None);
        let call =
            |q1: f64, q2: f64| caught(&raised, || Python::attach(|py| compliance.call1(py, (q1, q2))?.extract(py)));
        let kernel =
            InfluenceKernel::made(py, "from_spectrum", (grid, kept), || vc::InfluenceKernel::from_spectrum(on, call));
        raised_or(raised, kernel)
    }

    /// The grid.
    #[getter]
    fn grid(&self) -> Grid {
        Grid(self.kernel.grid().clone())
    }

    /// K p [Pa·m] of a `pressure` [Pa], one value per cell: the displacement under it of a body of compliance 1/Pa.
    ///
    /// With `out`, an array of float64 of the shape of the grid, into it: no array is made.
    /// Raises ValueError if the shape is another, a value is NaN, or `out` is read-only.
    #[pyo3(signature = (pressure, out=None))]
    fn convolve<'py>(
        &self,
        py: Python<'py>,
        pressure: &Bound<'py, PyAny>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let cells = self.kernel.grid().cells();
        let pressure = field("pressure", pressure, cells)?;
        let Some(out) = out else {
            let mut values = vec![0.0; pressure.len()];
            py.detach(|| {
                self.kernel.workspace().and_then(|mut work| self.kernel.convolve(&pressure, &mut values, &mut work))
            })
            .or_raise()?;
            return to_array(py, values, &cells);
        };
        let array =
            out.cast::<PyArrayDyn<f64>>().map_err(|_| PyTypeError::new_err("out: an array of float64 is needed"))?;
        if *array.shape() != cells {
            return Err(PyValueError::new_err(format!(
                "out: the shape {cells:?} of the grid is needed, the array has {:?}",
                array.shape()
            )));
        }
        {
            let mut writable = array.try_readwrite().map_err(|error| PyValueError::new_err(format!("out: {error}")))?;
            let values =
                writable.as_slice_mut().map_err(|_| PyValueError::new_err("out: a contiguous array is needed"))?;
            py.detach(|| {
                self.kernel.workspace().and_then(|mut work| self.kernel.convolve(&pressure, values, &mut work))
            })
            .or_raise()?;
        }
        Ok(array.clone())
    }

    /// The influence coefficient K(i, j) [m].
    fn coefficient(&self, i: isize, j: isize) -> PyResult<f64> {
        self.kernel.coefficient(i, j).or_raise()
    }
}

made_by_calls!(InfluenceKernel);

/// NaN in place of a value that a function could not give, whose exception is kept.
fn caught(raised: &Mutex<Option<PyErr>>, value: impl FnOnce() -> PyResult<f64>) -> f64 {
    value().unwrap_or_else(|error| {
        *raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        f64::NAN
    })
}

fn raised_or<T>(raised: Mutex<Option<PyErr>>, result: PyResult<T>) -> PyResult<T> {
    raised.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(result, Err)
}
