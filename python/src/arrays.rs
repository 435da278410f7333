//! NumPy arrays of any type, order and stride to Rust, and fields back.

use crate::prelude::*;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::intern;
use viscocontact::UserError;

/// Any array of Python.
pub type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// The values of anything that NumPy makes an array of real numbers of, row by row, and its shape.
pub fn values(name: &str, object: &Object<'_>) -> PyResult<(Vec<f64>, Vec<usize>)> {
    let array =
        object.py().import(intern!(object.py(), "viscocontact._values"))?.call_method1("numbers", (name, object))?;
    let array = array.cast::<PyArrayDyn<f64>>()?;
    // another thread may be writing into it
    let readable = array.try_readonly().map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    Ok((readable.as_array().iter().copied().collect(), array.shape().to_vec()))
}

/// The values of a sequence of numbers, none of them NaN.
pub fn column(name: &str, object: &Object<'_>) -> PyResult<Vec<f64>> {
    let (values, shape) = values(name, object)?;
    if shape.len() != 1 {
        return Err(PyValueError::new_err(format!("{name}: one axis is needed, the array has the shape {shape:?}")));
    }
    no_nan(name, &values)?;
    Ok(values)
}

/// Refuses a number of values that is not one for each.
pub fn one_for_each(of: &str, name: &str, given: usize, needed: usize) -> PyResult<()> {
    if given == needed {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name}: {given} given, {needed} needed, one for each {of}")))
}

/// The pairs of two sequences.
pub fn together(names: [&str; 2], x: &Object<'_>, y: &Object<'_>) -> PyResult<Vec<(f64, f64)>> {
    let (x, y) = (column(names[0], x)?, column(names[1], y)?);
    one_for_each(&format!("of {}", names[0]), names[1], y.len(), x.len())?;
    Ok(x.into_iter().zip(y).collect())
}

/// What a builder becomes by a value, if there is one.
pub fn if_given<B, V>(builder: B, value: Option<V>, with: impl FnOnce(B, V) -> B) -> B {
    match value {
        Some(value) => with(builder, value),
        None => builder,
    }
}

/// The rows of a table of so many columns, none of its numbers NaN.
pub fn table<const N: usize>(name: &str, object: &Object<'_>) -> PyResult<Vec<[f64; N]>> {
    rows(name, values(name, object)?)
}

/// Points x, y and height, NaN where none was measured.
pub fn measured_points(name: &str, object: &Object<'_>) -> PyResult<Vec<[f64; 3]>> {
    let points = shaped(name, values(name, object)?)?;
    points.iter().try_for_each(|[x, y, _]| no_nan(name, &[*x, *y]))?;
    Ok(points)
}

fn rows<const N: usize>(name: &str, array: (Vec<f64>, Vec<usize>)) -> PyResult<Vec<[f64; N]>> {
    no_nan(name, &array.0)?;
    shaped(name, array)
}

fn shaped<const N: usize>(name: &str, (values, shape): (Vec<f64>, Vec<usize>)) -> PyResult<Vec<[f64; N]>> {
    if shape.len() != 2 || shape[1] != N {
        return Err(PyValueError::new_err(format!("{name}: the shape (n, {N}) is needed, the array has {shape:?}")));
    }
    Ok(values.as_chunks::<N>().0.to_vec())
}

/// Vectors of the plane: pairs, or a sequence of numbers along x1.
pub fn vectors(name: &str, object: &Object<'_>) -> PyResult<Vec<[f64; 2]>> {
    let (values, shape) = values(name, object)?;
    if shape.len() != 1 {
        return rows(name, (values, shape));
    }
    no_nan(name, &values)?;
    Ok(values.into_iter().map(|along| [along, 0.0]).collect())
}

/// A number; no array, of one value or more.
pub fn number(object: &Object<'_>) -> Option<f64> {
    let axes = object.getattr(intern!(object.py(), "ndim")).and_then(|axes| axes.extract::<usize>());
    if axes.unwrap_or(0) == 0 { object.extract().ok() } else { None }
}

pub fn pairs(name: &str, object: &Object<'_>) -> PyResult<Vec<(f64, f64)>> {
    Ok(table(name, object)?.into_iter().map(|[a, b]| (a, b)).collect())
}

/// The values of an array of two axes, and its shape. What NaN means is for the caller to say.
pub fn plane(name: &str, object: &Object<'_>) -> PyResult<(Vec<f64>, [usize; 2])> {
    let (values, shape) = values(name, object)?;
    match shape[..] {
        [n1, n2] => Ok((values, [n1, n2])),
        _ => Err(PyValueError::new_err(format!("{name}: two axes are needed, the array has the shape {shape:?}"))),
    }
}

/// One value for each cell, none of them NaN.
pub fn field(name: &str, object: &Object<'_>, cells: [usize; 2]) -> PyResult<Vec<f64>> {
    let values = cell_values(name, object, cells)?;
    no_nan(name, &values)?;
    Ok(values)
}

/// One value for each cell.
pub fn cell_values(name: &str, object: &Object<'_>, cells: [usize; 2]) -> PyResult<Vec<f64>> {
    let (values, shape) = plane(name, object)?;
    if shape != cells {
        return Err(PyValueError::new_err(format!(
            "{name}: the shape {cells:?} of the grid is needed, the array has {shape:?}"
        )));
    }
    Ok(values)
}

fn no_nan(name: &str, values: &[f64]) -> PyResult<()> {
    match values.iter().position(|value| value.is_nan()) {
        Some(index) => Err(PyValueError::new_err(format!("{name}: value {index} in the order of rows is NaN"))),
        None => Ok(()),
    }
}

/// A field as a new array of the shape of the grid.
pub fn to_array<'py>(py: Python<'py>, values: Vec<f64>, shape: &[usize]) -> PyResult<Array<'py>> {
    values.into_pyarray(py).reshape(shape.to_vec())
}

/// A sequence as an array.
pub fn line<'py>(py: Python<'py>, values: Vec<f64>) -> PyResult<Array<'py>> {
    let n = values.len();
    to_array(py, values, &[n])
}

/// Pairs as the rows of an array.
pub fn rows_of<'py>(py: Python<'py>, pairs: impl IntoIterator<Item = (f64, f64)>) -> PyResult<Array<'py>> {
    let values: Vec<f64> = pairs.into_iter().flat_map(|(one, other)| [one, other]).collect();
    let n = values.len() / 2;
    to_array(py, values, &[n, 2])
}

/// Columns as arrays, by name.
pub fn columns<'py>(py: Python<'py>, named: impl IntoIterator<Item = (&'static str, Vec<f64>)>) -> PyResult<Dict<'py>> {
    let all = PyDict::new(py);
    named.into_iter().try_for_each(|(name, column)| all.set_item(name, column.into_pyarray(py)))?;
    Ok(all)
}

/// Where a function is defined: from a number on.
#[derive(Clone, Copy)]
pub struct Domain(f64);

pub const FROM_ZERO: Domain = Domain(0.0);
pub const ALL: Domain = Domain(f64::NEG_INFINITY);

/// Refuses a place at which a function is not defined. NaN is passed on.
pub fn check(name: &str, at: f64, Domain(first): Domain) -> PyResult<()> {
    if at >= first || at.is_nan() {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name} = {at} is not allowed: it must be at least {first}, or NaN, which stays NaN"
    )))
}

/// A function of one number, at a number or at each value of an array: a number or an array of the same shape. Where functions of the user have a
/// part in it, `failure` is what keeps their error: the NaN that stands for a value is none.
pub fn mapped<'py>(
    name: &str,
    at: &Object<'py>,
    domain: Domain,
    of: impl Fn(f64) -> f64 + Sync,
    failure: impl FnOnce() -> Option<UserError>,
) -> PyResult<Object<'py>> {
    let py = at.py();
    let of = |at: f64| if at.is_nan() { at } else { of(at) };
    if let Some(number) = number(at) {
        check(name, number, domain)?;
        let value = of(number);
        nothing_raised(failure())?;
        return Ok(value.into_pyobject(py)?.into_any());
    }
    let (values, shape) = values(name, at)?;
    values.iter().try_for_each(|&at| check(name, at, domain))?;
    let values = free(py, || values.into_iter().map(&of).collect());
    nothing_raised(failure())?;
    Ok(to_array(py, values, &shape)?.into_any())
}

/// Where no function of the user has a part.
pub fn never() -> Option<UserError> {
    None
}
