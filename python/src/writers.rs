//! Files of results: histories, frames, archives.

use viscocontact::output::{self as vo, Earlier, Field, Format, Metadata};

use crate::fields::Showing;
use crate::prelude::*;

pub fn metadata(title: &str, notes: Option<&Dict<'_>>) -> PyResult<Metadata> {
    notes.into_iter().flatten().try_fold(Metadata::new(title), |metadata, (key, value)| {
        Ok(metadata.note(key.str()?.to_string(), value.str()?.to_string()))
    })
}

const EARLIER: [(&str, Earlier); 3] =
    [("refuse", Earlier::Refuse), ("replace", Earlier::Replace), ("continue", Earlier::Continue)];

/// The result of an expression with a contact of either kind.
macro_rules! with_either {
    ($given:ident, $contact:ident => $value:expr) => {
        if let Ok(contact) = $given.cast::<ViscoelasticContact>() {
            let held = Shared::try_from(contact)?;
            let $contact = held.get()?;
            $value.or_raise()
        } else if let Ok(contact) = $given.cast::<StatesContact>() {
            let held = Shared::try_from(contact)?;
            let $contact = held.get()?;
            $value.or_raise()
        } else {
            Err(PyTypeError::new_err("contact: a ViscoelasticContact or a StatesContact is needed"))
        }
    };
}

/// A run as a CSV file with a row for each step, below the names of the columns with their units. The scene is beside it as JSON, in a file with `.json`
/// after the name.
///
/// Parameters
/// ----------
/// path : path
/// contact : ViscoelasticContact or StatesContact
/// title, notes : str, dict
///     Written into the file.
/// columns : sequence of str
///     Additional columns, with their units in brackets.
/// earlier : "refuse" (default: FileExistsError), "replace", or "continue"
///     "continue" goes on after the state of the contact, as after `resume`: what the file has of later times is removed.
///
/// `to_dataframe()` reads it back, and `pandas.read_csv(path)` elsewhere.
///
/// >>> import pathlib, tempfile
/// >>> path = pathlib.Path(tempfile.mkdtemp(), "history.csv")
/// >>> contact = ViscoelasticContact(Grid(16, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> history = CsvHistory(path, contact)
/// >>> for report in contact.follow(Load.force(0.5), 0.2, dt=0.1):
/// ...     history.record(contact, report)
/// >>> len(path.read_text().splitlines())      # the names, and a row for each step
/// 4
#[pyclass(module = "viscocontact")]
pub struct CsvHistory {
    history: vo::CsvHistory,
    path: PathBuf,
}

#[pymethods]
impl CsvHistory {
    #[new]
    #[pyo3(signature = (path, contact, *, title="", notes=None, columns=vec![], earlier="refuse"))]
    fn new(
        path: PathBuf,
        contact: &Object<'_>,
        title: &str,
        notes: Option<&Dict<'_>>,
        columns: Vec<String>,
        earlier: &str,
    ) -> PyResult<CsvHistory> {
        let (metadata, earlier) = (metadata(title, notes)?, choice("earlier", earlier, &EARLIER)?);
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let history =
            with_either!(contact, contact => vo::CsvHistory::create(&path, &metadata, contact, &columns, earlier))?;
        Ok(CsvHistory { history, path })
    }

    /// The path of the file.
    #[getter]
    fn path(slf: Shared<'_, Self>) -> PathBuf {
        slf.path.clone()
    }

    /// Appends the row of the last step, with the values of the additional columns.
    #[pyo3(signature = (contact, report, columns=vec![]))]
    fn record(mut slf: Taken<'_, Self>, contact: &Object<'_>, report: &StepReport, columns: Vec<f64>) -> PyResult<()> {
        with_either!(contact, contact => slf.history.record(contact, &report.0, &columns))
    }
}

pub const FORMATS: [(&str, Format); 2] = [("npz", Format::Npz), ("vtk", Format::Vtk)];

pub const FIELDS: [(&str, Field); 4] = [
    ("pressure", Field::Pressure),
    ("displacement", Field::Displacement),
    ("gap", Field::Gap),
    ("traction", Field::Traction),
];

/// A run as a folder of files, one for each frame.
///
/// Parameters
/// ----------
/// folder : path
/// contact : ViscoelasticContact
/// format : "npz" (default; numpy.load) or "vtk" (ParaView, PyVista)
/// fields : sequence of "pressure", "displacement", "gap", "traction"; by default those of the contact
/// title, notes, earlier : as of `CsvHistory`
///
/// >>> import pathlib, tempfile
/// >>> contact = ViscoelasticContact(Grid(16, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> frames = FrameSeries(pathlib.Path(tempfile.mkdtemp(), "frames"), contact)
/// >>> frames.record(contact).suffix
/// '.npz'
#[pyclass(module = "viscocontact")]
pub struct FrameSeries(vo::FrameSeries);

#[pymethods]
impl FrameSeries {
    #[new]
    #[pyo3(signature = (folder, contact, *, format="npz", fields=None, title="", notes=None, earlier="refuse"))]
    fn new(
        folder: PathBuf,
        contact: Showing<'_>,
        format: &str,
        fields: Option<Vec<String>>,
        title: &str,
        notes: Option<&Dict<'_>>,
        earlier: &str,
    ) -> PyResult<FrameSeries> {
        let format = choice("format", format, &FORMATS)?;
        let (metadata, contact) = (metadata(title, notes)?, contact.shown()?);
        let fields = match fields {
            Some(names) => names.iter().map(|name| choice("field", name, &FIELDS)).collect::<PyResult<Vec<_>>>()?,
            None => Field::of(contact).to_vec(),
        };
        let earlier = choice("earlier", earlier, &EARLIER)?;
        vo::FrameSeries::create(folder, format, &metadata, contact, &fields, earlier).or_raise().map(FrameSeries)
    }

    /// Writes the state of the contact as the next frame, and returns its path.
    fn record(mut slf: Taken<'_, Self>, py: Python<'_>, contact: Showing<'_>) -> PyResult<PathBuf> {
        let contact = contact.shown()?;
        let series = &mut slf.0;
        free(py, || series.record(contact)).or_raise()
    }
}

getters! {FrameSeries, of:
    /// Number of frames written.
    frames: usize = of.frames();
}

#[pymethods]
impl ViscoelasticContact {
    /// The scene as JSON on one line: grid, settings, materials, units and conventions.
    #[pyo3(signature = (title="", notes=None))]
    fn describe(slf: Shared<'_, Self>, title: &str, notes: Option<&Dict<'_>>) -> PyResult<String> {
        Ok(metadata(title, notes)?.json(slf.get()?))
    }
}
