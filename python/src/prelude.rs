//! What nearly every file of the package uses.

pub use std::path::PathBuf;
pub use std::sync::Arc;
pub use std::sync::atomic::{AtomicBool, Ordering};

pub use numpy::IntoPyArray;
pub use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
pub use pyo3::gc::PyVisit;
pub use pyo3::prelude::*;
pub use pyo3::types::{PyBytes, PyDict, PyTuple};

/// Any object of Python, and a dict.
pub type Object<'py> = Bound<'py, PyAny>;
pub type Dict<'py> = Bound<'py, PyDict>;

pub use crate::arrays::{
    ALL, Array, FROM_ZERO, column, if_given, line, mapped, never, one_for_each, rows_of, to_array, together,
};
pub use crate::contact::ViscoelasticContact;
pub use crate::elastic::ElasticContact;
pub use crate::errors::{Kept, OrRaise, choice, in_python, no_violation, nothing_raised, raised_number, sure};
pub use crate::fields::{Fields, Shown};
pub use crate::friction::FrictionContact;
pub use crate::grid::{Count, Grid, PerAxis, count};
pub use crate::interrupt::{Listener, free, interruptible};
pub use crate::kernels::{InfluenceKernel, axis};
pub use crate::loads::{Load, LoadHistory, history, loads};
pub use crate::materials::Material;
pub use crate::recipe::{Recipe, Reduced, Value, digits};
pub use crate::reports::StepReport;
pub use crate::rheology::Rheology;
pub use crate::scene::{builder, settings, unexpected};
pub use crate::shapes::{Shape, geometries};
pub use crate::states::ElasticStates;
pub use crate::states_contact::StatesContact;
pub use crate::temperature::{TemperatureHistory, TimeTemperature};
pub use crate::used::{Function, Shared, Taken, Traversed, goes_on, in_use};
