//! The history of a run as a CSV table.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use crate::ViscoelasticContact;
use crate::contact::StepReport;
use crate::error::{Result, exact_length};
use crate::file::{Appending, check_regular, failed};
use crate::output::Metadata;

/// The name of a column, and its cell in the row of a step.
type Column = (&'static str, fn(&ViscoelasticContact, &StepReport) -> String);

/// The columns of every history.
const COLUMNS: [Column; 17] = [
    ("time [s]", |contact, _| number(contact.time())),
    ("step length [s]", |_, report| number(report.dt)),
    ("force [N]", |contact, _| number(contact.force())),
    ("approach [m]", |contact, _| number(contact.approach())),
    ("tilt 1 [rad]", |contact, _| number(contact.tilt()[0])),
    ("tilt 2 [rad]", |contact, _| number(contact.tilt()[1])),
    ("moment 1 [N m]", |contact, _| number(contact.moment()[0])),
    ("moment 2 [N m]", |contact, _| number(contact.moment()[1])),
    ("contact area [m2]", |contact, _| number(contact.contact_area())),
    ("contact cells", |contact, _| contact.contact_cells().to_string()),
    ("mean pressure [Pa]", |contact, _| number(contact.mean_pressure())),
    ("max pressure [Pa]", |contact, _| number(contact.max_pressure())),
    ("iterations", |_, report| report.iterations.to_string()),
    ("convolutions", |_, report| report.convolutions.to_string()),
    ("preconditioner applications", |_, report| report.preconditioner_applications.to_string()),
    ("residual", |_, report| number(report.residual)),
    ("time error", |_, report| report.time_error.map(number).unwrap_or_default()),
];

/// A number with enough digits to be read back bitwise.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A run as a CSV file with one row per step, each passed to the operating system when its `record` returns.
///
/// The first line is `#` and the [`Metadata`] as JSON, the second the names of the columns with their units, separated
/// by commas: `time [s]`, `step length [s]`, `force [N]`, `approach [m]`, `tilt 1 [rad]`, `tilt 2 [rad]`,
/// `moment 1 [N m]`, `moment 2 [N m]`, `contact area [m2]`, `contact cells`, `mean pressure [Pa]`,
/// `max pressure [Pa]`, cost and accuracy of the step as in [`StepReport`] (`time error` is
/// empty where nothing was estimated), and additional columns of your choice.
/// Where [ranks](crate::parallel) share out the contact, all of them make and write the history, and rank 0 has the file.
/// [`Run::samples`](crate::contact::Run::samples) has rows between the ends of steps: pass the contact and the report of each sample.
/// Numbers have enough digits to be read back bitwise. In Python: `pandas.read_csv(path, comment="#")`.
///
/// ```
/// use viscocontact::{output::{CsvHistory, Metadata}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
///     .build()?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-csv-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder).unwrap();
/// # let path = folder.join("history.csv");
/// let mut history = CsvHistory::create(&path, &Metadata::new("Ball on rubber"), &contact, &["energy [J]"])?;
/// let report = contact.step(0.0, Load::force(0.5))?;
/// history.record(&contact, &report, &[0.5 * report.force * report.approach])?;
/// # std::fs::remove_dir_all(&folder).unwrap();
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug)]
pub struct CsvHistory {
    path: PathBuf,
    /// None on ranks other than 0.
    file: Option<Appending<File>>,
    additional: usize,
}

impl CsvHistory {
    /// A new file for the history of `contact`, with `additional` columns after the standard ones.
    ///
    /// # Errors
    /// If the file exists ([`AlreadyExists`](std::io::ErrorKind::AlreadyExists)) or cannot be written, or the name of a column is empty, already used, or contains `#`, a
    /// quote or a control character, which readers would misinterpret.
    pub fn create(
        path: impl AsRef<Path>,
        metadata: &Metadata,
        contact: &ViscoelasticContact,
        additional: &[&str],
    ) -> Result<CsvHistory> {
        CsvHistory::begin(path.as_ref(), (metadata, contact, additional), false)
    }

    /// [`CsvHistory::create`] in the place of an earlier file, which is emptied first.
    ///
    /// # Errors
    /// As [`CsvHistory::create`], except that the file may exist; something else than a file may not
    /// ([`FileError::NotAFile`](crate::FileError::NotAFile)).
    pub fn create_or_replace(
        path: impl AsRef<Path>,
        metadata: &Metadata,
        contact: &ViscoelasticContact,
        additional: &[&str],
    ) -> Result<CsvHistory> {
        CsvHistory::begin(path.as_ref(), (metadata, contact, additional), true)
    }

    fn begin(
        path: &Path,
        (metadata, contact, additional): (&Metadata, &ViscoelasticContact, &[&str]),
        replaced: bool,
    ) -> Result<CsvHistory> {
        let unusable = |error| failed(path, error);
        contact.agreed(check_names(additional).map_err(unusable))?;
        let names: Vec<String> =
            COLUMNS.iter().map(|(name, _)| name).chain(additional).map(|name| quoted(name)).collect();
        let head = format!("# {}\n{}\n", metadata.json(contact), names.join(","));
        let file = contact.by_one_rank(|| {
            let file = if replaced {
                check_regular(path)?;
                File::create(path)
            } else {
                File::create_new(path)
            };
            let mut file = Appending::new(file.map_err(|error| unusable(or_replace(error)))?);
            if let Err(error) = file.append(head.as_bytes()) {
                let _ = fs::remove_file(path); // report the error of the write instead
                return Err(unusable(error));
            }
            Ok(file)
        })?;
        Ok(CsvHistory { path: path.to_owned(), file, additional: additional.len() })
    }

    /// Appends the row of the last step, with the values of the additional columns. NaN is written as `NaN`.
    ///
    /// # Errors
    /// If there is not one value for each additional column, or the file cannot be written. Then nothing of the row is
    /// in the file, and writing can be repeated once there is space again.
    pub fn record(&mut self, contact: &ViscoelasticContact, report: &StepReport, additional: &[f64]) -> Result<()> {
        contact.agreed(exact_length("additional columns", additional.len(), self.additional))?;
        let standard = COLUMNS.iter().map(|(_, cell)| cell(contact, report));
        let cells: Vec<String> = standard.chain(additional.iter().copied().map(number)).collect();
        let row = cells.join(",") + "\n";
        let CsvHistory { path, file, .. } = self;
        let appended = file.as_mut().map_or(Ok(()), |file| file.append(row.as_bytes()));
        contact.agreed(appended.map_err(|error| failed(path, error)))
    }
}

/// The error of a file that exists names the way to replace it.
fn or_replace(error: io::Error) -> io::Error {
    match error.kind() {
        kind @ io::ErrorKind::AlreadyExists => {
            io::Error::new(kind, "it exists: CsvHistory::create_or_replace replaces it")
        }
        _ => error,
    }
}

/// Rejects names that readers would misinterpret.
fn check_names(additional: &[&str]) -> io::Result<()> {
    for (k, name) in additional.iter().enumerate() {
        let invalid = name.is_empty() || name.contains(|c: char| c == '#' || c == '"' || c.is_control());
        if invalid || COLUMNS.iter().any(|(standard, _)| standard == name) || additional[..k].contains(name) {
            let rule = "unique, not empty, and without '#', quotes and control characters";
            let reason = format!("invalid column name {name:?}: names must be {rule}");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
    }
    Ok(())
}

/// A column name, which contains no quotes, as a CSV field.
fn quoted(name: &str) -> String {
    if name.contains(',') { format!("\"{name}\"") } else { name.to_owned() }
}
