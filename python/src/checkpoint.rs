//! Checkpoints: files, and pickles of contacts through them.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple, PyType};

use crate::contact::ViscoelasticContact;
use crate::errors::OrRaise;
use crate::scratch::{bytes_of, file_of};
use crate::states_contact::StatesContact;

/// How an object is made again, and the bytes of its state.
type Pickled<'py> =
    (Bound<'py, PyAny>, (Bound<'py, PyType>, &'static str, Py<PyTuple>, Option<Py<PyDict>>), Bound<'py, PyBytes>);

/// The methods of a contact that can be saved.
macro_rules! checkpoints {
    ($contact:ident) => {
        #[pymethods]
        impl $contact {
            /// Saves the whole state to a file, from which a contact that is built like this one continues by `resume`.
            fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
                let contact = self.get()?;
                py.detach(|| contact.save(path)).or_raise()
            }

            /// Puts a saved state in the place of this one; the following steps are the same, bit by bit.
            ///
            /// Raises OSError if the file cannot be read, is damaged, or is of another scene.
            fn resume(&mut self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
                let contact = self.held.free()?;
                py.detach(|| contact.resume(path)).or_raise()
            }

            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
                let of = slf.borrow();
                let (again, arguments) = of.recipe.reduce(slf.get_type())?;
                let contact = of.get()?;
                Ok((again, arguments, bytes_of(slf.py(), |file| contact.save(file))?))
            }

            fn __setstate__(&mut self, py: Python<'_>, state: &Bound<'_, PyBytes>) -> PyResult<()> {
                let (file, contact) = (file_of(state)?, self.held.free()?);
                py.detach(|| contact.resume(&file.0)).or_raise()
            }
        }
    };
}

checkpoints!(ViscoelasticContact);
checkpoints!(StatesContact);
