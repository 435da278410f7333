//! What nearly every file of the package uses.

pub use std::path::PathBuf;
pub use std::sync::Arc;

pub use numpy::IntoPyArray;
pub use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
pub use pyo3::gc::PyVisit;
pub use pyo3::prelude::*;
pub use pyo3::types::{PyBytes, PyDict, PyTuple};

pub use crate::arrays::{ALL, Array, FROM_ZERO, column, mapped, never, to_array};
pub use crate::errors::{Kept, OrRaise, choice, in_python, no_violation, nothing_raised, raised_number};
pub use crate::grid::{Count, Grid, PerAxis, count};
pub use crate::interrupt::{Listener, free, interruptible};
pub use crate::materials::Material;
pub use crate::recipe::{Recipe, Reduced, Value, digits};
pub use crate::used::{Function, Shared, Taken, Traversed, goes_on, in_use};
