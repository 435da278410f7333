//! Influence kernels: the bodies.

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use viscocontact::{self as vc, Axis};

use crate::arrays::field;
use crate::prelude::*;

/// The axis of an index, 0 or 1.
pub fn axis(index: usize) -> PyResult<Axis> {
    Axis::BOTH
        .get(index)
        .copied()
        .ok_or_else(|| PyValueError::new_err(format!("axis = {index} is not allowed: it must be 0 (x1) or 1 (x2)")))
}

made! {
    /// A layer on a base.
    ///
    /// >>> Layer.bonded_to_rigid(1e-3, 0.5).thickness
    /// 0.001
    #[pyclass(frozen, module = "viscocontact")]
    Layer(layer: vc::Layer)
}

makers! {Layer, py:
    /// A layer of `thickness` [m] and Poisson's ratio `nu`, bonded to a rigid base.
    bonded_to_rigid(thickness: f64, nu: f64) = vc::Layer::bonded_to_rigid(thickness, nu);

    /// A layer that lies on a rigid base without friction.
    frictionless_on_rigid(thickness: f64, nu: f64) = vc::Layer::frictionless_on_rigid(thickness, nu);

    /// A layer bonded to a half-space of the same creep function: `shear_ratio` is the layer's shear modulus over the base's.
    bonded_to_half_space(thickness: f64, nu: f64, shear_ratio: f64, base_nu: f64) =
        vc::Layer::bonded_to_half_space(thickness, nu, shear_ratio, base_nu);
}

getters! {Layer.layer, of:
    /// Thickness [m].
    thickness: f64 = of.thickness();
    /// Poisson's ratio.
    nu: f64 = of.poisson_ratio();
}

made! {
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
    InfluenceKernel(pub kernel: Arc<vc::InfluenceKernel>) of vc::InfluenceKernel => Arc::new
}

/// What is made on a grid, without the GIL.
fn on<T: Send>(grid: &Bound<'_, Grid>, make: impl FnOnce(&vc::Grid) -> T + Send) -> T {
    let (py, grid) = (grid.py(), &grid.get().0);
    free(py, || make(grid))
}

makers! {InfluenceKernel, py:
    /// A half-space, by Love's coefficients.
    half_space(grid: Bound<'_, Grid>) = on(&grid, vc::InfluenceKernel::half_space);

    /// A half-space that is periodic along both axes, the grid being one period.
    periodic(grid: Bound<'_, Grid>) = on(&grid, vc::InfluenceKernel::periodic);

    /// A half-space that is periodic along one axis (0 or 1); displacements are measured from the surface at the distance `datum` [m].
    periodic_along(grid: Bound<'_, Grid>, along: usize, datum: f64) = {
        let axis = axis(along)?;
        on(&grid, |grid| vc::InfluenceKernel::periodic_along(grid, axis, datum))
    };

    /// A line contact in plane strain, on a grid of n × 1 cells; displacements are measured from the surface at the distance `datum` [m].
    line(grid: Bound<'_, Grid>, datum: f64) = on(&grid, |grid| vc::InfluenceKernel::line(grid, datum));

    /// A layer, loaded on the grid alone.
    layer(grid: Bound<'_, Grid>, layer: Bound<'_, Layer>) = {
        let of = layer.get().layer;
        on(&grid, |grid| vc::InfluenceKernel::layer(grid, of))
    };

    /// A layer that is periodic along both axes.
    layer_periodic(grid: Bound<'_, Grid>, layer: Bound<'_, Layer>) = {
        let of = layer.get().layer;
        on(&grid, |grid| vc::InfluenceKernel::layer_periodic(grid, of))
    };

    /// A layer in line contact, on a grid of n × 1 cells; on a half-space, with a `datum` [m].
    #[pyo3(signature = (grid, layer, datum=None))]
    layer_line(grid: Bound<'_, Grid>, layer: Bound<'_, Layer>, datum: Option<f64>) = {
        let of = layer.get().layer;
        on(&grid, |grid| vc::InfluenceKernel::layer_line(grid, of, datum))
    };

    /// A layer that is periodic along one axis (0 or 1).
    #[pyo3(signature = (grid, layer, along, datum=None))]
    layer_periodic_along(grid: Bound<'_, Grid>, layer: Bound<'_, Layer>, along: usize, datum: Option<f64>) = {
        let (of, axis) = (layer.get().layer, axis(along)?);
        on(&grid, |grid| vc::InfluenceKernel::layer_periodic_along(grid, of, axis, datum))
    };

    /// Your own body: `coefficient(i, j)` [m] is the displacement, over the compliance, of a cell under a unit pressure on the cell
    /// that is i and j cells away.
    from_coefficients(grid: Bound<'_, Grid>, coefficient: Function) = {
        let kept = Kept::default();
        let call = |i: isize, j: isize| kept.number(coefficient.call((i, j)), f64::NAN);
        kept.raise_or(Ok(on(&grid, |grid| vc::InfluenceKernel::from_coefficients(grid, call))))?
    };

    /// Your own body, periodic along both axes: `compliance(q1, q2)` [m] is the displacement, over the compliance, under a wave of unit
    /// pressure of these wave numbers [rad/m].
    from_spectrum(grid: Bound<'_, Grid>, compliance: Function) = {
        let kept = Kept::default();
        let call = |q1: f64, q2: f64| kept.number(compliance.call((q1, q2)), f64::NAN);
        kept.raise_or(Ok(on(&grid, |grid| vc::InfluenceKernel::from_spectrum(grid, call))))?
    };
}

#[pymethods]
impl InfluenceKernel {
    /// K p [Pa·m] of a `pressure` [Pa], one value per cell: the displacement under it of a body of compliance 1/Pa.
    ///
    /// With `out`, an array of float64 of the shape of the grid, into it: no array is made.
    /// Raises ValueError if the shape is another, a value is NaN, or `out` is read-only or not contiguous in C order.
    #[pyo3(signature = (pressure, out=None))]
    fn convolve<'py>(&self, py: Python<'py>, pressure: &Object<'py>, out: Option<Object<'py>>) -> PyResult<Array<'py>> {
        let cells = self.kernel.grid().cells();
        let pressure = field("pressure", pressure, cells)?;
        let kernel = &self.kernel;
        let convolve = |values: &mut [f64]| {
            free(py, || kernel.workspace().and_then(|mut work| kernel.convolve(&pressure, values, &mut work)))
                .or_raise()
        };
        let Some(out) = out else {
            let mut values = vec![0.0; pressure.len()];
            convolve(&mut values)?;
            return to_array(py, values, &cells);
        };
        let needed = |what: String| PyValueError::new_err(format!("out: {what}"));
        let array =
            out.cast::<PyArrayDyn<f64>>().map_err(|_| PyTypeError::new_err("out: an array of float64 is needed"))?;
        // a slice of NumPy is one of Fortran's order, too
        if *array.shape() != cells || !array.is_c_contiguous() {
            return Err(needed(format!("a contiguous array in C order of the shape {cells:?} of the grid is needed")));
        }
        let mut writable = array.try_readwrite().map_err(|error| needed(error.to_string()))?;
        convolve(writable.as_slice_mut().map_err(|error| needed(error.to_string()))?)?;
        drop(writable);
        Ok(array.clone())
    }

    /// The influence coefficient K(i, j) [m].
    fn coefficient(&self, i: isize, j: isize) -> PyResult<f64> {
        self.kernel.coefficient(i, j).or_raise()
    }
}

getters! {InfluenceKernel.kernel, of:
    /// The grid.
    grid: Grid = Grid(of.grid().clone());
}
