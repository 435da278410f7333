//! The history of a run as a CSV table.

use std::fs::{self, File};
use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};

use crate::contact::StepReport;
use crate::error::{Result, exact_length};
use crate::file::{Appending, check_regular, failed, replace};
use crate::output::{Earlier, Kept, Metadata};
use crate::run::Contact;

/// A column of every history: its name, and its cell in the row of a step.
type Column<C> = (&'static str, fn(&C, &StepReport) -> String);

fn columns<C: Contact>(_: &C) -> [Column<C>; 17] {
    [
        ("time [s]", |contact, _| number(contact.time())),
        ("step length [s]", |_, report| number(report.dt)),
        ("force [N]", |contact, _| number(contact.force())),
        ("approach [m]", |contact, _| number(contact.approach())),
        ("tilt 1 [rad]", |contact, _| number(contact.tilt()[0])),
        ("tilt 2 [rad]", |contact, _| number(contact.tilt()[1])),
        ("moment 1 [N m]", |contact, _| known(contact.in_space().map(|fields| fields.moment()[0]))),
        ("moment 2 [N m]", |contact, _| known(contact.in_space().map(|fields| fields.moment()[1]))),
        ("contact area [m2]", |contact, _| number(contact.contact_area())),
        ("contact cells", |_, report| report.contact_cells.to_string()),
        ("mean pressure [Pa]", |contact, _| number(contact.mean_pressure())),
        ("max pressure [Pa]", |contact, _| known(contact.in_space().map(|fields| fields.max_pressure()))),
        ("iterations", |_, report| report.iterations.to_string()),
        ("convolutions", |_, report| report.convolutions.to_string()),
        ("preconditioner applications", |_, report| report.preconditioner_applications.to_string()),
        ("residual", |_, report| number(report.residual)),
        ("time error", |_, report| known(report.time_error)),
    ]
}

/// The result of every rank, or the error of one.
fn agreed<T>(contact: &impl Contact, own: Result<T>) -> Result<T> {
    match contact.in_space() {
        Some(fields) => fields.agreed(own),
        None => own,
    }
}

/// A number with enough digits to be read back bitwise.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A number, or nothing where it is not known.
fn known(value: Option<f64>) -> String {
    value.map(number).unwrap_or_default()
}

/// A run as a CSV file with one row per step, each passed to the operating system when its `record` returns.
///
/// The first line has the names of the columns with their units,
/// separated by commas: `time [s]`, `step length [s]`, `force [N]`, `approach [m]`, `tilt 1 [rad]`, `tilt 2 [rad]`,
/// `moment 1 [N m]`, `moment 2 [N m]`, `contact area [m2]`, `contact cells`, `mean pressure [Pa]`, `max pressure
/// [Pa]`, cost and accuracy of the step as in [`StepReport`] (`time error` is empty where nothing was estimated), and
/// the columns of the contact ([`Contact::columns`]) and additional ones of your choice. A [`Contact`] is one in space,
/// on elastic states, or your own; without fields, moments and maximum pressure are empty. Where [ranks](crate::parallel) share out the contact, all of them make
/// and write the history, and rank 0 has the file.
/// [`Run::samples`](crate::run::Run::samples) has rows between the ends of steps: pass the contact and the report of each sample.
/// Numbers have enough digits to be read back bitwise. In Python: `pandas.read_csv(path)`. The [`Metadata`] are beside
/// it as JSON, in a file with `.json` after the name: `history.csv.json`.
///
/// ```
/// use viscocontact::{output::{CsvHistory, Earlier, Metadata}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
///     .build()?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-csv-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder).unwrap();
/// # let path = folder.join("history.csv");
/// let mut history = CsvHistory::create(&path, &Metadata::new("Ball on rubber"), &contact, &["energy [J]"], Earlier::Refuse)?;
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
    own: Vec<&'static str>,
    additional: usize,
}

impl CsvHistory {
    /// A file for the history of `contact`, with `additional` columns after the standard ones.
    ///
    /// # Errors
    /// If the file cannot be written, exists where [`Earlier`] refuses it, is no file, or no history with these
    /// columns that could be
    /// continued; or if the name of a column is empty, already used, or contains `#`, a quote or a control character,
    /// which readers would misinterpret.
    pub fn create(
        path: impl AsRef<Path>,
        metadata: &Metadata,
        contact: &impl Contact,
        additional: &[&str],
        earlier: Earlier,
    ) -> Result<CsvHistory> {
        let path = path.as_ref();
        let unusable = |error| failed(path, error);
        let own: Vec<&str> = contact.columns().into_iter().map(|(name, _)| name).collect();
        let names = [&columns(contact).map(|(name, _)| name)[..], &own].concat();
        agreed(contact, check_names(&names, additional).map_err(unusable))?;
        let names: Vec<String> = names.iter().chain(additional).map(|name| quoted(name)).collect();
        let names = names.join(",");
        let (scene, json) = (beside(path), metadata.json(contact));
        let create = || {
            if earlier != Earlier::Refuse {
                check_regular(path)?;
            }
            if earlier == Earlier::Continue && path.exists() {
                return continued(path, &names, contact).map_err(unusable);
            }
            let file = if earlier == Earlier::Refuse { File::create_new(path) } else { File::create(path) };
            let mut file = Appending::new(file.map_err(|error| unusable(or_replace(error)))?);
            let head = file.append(format!("{names}\n").as_bytes()).map_err(unusable);
            if let Err(error) = head.and_then(|()| replace(&scene, |out| writeln!(out, "{json}"))) {
                let _ = fs::remove_file(path); // report the error of the write instead
                return Err(error);
            }
            Ok(file)
        };
        let file = match contact.in_space() {
            Some(fields) => fields.by_one_rank(create)?,
            None => Some(create()?),
        };
        Ok(CsvHistory { path: path.to_owned(), file, own, additional: additional.len() })
    }

    /// Appends the row of the last step, with the values of the additional columns. NaN is written as `NaN`.
    ///
    /// # Errors
    /// If there is not one value for each additional column, the contact has other columns than it had, or the file
    /// cannot be written. Then nothing of the row is in the file, and writing can be repeated once there is space again.
    pub fn record(&mut self, contact: &impl Contact, report: &StepReport, additional: &[f64]) -> Result<()> {
        agreed(contact, exact_length("additional columns", additional.len(), self.additional))?;
        let CsvHistory { path, file, own, .. } = self;
        let (names, values): (Vec<_>, Vec<_>) = contact.columns().into_iter().unzip();
        if names != *own {
            let reason = format!("the contact has the columns {names:?}, not {own:?} as when the file was made");
            return agreed(contact, Err(failed(path, io::Error::new(io::ErrorKind::InvalidInput, reason))));
        }
        let cells = columns(contact).map(|(_, cell)| cell(contact, report)).into_iter();
        let cells: Vec<String> = cells.chain(values.iter().chain(additional).copied().map(number)).collect();
        let row = cells.join(",") + "\n";
        let appended = file.as_mut().map_or(Ok(()), |file| file.append(row.as_bytes()));
        agreed(contact, appended.map_err(|error| failed(path, error)))
    }
}

/// The file of the scene beside a history.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".json");
    name.into()
}

/// The file of a history of these columns, cut off after the state of a contact.
fn continued(path: &Path, names: &str, contact: &impl Contact) -> io::Result<Appending<File>> {
    let now = [contact.time(), contact.force(), contact.approach()];
    let file = File::options().read(true).write(true).open(path)?;
    let mut lines = io::BufReader::new(&file);
    let (mut number, mut end, mut kept, mut line) = (0, 0, Kept::default(), String::new());
    while lines.read_line(&mut line)? > 0 && line.ends_with('\n') {
        end += line.len() as u64;
        let numbers: Vec<f64> = line.split(',').take(4).filter_map(|cell| cell.parse().ok()).collect();
        match (number, &numbers[..]) {
            (0, _) if line.trim_end_matches(['\n', '\r']) == names => kept.earlier = end,
            (1.., [time, _, force, approach]) if kept.includes(end, [*time, *force, *approach], now) => {}
            _ => break,
        }
        number += 1;
        line.clear();
    }
    if number == 0 {
        let reason = "it is no history with these columns: Earlier::Replace replaces it";
        return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
    }
    Appending::after(file, kept.end())
}

/// The error of a file that exists names the way to replace it.
fn or_replace(error: io::Error) -> io::Error {
    match error.kind() {
        kind @ io::ErrorKind::AlreadyExists => io::Error::new(kind, "it exists: Earlier::Replace replaces it"),
        _ => error,
    }
}

/// Rejects names that readers would misinterpret.
fn check_names(names: &[&str], additional: &[&str]) -> io::Result<()> {
    for (k, name) in additional.iter().enumerate() {
        let invalid = name.is_empty() || name.contains(|c: char| c == '#' || c == '"' || c.is_control());
        if invalid || names.contains(name) || additional[..k].contains(name) {
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
