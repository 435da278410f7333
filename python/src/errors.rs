//! Errors of the crate as the exceptions that a Python programmer expects, in the crate's words.

use std::cell::RefCell;
use std::error::Error as StdError;
use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use crate::prelude::*;
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyMemoryError, PyNotImplementedError, PyOSError};
use viscocontact::{Error, ErrorKind, UserError};
use viscocontact_identify::Error as IdentifyError;

use crate::friction::slides;

create_exception!(
    viscocontact,
    Cancelled,
    PyException,
    "The call was ended by its caller: a report of progress returned False.\n\n>>> contact = ViscoelasticContact(Grid(16, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))\n>>> list(contact.follow(Load.force(0.5), 1.0, progress=lambda share: False))\nTraceback (most recent call last):\nviscocontact.Cancelled: ..."
);
create_exception!(
    viscocontact,
    ConvergenceError,
    PyRuntimeError,
    "A search did not converge, or needs shorter steps than there are. The message says which, with its numbers.\n\n>>> import numpy as np\n>>> hills = HeightMap.rough(Grid(32, 1e-3), 0.5e-3, 0.1e-3, rms_slope=0.3)\n>>> contact = ElasticContact(Grid(32, 1e-3), hills, 1e6, max_iterations=1, edge=\"allow\")\n>>> contact.solve(Load.force(0.05))\nTraceback (most recent call last):\nviscocontact.ConvergenceError: ..."
);

/// Raises the errors of both crates, at the end of a call: first what a function of the user raised in it, whether the crate noticed or not.
pub trait OrRaise<T> {
    fn or_raise(self) -> PyResult<T>;
}

/// What cannot fail, in a list of what can.
pub fn sure<T>(value: T) -> viscocontact::Result<T> {
    Ok(value)
}

impl<T> OrRaise<T> for Result<T, Error> {
    fn or_raise(self) -> PyResult<T> {
        let result = self.map_err(|error| raise(&error));
        no_exception().and(result)
    }
}

impl<T> OrRaise<T> for Result<T, IdentifyError> {
    fn or_raise(self) -> PyResult<T> {
        let result = self.map_err(|error| match &error {
            IdentifyError::Contact(error) => raise(error),
            IdentifyError::NotConverged { .. } => ConvergenceError::new_err(in_python(error)),
            IdentifyError::Unwritable { .. } => PyOSError::new_err(with_causes(&error)),
            _ => PyValueError::new_err(with_causes(&error)),
        });
        no_exception().and(result)
    }
}

/// The exception of an error: that of the user's own function, if it raised one; else by kind.
pub fn raise(error: &Error) -> PyErr {
    if let Some(raised) = raised_by_user(error) {
        return raised;
    }
    let text = with_causes(error);
    if let Error::Slides { over_limit, direction, .. } = error {
        return slides(text, *over_limit, *direction);
    }
    match error.kind() {
        // a name that is not allowed, as any other value
        ErrorKind::File if error.code() == "extension" => PyValueError::new_err(text),
        ErrorKind::File => os_error(error, text),
        ErrorKind::Memory => PyMemoryError::new_err(text),
        ErrorKind::Cancelled => Cancelled::new_err(text),
        ErrorKind::Convergence => ConvergenceError::new_err(text),
        ErrorKind::Unsupported => PyNotImplementedError::new_err(text),
        _ => PyValueError::new_err(text),
    }
}

/// The error of a file that cannot be opened, as the crate says it.
pub fn unreadable(path: &Path) -> impl FnOnce(io::Error) -> PyErr {
    move |error| {
        let (file, reason, kind) = (path.display().to_string(), error.to_string(), Some(error.kind()));
        raise(&Error::Unreadable { file, reason, kind })
    }
}

/// Writes a file that is complete, or leaves the one that is there as it is.
pub fn replace(path: &Path, bytes: &[u8]) -> PyResult<()> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let written = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path));
    written.inspect_err(|_| drop(std::fs::remove_file(&part)))?;
    Ok(())
}

/// The OSError of the kind that its number has, with the name of the file, as of `open`.
fn os_error(error: &Error, text: String) -> PyErr {
    let file = match error {
        Error::Unreadable { file, .. } => file.clone(),
        Error::Checkpoint { path, .. } => path.display().to_string(),
        Error::Output(error) => error.path().display().to_string(),
        _ => return PyOSError::new_err(text),
    };
    // those of all systems; text has the file too, and says what to do
    let number = match error.io_kind() {
        Some(io::ErrorKind::NotFound) => 2,
        Some(io::ErrorKind::PermissionDenied) => 13,
        Some(io::ErrorKind::AlreadyExists) => 17,
        _ => return PyOSError::new_err(text),
    };
    PyOSError::new_err((number, text, file))
}

/// The message, and those of its causes that it does not repeat.
fn with_causes(error: &dyn StdError) -> String {
    let (mut text, mut cause) = (error.to_string(), error.source());
    while let Some(error) = cause {
        let more = error.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        cause = error.source();
    }
    in_python(text)
}

/// What messages of the crates name, and what it is called here.
const NAMES: [(&str, &str); 38] = [
    ("share of the glassy modulus", "share of the glassy modulus (moduli are for Rheology.generalized_maxwell)"),
    (
        "name the times to fit one over, with Builder::times (first and last) or Builder::times_of (a load history and its end), or fit one with Rheology::series or Material::fitted",
        "fit one with Material.fitted(first, last), or for a contact in space give times=(first, last) or times=(load, until)",
    ),
    ("Builder::times", "times="),
    ("Builder::counter_motion", "counter_motion=\"slides\" or \"rolls\""),
    ("CreepSeries::extrapolated", "extrapolated=True of Measurements.fit"),
    (
        "choose the other Frame with Settings::with_frame",
        "give frame=\"indenter\" or frame=\"bodies\", whichever it is not",
    ),
    ("Frame::Indenter", "frame=\"indenter\""),
    ("Frame::Bodies", "frame=\"bodies\""),
    ("set Settings::edge to Edge::Allow", "give edge=\"allow\""),
    ("sweep further (states::Reach)", "sweep to a greater load, approach or level, or with the softest material"),
    ("call Sweep::keep_pressures before the sweep", "give keep_pressures=True to the sweep"),
    ("of a Sweep of this process", "of ElasticStates.sweep in this process, neither loaded nor pickled"),
    ("Study::domain", "domain=(length, length)"),
    ("Earlier::Replace", "earlier=\"replace\""),
    ("a greater Settings::tolerance", "a greater tolerance="),
    ("call with_friction first", "give friction= or estimated_friction="),
    ("with_estimated_friction takes", "estimated_friction= takes"),
    (
        "a contact needs material: call Builder::material before build",
        "the stress needs Poisson's ratio, which this contact does not have: give it to SubsurfaceStress(kernel, pressure, nu)",
    ),
    ("a contact needs counter_body: call Builder::counter_body before build", "the contact has no counter_body="),
    ("from ViscoelasticContact::traction_into", "of the traction"),
    (
        "use Measurements::fit_tension and Material::from_tension",
        "use Measurements.fit_tension, and give the Material its nu",
    ),
    ("TextTable::only", "only="),
    ("TextTable::with_heading", "headings="),
    ("choose by TextTable::section", "read each section from a file of its own"),
    ("or with_missing_height(f64::NAN)", "or missing_height=math.nan"),
    ("TextFormat::with_missing_height(", "missing_height=("),
    ("TextFormat::with_", ""),
    ("give it, as to HeightMap::from_gsf", "give unit="),
    ("HeightMap::from_profile", "profile=True"),
    ("HeightMap::from_xyz", "points=True"),
    ("HeightMap::new", "HeightMap(heights, lengths)"),
    ("Recording::spring_curve", "Recording.curve with a stiffness"),
    ("Recording::depth_curve", "Recording.curve without a stiffness"),
    ("use Curve::averaged", "average neighbouring samples first"),
    ("take Noise::AutoregressiveWith", "give its coefficient as noise="),
    ("Stepping::fixed", "dt="),
    ("Settings::", ""),
    ("::", "."),
];

/// A message with names as Python writes them.
pub fn in_python(text: impl ToString) -> String {
    NAMES.into_iter().fold(text.to_string(), |text, (name, here)| text.replace(name, here))
}

/// The exception that a function of the user raised, among the causes of an error.
fn raised_by_user(error: &Error) -> Option<PyErr> {
    let mut cause: Option<&(dyn StdError + 'static)> = error.source();
    while let Some(error) = cause {
        if let Some(raised) = error.downcast_ref::<PyErr>() {
            return Some(Python::attach(|py| raised.clone_ref(py)));
        }
        cause = error.source();
    }
    None
}

/// The value of a Python function for which the crate has no way to return an error, and which the crate calls on the thread of the call: NaN where the
/// function raised, whose exception the call raises at its end.
pub fn raised_number<T>(result: PyResult<T>, nan: T) -> T {
    result.unwrap_or_else(|error| {
        RAISED.set(Some(error));
        nan
    })
}

/// Raises what a function of the user raised in this call.
pub fn no_exception() -> PyResult<()> {
    RAISED.take().map_or(Ok(()), Err)
}

thread_local! {
    /// What a function of the user raised in the call under way on this thread.
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
}

/// Raises what a function of the user raised in this call, or the error that the object of this function keeps.
pub fn nothing_raised(failure: Option<UserError>) -> PyResult<()> {
    no_exception()?;
    failure.map_or(Ok(()), |failure| Err(raise(&failure.into())))
}

/// The exception of a Python function that the crate may call on any of its threads.
#[derive(Clone, Default)]
pub struct Kept(Arc<Mutex<Option<PyErr>>>);

impl Kept {
    /// NaN in place of a value that the function could not give, whose exception is kept.
    pub fn number<T>(&self, result: PyResult<T>, nan: T) -> T {
        result.unwrap_or_else(|error| {
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            nan
        })
    }

    /// Raises it in place of the result of the call.
    pub fn raise_or<T>(&self, result: PyResult<T>) -> PyResult<T> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(result, Err)
    }
}

/// Raises the violation of a law of a trait, or what a function of the user raised meanwhile.
pub fn no_violation(
    failure: Option<UserError>,
    verdict: Result<(), viscocontact::rheology::laws::Violation>,
) -> PyResult<()> {
    nothing_raised(failure)?;
    verdict.map_err(|violation| PyValueError::new_err(violation.to_string()))
}

/// The option of this name, or an error that lists the names.
pub fn choice<T: Copy>(field: &str, name: &str, options: &[(&str, T)]) -> PyResult<T> {
    options.iter().find(|(option, _)| *option == name).map(|&(_, value)| value).ok_or_else(|| {
        let names: Vec<String> = options.iter().map(|(option, _)| format!("{option:?}")).collect();
        PyValueError::new_err(format!("{field} = {name:?} is not allowed: it must be one of {}", names.join(", ")))
    })
}
