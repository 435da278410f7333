//! How an object was made: its repr, its pickle, its copies and what it equals are the call that made it.

use crate::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyType};
use pyo3::{Borrowed, PyTypeInfo};

/// A call of a class, or of one of its static methods.
pub struct Recipe {
    /// The class of the method, if it is not that of the object.
    class: Option<Py<PyType>>,
    maker: &'static str,
    arguments: Py<PyTuple>,
    keywords: Option<Py<PyDict>>,
    functions: Vec<Function>,
}

/// What `__reduce__` returns: the function that makes the object again, and its arguments.
pub type Reduced<'py> = (Object<'py>, (Bound<'py, PyType>, &'static str, Py<PyTuple>, Option<Py<PyDict>>));

impl Recipe {
    /// `maker` is the name of a static method; empty for the class itself.
    pub fn new<'py>(
        py: Python<'py>,
        maker: &'static str,
        arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
    ) -> PyResult<Recipe> {
        let arguments = own(arguments.into_pyobject(py)?.as_any())?.cast_into::<PyTuple>()?.unbind();
        Ok(Recipe { class: None, maker, arguments, keywords: None, functions: Vec::new() })
    }

    /// A call of a method of another class than the object's.
    pub fn of<'py, T: PyTypeInfo>(
        py: Python<'py>,
        maker: &'static str,
        arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
    ) -> PyResult<Recipe> {
        Ok(Recipe { class: Some(py.get_type::<T>().unbind()), ..Recipe::new(py, maker, arguments)? })
    }

    fn class<'py>(&self, object: Bound<'py, PyType>) -> Bound<'py, PyType> {
        let py = object.py();
        self.class.as_ref().map_or(object, |class| class.bind(py).clone())
    }

    pub fn with_keywords(self, keywords: Option<&Dict<'_>>) -> PyResult<Recipe> {
        let own = |keywords: &Dict<'_>| Ok::<_, PyErr>(own(keywords)?.cast_into::<PyDict>()?.unbind());
        Ok(Recipe { keywords: keywords.map(own).transpose()?, ..self })
    }

    /// The recipe of the object that shows to the garbage collector the functions that its part of the crate calls.
    pub fn calling(self, functions: impl Into<Vec<Function>>) -> Recipe {
        Recipe { functions: functions.into(), ..self }
    }

    /// Without the functions, which another object shows.
    pub fn again(&self, py: Python<'_>) -> Recipe {
        Recipe {
            class: self.class.as_ref().map(|class| class.clone_ref(py)),
            maker: self.maker,
            arguments: self.arguments.clone_ref(py),
            keywords: self.keywords.as_ref().map(|keywords| keywords.clone_ref(py)),
            functions: Vec::new(),
        }
    }

    pub fn traverse(&self, visit: &PyVisit<'_>) -> Traversed {
        visit.call(&self.class)?;
        visit.call(&self.arguments)?;
        visit.call(&self.keywords)?;
        self.functions.iter().try_for_each(|function| visit.call(&*function.0))
    }

    pub fn reduce<'py>(&self, class: Bound<'py, PyType>) -> PyResult<Reduced<'py>> {
        let py = class.py();
        let class = self.class(class);
        let again = py.import("viscocontact._native")?.getattr("_again")?;
        let keywords = self.keywords.as_ref().map(|keywords| keywords.clone_ref(py));
        Ok((again, (class, self.maker, self.arguments.clone_ref(py), keywords)))
    }

    /// What equal objects have equal, and can be hashed.
    pub fn key<'py>(&self, class: Bound<'py, PyType>) -> PyResult<Object<'py>> {
        let py = class.py();
        py.import("viscocontact._values")?.call_method1("key", (class, self.maker, &self.arguments, &self.keywords))
    }

    /// The call in one line; of arrays their shape alone.
    pub fn repr(&self, class: &Bound<'_, PyType>) -> PyResult<String> {
        let (py, class) = (class.py(), self.class(class.clone()));
        let arguments = (class, self.maker, &self.arguments, &self.keywords);
        py.import("viscocontact._values")?.call_method1("shown", arguments)?.extract()
    }
}

/// An argument that a recipe keeps as it was: of an iterator its values, of an array a copy.
#[derive(IntoPyObject)]
#[pyo3(transparent)]
pub struct Value<'py>(pub Object<'py>);

impl<'py> FromPyObject<'_, 'py> for Value<'py> {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Value<'py>> {
        own(&given).map(Value)
    }
}

impl<'py> std::ops::Deref for Value<'py> {
    type Target = Object<'py>;

    fn deref(&self) -> &Object<'py> {
        &self.0
    }
}

/// A value of a call as it is now: what the caller may change later is copied, down to the entries of sequences.
fn own<'py>(value: &Object<'py>) -> PyResult<Object<'py>> {
    // most are numbers, and objects that do not change
    if value.is_exact_instance_of::<PyFloat>() || value.is_exact_instance_of::<PyInt>() {
        return Ok(value.clone());
    }
    value.py().import("viscocontact._values")?.call_method1("own", (value,))
}

/// A number as Python writes it, to six digits.
pub fn digits(value: f64) -> String {
    Python::attach(|py| value.into_pyobject(py)?.call_method1("__format__", (".6g",))?.extract())
        .unwrap_or_else(|_: PyErr| value.to_string())
}

/// Makes an object again: for pickle.
#[pyfunction]
#[pyo3(name = "_again")]
pub fn again<'py>(
    class: Bound<'py, PyType>,
    maker: &str,
    arguments: Bound<'py, PyTuple>,
    keywords: Option<Dict<'py>>,
) -> PyResult<Object<'py>> {
    let maker = if maker.is_empty() { class.into_any() } else { class.getattr(maker)? };
    maker.call(arguments, keywords.as_ref())
}
