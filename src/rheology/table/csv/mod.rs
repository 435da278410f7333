//! Tables of measured data from CSV files.

mod headings;
mod unit;

use std::io::Read;
use std::path::Path;

use crate::error::{Place, Result, positive};
use crate::input::{TextFormat, TextRow, TextTable, open};
use crate::rheology::table::data::{Deformation, Layout, Row};
use crate::rheology::table::{Experiment, Measurements};
use headings::{check_units, columns, deformation};

/// The units of a file in SI.
///
/// Needs the feature `csv`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::exhaustive_structs, reason = "users write it out")]
pub struct Units {
    /// One unit of time in s, or of frequency in rad/s: 60 for minutes, 2π for Hz.
    pub abscissa: f64,
    /// One unit of compliance in 1/Pa, or of modulus in Pa: 1e-9 for 1/GPa, 1e6 for MPa.
    pub value: f64,
}

impl Units {
    /// s, rad/s, 1/Pa, Pa.
    pub const SI: Units = Units { abscissa: 1.0, value: 1.0 };
}

impl Measurements {
    /// Reads a CSV file of an `experiment`: the columns of [`Experiment`].
    ///
    /// Rows may stand in any order. Columns too, if the first line names them by the first word or symbol of each heading,
    /// whatever the case and the unit after it. The first line has headings if none of its fields is a number. Without
    /// headings there are the columns of the experiment, in their order. Headings with a unit (`t [min]`, `J (1/GPa)`,
    /// `E/MPa`) must agree with `units`; words that are not a known unit are ignored. Headings that name moduli or compliances in
    /// tension (E, E′, E″, D) make a table for [`Measurements::fit_tension`]; those in shear, for [`Measurements::fit`].
    ///
    /// `format` states the delimiter and the decimal mark.
    ///
    /// # Errors
    /// As [`Measurements::creep`]; if the file cannot be read ([`FileError::Unreadable`](crate::FileError::Unreadable)), or, each
    /// reported with its line: too few or too many columns ([`TextError::Columns`](crate::TextError)), an entry that is not
    /// a number ([`TextError::NotNumeric`](crate::TextError)) or has the other decimal mark
    /// ([`TextError::DecimalMark`](crate::TextError)), columns that no heading names
    /// ([`TableError::Heading`](crate::rheology::TableError)), a unit that differs
    /// ([`TableError::Unit`](crate::rheology::TableError)).
    pub fn from_csv(
        experiment: Experiment,
        path: impl AsRef<Path>,
        units: Units,
        format: TextFormat,
    ) -> Result<Measurements> {
        Measurements::from_csv_reader(experiment, open(path.as_ref())?, units, format)
    }

    /// [`Measurements::from_csv`] from any reader.
    ///
    /// ```
    /// use viscocontact::TextFormat;
    /// use viscocontact::rheology::{Experiment, Measurements, Units};
    ///
    /// let text = "# PMMA, 23 °C\ntime [s], J [1/Pa]\n10, 1.2e-9\n1, 1.0e-9\n100, 1.3e-9\n3, 1.1e-9\n";
    /// let format = TextFormat::default();
    /// let body = Measurements::from_csv_reader(Experiment::Creep, text.as_bytes(), Units::SI, format)?.fit()?;
    /// println!("{}", body.report());
    ///
    /// let text = "omega,G',G''\n0.1,1.0e6,2e5\n1,1.5e6,4e5\n10,2.2e6,4e5\n100,2.5e6,1e5\n";
    /// let body = Measurements::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::SI, format)?.fit()?;
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Measurements::from_csv`].
    pub fn from_csv_reader(
        experiment: Experiment,
        reader: impl Read,
        units: Units,
        format: TextFormat,
    ) -> Result<Measurements> {
        let (rows, deformation) = read(reader, experiment.layout(), units, format)?;
        Ok(Measurements { deformation, ..Measurements::from_rows(experiment, rows)? })
    }
}

/// The rows of a file, and the deformation that its headings name.
fn read(reader: impl Read, layout: Layout, units: Units, format: TextFormat) -> Result<(Vec<Row>, Deformation)> {
    positive("Units::abscissa", units.abscissa)?;
    positive("Units::value", units.value)?;
    let table = TextTable::read(reader, layout.table, format)?;
    let mut rows = table.rows().filter(|row| row.fields.iter().any(|field| !field.is_empty())).peekable();
    let names: Vec<_> = layout.names().collect();
    let columns_needed = names.join(", ");
    // the headings determine the number of columns; without headings there are only those needed
    let (mut order, mut width) = ((0..names.len()).collect::<Vec<_>>(), names.len());
    let mut named = Deformation::Unnamed;
    if let Some(mut headings) = rows.next_if(|row| !row.has_numbers()) {
        drop_empty(&mut headings, 0);
        width = headings.fields.len();
        order = columns(&headings, &layout)?;
        check_units(&headings, &order, &layout, units)?;
        named = deformation(&headings, &order);
    }
    let numbers = |mut row: TextRow| {
        drop_empty(&mut row, width);
        row.check_width(width, &columns_needed)?;
        let x = row.number(order[0])? * units.abscissa;
        let values = order[1..].iter().map(|&column| Ok(row.number(column)? * units.value)).collect::<Result<_>>()?;
        Ok(Row { place: Place::Line(row.line), x, values })
    };
    Ok((rows.map(numbers).collect::<Result<_>>()?, named))
}

/// Drops empty fields beyond `width`, left by delimiters at the end of a line.
fn drop_empty(row: &mut TextRow, width: usize) {
    while row.fields.len() > width && row.fields.last().is_some_and(|field| field.is_empty()) {
        row.fields.pop();
    }
}
