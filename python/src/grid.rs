//! The grid of a contact.

use crate::prelude::*;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyOverflowError;
use pyo3::types::PyBool;

/// A number of things: ValueError below 0, as of any number that is not allowed.
#[derive(Clone, Copy, IntoPyObject)]
#[pyo3(transparent)]
pub struct Count(pub usize);

impl FromPyObject<'_, '_> for Count {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, '_, PyAny>) -> PyResult<Count> {
        let refused = || {
            PyValueError::new_err(format!("{} is not allowed: a whole number from 0 to 2^64 - 1 is needed", &*given))
        };
        let is_number = given.extract::<usize>().map(Count);
        is_number.map_err(|error| if error.is_instance_of::<PyOverflowError>(given.py()) { refused() } else { error })
    }
}

/// The same of an argument with a default.
pub fn count(given: &Object<'_>) -> PyResult<usize> {
    given.extract::<Count>().map(|count| count.0)
}

/// A number, or a number for each axis.
pub struct PerAxis<T>(pub [T; 2]);

impl<'a, 'py, T: Copy + FromPyObjectOwned<'py>> FromPyObject<'a, 'py> for PerAxis<T> {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<PerAxis<T>> {
        if given.is_instance_of::<PyBool>() {
            return Err(PyTypeError::new_err(format!("{} is no number", &*given)));
        }
        let both = given.extract::<T>().map(|same| [same; 2]).or_else(|_| given.extract::<[T; 2]>());
        let needed = "a number, whole where it counts cells, or a pair of them is needed";
        both.map(PerAxis).map_err(|_| PyTypeError::new_err(needed))
    }
}

/// A rectangular grid of equal cells in the plane of contact, centred on the origin.
///
/// Parameters
/// ----------
/// cells : int or (int, int)
///     Number of cells along x1 and x2; one number makes both.
/// lengths : float or (float, float)
///     Sides of the whole grid [m].
///
/// Raises ValueError if a count is zero, or a length not finite and positive.
///
/// >>> grid = Grid((64, 32), (4e-3, 2e-3))
/// >>> grid
/// Grid((64, 32), (0.004, 0.002))
/// >>> x1, x2 = grid.coordinates()
/// >>> x1.shape, x2.shape, (x1 + x2).shape
/// ((64, 1), (1, 32), (64, 32))
#[pyclass(frozen, eq, module = "viscocontact")]
#[derive(PartialEq)]
pub struct Grid(pub viscocontact::Grid);

#[pymethods]
impl Grid {
    #[new]
    fn new(cells: PerAxis<usize>, lengths: PerAxis<f64>) -> PyResult<Grid> {
        viscocontact::Grid::new(cells.0, lengths.0).or_raise().map(Grid)
    }

    /// Centres of the cells along x1, of shape (n1, 1), and along x2, of shape (1, n2) [m]: sums of functions of them have the
    /// shape of the grid.
    fn coordinates<'py>(&self, py: Python<'py>) -> PyResult<(Array<'py>, Array<'py>)> {
        let [n1, n2] = self.0.cells();
        let x1 = (0..n1).map(|i| self.0.center(i, 0)[0]).collect();
        let x2 = (0..n2).map(|j| self.0.center(0, j)[1]).collect();
        Ok((to_array(py, x1, &[n1, 1])?, to_array(py, x2, &[1, n2])?))
    }

    fn __repr__(&self) -> String {
        let (cells, lengths) = self.__getnewargs__();
        format!("Grid({cells:?}, {lengths:?})")
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__().into_pyobject(py)?.hash()
    }

    fn __getnewargs__(&self) -> ((usize, usize), (f64, f64)) {
        (self.0.cells().into(), self.0.lengths().into())
    }
}

getters! {Grid, of:
    /// Number of cells along x1 and x2: the shape of every field.
    shape: (usize, usize) = of.cells().into();
    /// Sides of the whole grid [m].
    lengths: (f64, f64) = of.lengths().into();
    /// Sides of a cell [m].
    spacing: (f64, f64) = of.spacing().into();
    /// Area of a cell [m²].
    cell_area: f64 = of.cell_area();
}
