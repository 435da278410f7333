//! Objects of Python that Rust holds: contacts that another thread may use meanwhile, and functions.

use std::ops::{Deref, DerefMut};

use crate::prelude::*;
use pyo3::call::PyCallArgs;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::gc::PyTraverseError;
use pyo3::pyclass::boolean_struct::False;
use pyo3::{Borrowed, PyClass};

/// What `__traverse__` returns.
pub type Traversed = Result<(), PyTraverseError>;

/// An object to look at, and one to change.
pub type Shared<'py, T> = Used<PyRef<'py, T>>;
pub type Taken<'py, T> = Used<PyRefMut<'py, T>>;

/// An object that no other call uses meanwhile.
pub struct Used<G>(G);

pub fn in_use<T: PyClass>() -> PyErr {
    let name = T::NAME;
    PyRuntimeError::new_err(format!(
        "this {name} is computing, in another thread or in the call that called this function: look at it when the call has returned, at a \
         copy, or at the argument of the function"
    ))
}

impl<'py, T: PyClass> TryFrom<&Bound<'py, T>> for Shared<'py, T> {
    type Error = PyErr;

    fn try_from(object: &Bound<'py, T>) -> PyResult<Self> {
        object.try_borrow().map(Used).map_err(|_| in_use::<T>())
    }
}

impl<'py, T: PyClass<Frozen = False>> TryFrom<&Bound<'py, T>> for Taken<'py, T> {
    type Error = PyErr;

    fn try_from(object: &Bound<'py, T>) -> PyResult<Self> {
        object.try_borrow_mut().map(Used).map_err(|_| in_use::<T>())
    }
}

impl<'py, T: PyClass> FromPyObject<'_, 'py> for Shared<'py, T> {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Shared::try_from(&*object.cast::<T>()?)
    }
}

impl<G: Deref> Deref for Used<G> {
    type Target = G::Target;

    fn deref(&self) -> &G::Target {
        &self.0
    }
}

impl<G: DerefMut> DerefMut for Used<G> {
    fn deref_mut(&mut self) -> &mut G::Target {
        &mut self.0
    }
}

/// A function of Python. What the crate makes of it and the object that stands for that in Python share one reference, which the object
/// shows to the garbage collector (`Recipe::calling`): whatever else holds what the crate made holds the object, too.
#[derive(Clone)]
pub struct Function(pub Arc<Py<PyAny>>);

impl Function {
    pub fn call<T: for<'py> FromPyObjectOwned<'py, Error: Into<PyErr>>>(
        &self,
        arguments: impl for<'py> PyCallArgs<'py>,
    ) -> PyResult<T> {
        Python::attach(|py| self.0.bind(py).call1(arguments)?.extract().map_err(Into::into))
    }
}

/// A report of progress: whether the call goes on, which it does unless the function returns False.
pub fn goes_on(progress: Option<&Function>, done: impl for<'py> PyCallArgs<'py>) -> PyResult<bool> {
    let Some(Function(progress)) = progress else { return Ok(true) };
    Python::attach(|py| Ok(progress.call1(py, done)?.extract(py).unwrap_or(true)))
}

impl FromPyObject<'_, '_> for Function {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Function> {
        if object.is_callable() {
            return Ok(Function(Arc::new(object.to_owned().unbind())));
        }
        Err(PyTypeError::new_err(format!("a function is needed, not {}", object.repr()?)))
    }
}

impl<'py> IntoPyObject<'py> for Function {
    type Target = PyAny;
    type Output = Object<'py>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Object<'py>> {
        Ok(self.0.bind(py).clone())
    }
}
