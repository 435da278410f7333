//! How an object was made: its repr, its pickle and its copies are the call that made it.

use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyString, PyTuple, PyType};

/// A call of a class, or of one of its static methods.
pub struct Recipe {
    /// The class of the method, if it is not that of the object.
    class: Option<Py<PyType>>,
    maker: &'static str,
    arguments: Py<PyTuple>,
    keywords: Option<Py<PyDict>>,
}

/// What `__reduce__` returns: the function that makes the object again, and its arguments.
pub type Reduced<'py> = (Bound<'py, PyAny>, (Bound<'py, PyType>, &'static str, Py<PyTuple>, Option<Py<PyDict>>));

impl Recipe {
    /// `maker` is the name of a static method; empty for the class itself.
    pub fn new<'py>(
        py: Python<'py>,
        maker: &'static str,
        arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
    ) -> PyResult<Recipe> {
        let arguments = own(arguments.into_pyobject(py)?.as_any())?.cast_into::<PyTuple>()?.unbind();
        Ok(Recipe { class: None, maker, arguments, keywords: None })
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

    pub fn with_keywords(self, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Recipe> {
        let own = |keywords: &Bound<'_, PyDict>| Ok::<_, PyErr>(own(keywords)?.cast_into::<PyDict>()?.unbind());
        Ok(Recipe { keywords: keywords.map(own).transpose()?, ..self })
    }

    pub fn again(&self, py: Python<'_>) -> Recipe {
        Recipe {
            class: self.class.as_ref().map(|class| class.clone_ref(py)),
            maker: self.maker,
            arguments: self.arguments.clone_ref(py),
            keywords: self.keywords.as_ref().map(|keywords| keywords.clone_ref(py)),
        }
    }

    pub fn reduce<'py>(&self, class: Bound<'py, PyType>) -> PyResult<Reduced<'py>> {
        let py = class.py();
        let class = self.class(class);
        let again = py.import("viscocontact._native")?.getattr("_again")?;
        let keywords = self.keywords.as_ref().map(|keywords| keywords.clone_ref(py));
        Ok((again, (class, self.maker, self.arguments.clone_ref(py), keywords)))
    }

    /// The call in one line; of arrays their shape alone.
    pub fn repr(&self, class: &Bound<'_, PyType>) -> PyResult<String> {
        let (py, class) = (class.py(), self.class(class.clone()));
        let mut shown: Vec<String> =
            self.arguments.bind(py).iter().map(|value| shown(&value)).collect::<PyResult<_>>()?;
        if let Some(keywords) = &self.keywords {
            for (name, value) in keywords.bind(py) {
                shown.push(format!("{name}={}", self::shown(&value)?));
            }
        }
        if self.maker == "__add__" {
            return Ok(shown.join(" + "));
        }
        let dot = if self.maker.is_empty() { "" } else { "." };
        Ok(format!("{}{dot}{}({})", class.name()?, self.maker, shown.join(", ")))
    }
}

/// A value of a call as it is now: what the caller may change later is copied, down to the entries of sequences.
fn own<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = value.py();
    if let Ok(tuple) = value.cast_exact::<PyTuple>() {
        let entries: Vec<_> = tuple.iter().map(|entry| own(&entry)).collect::<PyResult<_>>()?;
        return Ok(PyTuple::new(py, entries)?.into_any());
    }
    if let Ok(list) = value.cast_exact::<PyList>() {
        let entries: Vec<_> = list.iter().map(|entry| own(&entry)).collect::<PyResult<_>>()?;
        return Ok(PyList::new(py, entries)?.into_any());
    }
    if let Ok(dict) = value.cast_exact::<PyDict>() {
        let copy = PyDict::new(py);
        dict.iter().try_for_each(|(key, entry)| copy.set_item(key, own(&entry)?))?;
        return Ok(copy.into_any());
    }
    // arrays, and other sequences; objects of this package do not change
    let is_fixed = value.is_instance_of::<PyString>() || value.is_instance_of::<PyBytes>() || value.is_callable();
    let is_own = || value.get_type().module().is_ok_and(|module| module.to_string().starts_with("viscocontact"));
    if is_fixed || !value.hasattr("__len__")? || is_own() {
        return Ok(value.clone());
    }
    // what is read from elsewhere, as by h5py, cannot be copied, but its numbers can
    let copied = py.import("copy")?.call_method1("copy", (value,));
    copied.or_else(|_| py.import("numpy")?.call_method1("array", (value,)))
}

fn shown(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.hasattr("dtype")?
        && let Ok(shape) = value.getattr("shape")?.extract::<Vec<usize>>()
    {
        return Ok(format!("<array {shape:?}>"));
    }
    let text = value.repr()?.to_string();
    Ok(if text.chars().count() > 60 { format!("{}…", text.chars().take(59).collect::<String>()) } else { text })
}

/// Makes an object again: for pickle.
#[pyfunction]
#[pyo3(name = "_again")]
pub fn again<'py>(
    class: Bound<'py, PyType>,
    maker: &str,
    arguments: Bound<'py, PyTuple>,
    keywords: Option<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let maker = if maker.is_empty() { class.into_any() } else { class.getattr(maker)? };
    maker.call(arguments, keywords.as_ref())
}
