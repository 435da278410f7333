//! Measured curves from text files.

mod check;
mod columns;

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use viscocontact::TextFormat;
use viscocontact::input::{TakenColumn, TextTable};
use viscocontact::states::ElasticStates;

use crate::error::{Error, Result, positive};
use crate::experiment::{Curve, Experiment};
use crate::protocol::Protocol;

/// The columns of a measured curve: from a text file with headings, or from arrays.
///
/// The table may stand below other lines ([`TextTable`]). Its headings name the columns by their first word, whatever the case,
/// and their units after it or in a row below: `t [s]`, `Time (ms)`, `F/nN`, `depth_um`. Other columns are ignored.
///
/// | column | first word of the heading | |
/// |---|---|---|
/// | time | t, time; or the only column with a unit of time | ascending |
/// | force | f, force, load, p; or the only column with a unit of force | positive where it presses |
/// | deflection | deflection, defl, vdeflection, cantilever | of the spring, in place of the force |
/// | drive | z, zsnsr, height, drive, position, piezo, base, stage | position of the base of the spring, growing toward the sample |
/// | depth | depth, indentation, δ, delta, h, displacement into | of the tip, measured independently of the force |
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
/// // the same from arrays
/// let [drive, deflection] = [recording.drive, recording.deflection];
/// let arrays = Recording { times: recording.times, drive, deflection, ..Recording::default() };
/// assert_eq!(arrays.spring_curve(&ElasticStates::sphere(5.0e-6)?, 0.1)?, curve);
/// # Ok::<(), viscocontact_identify::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(clippy::exhaustive_structs, reason = "users write it out")]
pub struct Recording {
    /// The times \[s\].
    pub times: Vec<f64>,
    /// The force at each time \[N\], positive where it presses.
    pub force: Option<Vec<f64>>,
    /// The deflection of the spring \[m\].
    pub deflection: Option<Vec<f64>>,
    /// The position of the base of the spring \[m\].
    pub drive: Option<Vec<f64>>,
    /// The depth of the tip \[m\].
    pub depth: Option<Vec<f64>>,
    /// What was taken for what in a file, with headings and units; empty for arrays.
    pub columns: Vec<TakenColumn>,
}

impl Recording {
    /// Reads a text file. `format` says how it is written, where this is not found out.
    ///
    /// # Errors
    /// If the file cannot be read; each with its line: rows of another number of columns, entries that are not numbers,
    /// columns that no heading names or more than one, headings without a unit of their quantity, times that do not ascend.
    pub fn from_csv(path: impl AsRef<Path>, format: TextFormat) -> Result<Recording> {
        Recording::from_table(&TextTable::open(path, format)?)
    }

    /// [`Recording::from_csv`] from any reader.
    ///
    /// # Errors
    /// As [`Recording::from_csv`].
    pub fn from_csv_reader(reader: impl Read, format: TextFormat) -> Result<Recording> {
        Recording::from_table(&TextTable::read(reader, format)?)
    }

    /// The same with the other sign of force and deflection: for instruments whose force is negative where it presses.
    #[must_use]
    pub fn flip_force(mut self) -> Recording {
        [&mut self.force, &mut self.deflection].into_iter().flatten().flatten().for_each(|value| *value = -*value);
        self
    }

    /// The same with the other sign of drive and depth: for stages whose position falls toward the sample.
    #[must_use]
    pub fn flip_drive(mut self) -> Recording {
        [&mut self.drive, &mut self.depth].into_iter().flatten().flatten().for_each(|value| *value = -*value);
        self
    }

    /// The curve with the measured depth as its drive.
    ///
    /// # Errors
    /// If there is no column of the depth or of the force; those of [`Curve::check`].
    pub fn depth_curve(&self, tip: &Arc<ElasticStates>) -> Result<Curve> {
        let remedy = "name a column 'depth', or use Recording::spring_curve";
        let depth = self.depth.clone().ok_or(Error::NoColumn { column: "depth", remedy })?;
        let remedy = "name a column 'F', or use Recording::spring_curve, which takes a deflection";
        let force = self.force.clone().ok_or(Error::NoColumn { column: "force", remedy })?;
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
        let remedy = "name a column 'z', or use Recording::depth_curve";
        let drive = self.drive.clone().ok_or(Error::NoColumn { column: "drive", remedy })?;
        let deflected = || self.deflection.as_ref().map(|column| column.iter().map(|d| stiffness * d).collect());
        let remedy = "name a column 'F' or 'deflection'";
        let force =
            self.force.clone().or_else(deflected).ok_or(Error::NoColumn { column: "force or deflection", remedy })?;
        let protocol = Protocol::new(self.times.clone(), drive)?;
        let curve = Curve::new(Experiment::new(protocol, Arc::clone(tip)).with_spring(stiffness)?, force)?;
        curve.check().map(|()| curve)
    }
}
