//! The history of a run as a table.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use crate::ViscoelasticContact;
use crate::contact::StepReport;
use crate::error::{Result, exact_length};
use crate::file::{Appending, failed};
use crate::output::Scene;

/// The columns of every history.
const COLUMNS: [&str; 17] = [
    "time [s]",
    "step length [s]",
    "force [N]",
    "approach [m]",
    "tilt 1 [rad]",
    "tilt 2 [rad]",
    "moment 1 [N m]",
    "moment 2 [N m]",
    "contact area [m2]",
    "contact cells",
    "mean pressure [Pa]",
    "greatest pressure [Pa]",
    "iterations",
    "convolutions",
    "preconditioner applications",
    "residual",
    "time error",
];

/// A run as a CSV file of one row a step, each on its way to the disk when its `write` returns.
///
/// Needs the feature `csv`.
///
/// The first line is a `#` and the [`Scene`] as JSON, the second the names of the columns with their units, separated
/// by commas: `time [s]`, `step length [s]`, `force [N]`, `approach [m]`, `tilt 1 [rad]`, `tilt 2 [rad]`,
/// `moment 1 [N m]`, `moment 2 [N m]`, `contact area [m2]`, `contact cells`, `mean pressure [Pa]`,
/// `greatest pressure [Pa]`, the cost and accuracy of the step as in [`StepReport`], and
/// columns of your own. Numbers have as many digits as make them the same when read back. In Python:
/// `pandas.read_csv(path, comment="#")`.
///
/// ```
/// use viscocontact::{output::{CsvHistory, Scene}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-csv-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder).unwrap();
/// # let path = folder.join("history.csv");
/// let mut history = CsvHistory::create(&path, &Scene::new("Ball on rubber"), &contact, &["energy [J]"])?;
/// let report = contact.step(0.0, Load::force(0.5))?;
/// history.write(&contact, &report, &[0.5 * report.force * report.approach])?;
/// # std::fs::remove_dir_all(&folder).unwrap();
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug)]
pub struct CsvHistory {
    path: PathBuf,
    file: Appending<File>,
    further: usize,
}

impl CsvHistory {
    /// A new file for the history of `contact`, with columns named `further` behind those that every history has.
    ///
    /// # Errors
    /// If the file exists or cannot be written, or the name of a column is empty, taken, or holds a `#`, a quote or a
    /// control character, which readers would stumble on.
    pub fn create(
        path: impl AsRef<Path>,
        scene: &Scene,
        contact: &ViscoelasticContact,
        further: &[&str],
    ) -> Result<CsvHistory> {
        let path = path.as_ref().to_owned();
        for (k, name) in further.iter().enumerate() {
            let odd = name.is_empty() || name.contains(|c: char| c == '#' || c == '"' || c.is_control());
            if odd || COLUMNS.contains(name) || further[..k].contains(name) {
                let rule = "a name of its own, without '#', quotes and control characters";
                return Err(failed(&path, format!("a column may not be called {name:?}: it must have {rule}")));
            }
        }
        let names: Vec<String> = COLUMNS.iter().chain(further).map(|name| quoted(name)).collect();
        let head = format!("# {}\n{}\n", scene.json(contact), names.join(","));
        let mut file = Appending::new(File::create_new(&path).map_err(|error| failed(&path, error))?);
        if let Err(error) = file.append(head.as_bytes()) {
            let _ = fs::remove_file(&path); // the error that matters is that of the write
            return Err(failed(&path, error));
        }
        Ok(CsvHistory { path, file, further: further.len() })
    }

    /// Adds the row of a step that was just taken, with the values of the further columns, which are written as they
    /// are: NaN as `NaN`.
    ///
    /// # Errors
    /// If there is not one value for each further column, or the file cannot be written. Nothing of the row is in the file
    /// then, and the next row can be written as soon as there is room again.
    pub fn write(&mut self, contact: &ViscoelasticContact, report: &StepReport, further: &[f64]) -> Result<()> {
        exact_length("further columns", further.len(), self.further)?;
        let number = |value: f64| format!("{value:?}");
        let ([tilt1, tilt2], [moment1, moment2]) = (contact.tilt(), contact.moment());
        let own = [
            number(contact.time()),
            number(report.dt),
            number(contact.force()),
            number(contact.approach()),
            number(tilt1),
            number(tilt2),
            number(moment1),
            number(moment2),
            number(contact.contact_area()),
            contact.contact_cells().to_string(),
            number(contact.mean_pressure()),
            number(contact.greatest_pressure()),
            report.iterations.to_string(),
            report.convolutions.to_string(),
            report.preconditioner_applications.to_string(),
            number(report.residual),
            number(report.time_error),
        ];
        let cells: Vec<String> = own.into_iter().chain(further.iter().copied().map(number)).collect();
        let row = cells.join(",") + "\n";
        self.file.append(row.as_bytes()).map_err(|error| failed(&self.path, error))
    }
}

/// The name of a column, which holds no quotes, as a field.
fn quoted(name: &str) -> String {
    if name.contains(',') { format!("\"{name}\"") } else { name.to_owned() }
}
