//! Measured curves from text files.

mod check;
mod error;
mod headings;
mod table;

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use viscocontact::states::ElasticStates;
use viscocontact::{FileError, TextFormat};

use crate::error::{Result, positive};
use crate::experiment::{Curve, Experiment};
use crate::protocol::Protocol;
pub use error::DataError;

/// The columns of a measured curve, from a CSV file with headings.
///
/// The first line names the columns by the first word of each heading, whatever the case, and their units after it: `t [s]`,
/// `Time (ms)`, `F/nN`, `depth_um`. Other columns are ignored, and lines that are empty or begin with `#` skipped.
///
/// | column | first word of the heading | |
/// |---|---|---|
/// | time | t, time | ascending |
/// | force | f, force, load, p | positive where it presses |
/// | deflection | deflection, defl | of the spring, in place of the force |
/// | drive | z, zsnsr, drive, position, piezo, base, stage | position of the base of the spring, growing toward the sample |
/// | depth | depth, indentation, δ, delta, h | of the tip, measured independently of the force |
///
/// A file may have drive and depth: a curve takes one of them. The depth of an atomic force microscope is made from the noisy
/// force, so that a curve through the spring ([`Recording::spring_curve`]) is the better datum.
///
/// ```
/// use viscocontact::TextFormat;
/// use viscocontact::states::ElasticStates;
/// use viscocontact_identify::Recording;
///
/// let mut text = String::from("# bead on gel\nTime (ms), z [nm], Defl [nm]\n");
/// for k in 0..100 {
///     let depth = 10.0 * f64::from(k).max(30.0) - 300.0;
///     text += &format!("{k}, {}, {}\n", 10 * k - 300, 0.01 * depth.powf(1.5));
/// }
/// let recording = Recording::from_csv_reader(text.as_bytes(), TextFormat::default())?;
/// let curve = recording.spring_curve(&ElasticStates::sphere(5.0e-6)?, 0.1)?;
/// assert_eq!(curve.force().len(), 100);
/// # Ok::<(), viscocontact_identify::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    times: Vec<f64>,
    force: Option<Vec<f64>>,
    deflection: Option<Vec<f64>>,
    drive: Option<Vec<f64>>,
    depth: Option<Vec<f64>>,
}

impl Recording {
    /// Reads a CSV file. `format` states the delimiter and the decimal mark.
    ///
    /// # Errors
    /// If the file cannot be read; each with its line: rows of another number of columns, entries that are not numbers,
    /// columns that no heading names or more than one, headings without a unit of their quantity, times that do not ascend.
    pub fn from_csv(path: impl AsRef<Path>, format: TextFormat) -> Result<Recording> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|error| unreadable(path.display().to_string(), &error))?;
        Recording::read(file, path.display().to_string(), format)
    }

    /// [`Recording::from_csv`] from any reader.
    ///
    /// # Errors
    /// As [`Recording::from_csv`].
    pub fn from_csv_reader(reader: impl Read, format: TextFormat) -> Result<Recording> {
        Recording::read(reader, "recording".into(), format)
    }

    fn read(mut reader: impl Read, name: String, format: TextFormat) -> Result<Recording> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).map_err(|error| unreadable(name, &error))?;
        table::recording(&String::from_utf8_lossy(&bytes), format)
    }

    /// The same with the other sign of force and deflection: for instruments whose force is negative where it presses.
    #[must_use]
    pub fn flip_force(mut self) -> Recording {
        for column in [&mut self.force, &mut self.deflection].into_iter().flatten() {
            column.iter_mut().for_each(|value| *value = -*value);
        }
        self
    }

    /// The same with the other sign of drive and depth: for stages whose position falls toward the sample.
    #[must_use]
    pub fn flip_drive(mut self) -> Recording {
        for column in [&mut self.drive, &mut self.depth].into_iter().flatten() {
            column.iter_mut().for_each(|value| *value = -*value);
        }
        self
    }

    /// The curve with the measured depth as its drive.
    ///
    /// # Errors
    /// If there is no column of the depth or of the force; those of [`Curve::check`].
    pub fn depth_curve(&self, tip: &Arc<ElasticStates>) -> Result<Curve> {
        let cure = "name a column 'depth', or use Recording::spring_curve";
        let depth = self.depth.clone().ok_or(DataError::NoColumn { column: "depth", cure })?;
        let cure = "name a column 'F', or use Recording::spring_curve, which takes a deflection";
        let force = self.force.clone().ok_or(DataError::NoColumn { column: "force", cure })?;
        let curve = Curve::new(Experiment::new(Protocol::new(self.times.clone(), depth)?, Arc::clone(tip)), force)?;
        curve.check().map(|()| curve)
    }

    /// The curve with the position of the base as its drive, through a spring of this `stiffness` \[N/m\]. The force is the
    /// stiffness times the deflection where the file has no force.
    ///
    /// # Errors
    /// If there is no column of the drive, or neither force nor deflection; if the stiffness is not finite and positive; those of
    /// [`Curve::check`].
    pub fn spring_curve(&self, tip: &Arc<ElasticStates>, stiffness: f64) -> Result<Curve> {
        positive("stiffness of the spring", stiffness)?;
        let cure = "name a column 'z', or use Recording::depth_curve";
        let drive = self.drive.clone().ok_or(DataError::NoColumn { column: "drive", cure })?;
        let deflected = || self.deflection.as_ref().map(|column| column.iter().map(|d| stiffness * d).collect());
        let cure = "name a column 'F' or 'deflection'";
        let force =
            self.force.clone().or_else(deflected).ok_or(DataError::NoColumn { column: "force or deflection", cure })?;
        let protocol = Protocol::new(self.times.clone(), drive)?;
        let curve = Curve::new(Experiment::new(protocol, Arc::clone(tip)).with_spring(stiffness)?, force)?;
        curve.check().map(|()| curve)
    }
}

fn unreadable(file: String, error: &std::io::Error) -> viscocontact::Error {
    FileError::Unreadable { file, reason: error.to_string(), kind: Some(error.kind()) }.into()
}
