//! What contacts have in common: runs, copies, checkpoints, and pickles through them.

use pyo3::types::{PyList, PyType};

use crate::held::{Options, saved_every, stepping, times};
use crate::loads::histories;
use crate::prelude::*;
use crate::run::Run;

/// How an object is made again, and the bytes of its state.
type Pickled<'py> =
    (Bound<'py, PyAny>, (Bound<'py, PyType>, &'static str, Py<PyTuple>, Option<Py<PyDict>>), Bound<'py, PyBytes>);

macro_rules! both {
    ($contact:ident) => {
        #[pymethods]
        impl $contact {
            /// Follows a load to the time `until` [s]: an iterator over the reports of the steps.
            ///
            /// Parameters
            /// ----------
            /// load : LoadHistory, Load (held), sequence of (time, load), or function of time that returns a Load
            ///     In space of several bodies, a sequence with one of these for each.
            /// until : float
            /// tolerance : float, default 1e-3
            ///     Steps are as long as their estimated error in time allows, and each contact problem is solved as accurately as this needs: less accurately
            ///     than by the contact's own `tolerance`, which a run with `dt` takes.
            /// dt : float, optional
            ///     Equal steps of this length instead [s].
            /// stop_at : times, optional
            ///     Where steps end too: a sequence of times [s], or `Times`.
            /// sample_at : times, optional
            ///     Times between the start and `until` at which `Run.samples` and `Run.table` give the state. Samples leave the steps as they are.
            /// fields_to : float, optional
            ///     Error in time of the pressure at the times of `sample_at`, relative, in [1e-5, 0.1]; `Sample.field` has the error estimated.
            ///     Without it approach and force alone are as exact as `tolerance` says.
            /// progress : function, optional
            ///     Called after each step with the share of the time that is over (`Run.progress` has that of the decades, too); the run ends with
            ///     `Cancelled` where it returns False.
            /// autosave : (path, seconds), optional
            ///     Saves the run to a checkpoint every so many seconds of the clock, and at its end.
            ///
            /// >>> contact = ViscoelasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
            /// >>> history = [(0, Load.force(0)), (0.5, Load.force(0.5)), (1, Load.force(0.1))]
            /// >>> for report in contact.follow(history, until=1.0, tolerance=1e-2):
            /// ...     area = contact.contact_area
            /// >>> report.time
            /// 1.0
            #[pyo3(signature = (load, until, *, tolerance=None, dt=None, stop_at=None, sample_at=None, fields_to=None, progress=None, autosave=None))]
            #[allow(clippy::too_many_arguments)]
            fn follow(
                slf: Bound<'_, Self>,
                load: &Bound<'_, PyAny>,
                until: f64,
                tolerance: Option<f64>,
                dt: Option<f64>,
                stop_at: Option<Bound<'_, PyAny>>,
                sample_at: Option<Bound<'_, PyAny>>,
                fields_to: Option<f64>,
                progress: Option<Function>,
                autosave: Option<(PathBuf, f64)>,
            ) -> PyResult<Run> {
                let (stop_at, sample_at) = (times("stop_at", stop_at)?, times("sample_at", sample_at)?);
                let (stepping, autosave) = (stepping(dt, tolerance)?, saved_every(autosave)?);
                if fields_to.is_some() && sample_at.is_none() {
                    return Err(PyTypeError::new_err("fields_to is of the samples at the times sample_at: give both"));
                }
                let (sampled, loads) = (sample_at.is_some(), histories(load)?);
                let histories = loads.iter().map(|load| Arc::clone(&load.get().history)).collect();
                let options = Options { histories, stepping, until, stop_at, sample_at, fields_to, autosave };
                let mut contact = Taken::try_from(&slf)?;
                let cancel = Arc::clone(&contact.cancel);
                let run = contact.held.follow(options, PyList::new(slf.py(), loads)?.into_any().unbind(), cancel)?;
                Ok(Run::of(slf.as_any().extract()?, run, sampled, progress))
            }

            fn __copy__(slf: Shared<'_, Self>, py: Python<'_>) -> PyResult<$contact> {
                let contact = slf.get()?;
                Ok($contact::of(free(py, || contact.clone()), slf.recipe.again(py)))
            }

            fn __deepcopy__(slf: Shared<'_, Self>, py: Python<'_>, _memo: Bound<'_, PyAny>) -> PyResult<$contact> {
                Self::__copy__(slf, py)
            }

            fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
                self.recipe.traverse(&visit)?;
                self.held.traverse(&visit)
            }

            /// Ends the run, whose functions may refer to the contact.
            fn __clear__(&mut self) {
                let _ = self.held.free();
            }
        }
    };
}

both!(ViscoelasticContact);
both!(StatesContact);

/// Checkpoints, and pickles through them, of a contact that is written in a step as `own`.
macro_rules! saved {
    ($contact:ident, $slf:ident => $own:expr) => {
        #[pymethods]
        impl $contact {
            /// Saves the whole state to a file, from which a contact that is built like this one continues by `resume`.
            fn save(slf: Shared<'_, Self>, py: Python<'_>, path: PathBuf) -> PyResult<()> {
                let contact = slf.get()?;
                free(py, || contact.save(path)).or_raise()
            }

            /// Puts a saved state in the place of this one; the following steps are the same, bit by bit.
            ///
            /// Raises OSError if the file cannot be read, is damaged, or is of another scene.
            fn resume(mut $slf: Taken<'_, Self>, py: Python<'_>, path: PathBuf) -> PyResult<()> {
                let contact = $own;
                free(py, || contact.resume(path)).or_raise()
            }

            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
                let of = Shared::try_from(slf)?;
                let (again, arguments) = of.recipe.reduce(slf.get_type())?;
                let contact = of.get()?;
                let bytes = free(slf.py(), || contact.to_bytes()).or_raise()?;
                Ok((again, arguments, PyBytes::new(slf.py(), &bytes)))
            }

            fn __setstate__(mut $slf: Taken<'_, Self>, py: Python<'_>, state: &Bound<'_, PyBytes>) -> PyResult<()> {
                let (bytes, contact) = (state.as_bytes(), $own);
                free(py, || contact.resume_bytes(bytes)).or_raise()
            }
        }
    };
}

saved!(ViscoelasticContact, slf => slf.held.free()?);
saved!(StatesContact, slf => slf.held.free()?);
saved!(FrictionContact, slf => &mut slf.contact);
