//! Tables of measured data from CSV files.

mod headings;
mod number;
mod records;
mod unit;

use std::fs::File;
use std::io::Read;
use std::iter;
use std::path::Path;

use crate::error::{Place, Result, TableError, positive};
use crate::rheology::table::data::{CREEP, DYNAMIC, Layout, RELAXATION, Row};
use crate::rheology::table::{TabulatedCreep, TabulatedDynamic, TabulatedRelaxation};
use headings::{check_units, columns};
use number::{Numbers, one_decimal, plain, resembles, shortened};
use records::{Record, records, separator};

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

/// Readers of the three kinds of table.
macro_rules! from_csv {
    ($table:ident, $layout:expr, $columns:literal, $example:literal) => {
        impl $table {
            #[doc = concat!("Reads a CSV file and fits it: columns ", $columns, ".")]
            ///
            /// Needs the feature `csv`.
            ///
            /// Rows may stand in any order. Columns too, where a first line names them (headings are recognised by
            /// their first word or symbol, whatever the case and the unit after it); without headings, or with
            /// unknown ones, they are read in the order above. A first line is one of headings if none of
            /// its fields resembles a number. Headings with a unit (`t [min]`, `J (1/GPa)`, `E/MPa`) must agree with
            /// `units`; words that are not a known unit are ignored.
            ///
            /// Values are separated by commas, semicolons, tabs or blanks; values that contain separators or line ends
            /// are quoted. Numbers have an exponent with `e`, or `d` as in Fortran, and a decimal point; if commas are
            /// not the separator, all numbers may have decimal commas. Only lines that start with `#` and empty lines
            /// are skipped.
            ///
            /// # Errors
            /// If the file cannot be read, the data cannot be fitted, or, each reported with its line: too few or too
            /// many columns ([`TableError::Columns`]), an entry that is not a number ([`TableError::NotNumeric`]) or is
            /// ambiguous, as `1,5` in a line without headings ([`TableError::Ambiguous`]), columns that no heading
            /// names ([`TableError::Heading`]), a unit that differs ([`TableError::Unit`], [`TableError::Hertz`]).
            pub fn from_csv(path: impl AsRef<Path>, units: Units) -> Result<$table> {
                let path = path.as_ref();
                let unreadable = |error: std::io::Error| TableError::Unreadable {
                    file: path.display().to_string(),
                    reason: error.to_string(),
                    kind: Some(error.kind()),
                };
                $table::from_csv_reader(File::open(path).map_err(unreadable)?, units)
            }

            #[doc = concat!("[`", stringify!($table), "::from_csv`] from any reader.")]
            ///
            /// Needs the feature `csv`.
            ///
            /// ```
            #[doc = concat!("use viscocontact::rheology::{", stringify!($table), ", Units};")]
            ///
            #[doc = $example]
            #[doc = concat!("let body = ", stringify!($table), "::from_csv_reader(text.as_bytes(), Units::SI)?;")]
            /// println!("{}", body.report());
            /// # Ok::<(), viscocontact::Error>(())
            /// ```
            ///
            /// # Errors
            #[doc = concat!("As [`", stringify!($table), "::from_csv`].")]
            pub fn from_csv_reader(reader: impl Read, units: Units) -> Result<$table> {
                $table::from_rows(read(reader, $layout, units)?)
            }
        }
    };
}

from_csv!(
    TabulatedCreep,
    CREEP,
    "time and creep compliance",
    "let text = \"# PMMA, 23 °C\\ntime [s], J [1/Pa]\\n10, 1.2e-9\\n1, 1.0e-9\\n100, 1.3e-9\\n3, 1.1e-9\\n\";"
);
from_csv!(
    TabulatedRelaxation,
    RELAXATION,
    "time and relaxation modulus",
    "let text = \"1; 4.0e6\\n3; 3.1e6\\n10; 2.4e6\\n30; 2.1e6\\n\";"
);
from_csv!(
    TabulatedDynamic,
    DYNAMIC,
    "angular frequency, storage modulus and loss modulus",
    "let text = \"omega,G',G''\\n0.1,1.0e6,2e5\\n1,1.5e6,4e5\\n10,2.2e6,4e5\\n100,2.5e6,1e5\\n\";"
);

fn read(mut reader: impl Read, layout: Layout, units: Units) -> Result<Vec<Row>> {
    positive("Units::abscissa", units.abscissa)?;
    positive("Units::value", units.value)?;
    let unreadable =
        |reason: String, kind| TableError::Unreadable { file: format!("{} table", layout.table), reason, kind };
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(|error| unreadable(error.to_string(), Some(error.kind())))?;
    if bytes.contains(&0) {
        return Err(unreadable("it is not a text file".into(), None).into());
    }
    // comments may be in any encoding, numbers are ASCII
    let text = String::from_utf8_lossy(&bytes);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text); // byte order mark of some spreadsheets
    let separator = separator(text);
    let mut records = records(text, separator);

    let names: Vec<_> = iter::once(layout.abscissa).chain(layout.columns.iter().map(|&(name, _)| name)).collect();
    // the headings determine the number of columns; without headings there are only those needed
    let (mut order, mut width, mut named) = ((0..names.len()).collect::<Vec<_>>(), names.len(), false);
    if let Some(Record { line, fields, .. }) = records.first_mut() {
        drop_empty(fields, width);
        if !fields.iter().any(|field| resembles(field)) {
            width = fields.len();
            check_width(*line, fields, names.len(), width, &names)?;
            if let Some(columns) = columns(*line, fields, &names)? {
                (order, named) = (columns, true);
            }
            check_units(*line, fields, &order, &layout, units)?;
            records.remove(0);
        } else if fields.len() > width
            && let Some(column) = fields.iter().position(|field| resembles(field) && !plain(field))
        {
            // this entry is neither a heading nor a number like the others
            let text = shortened(&fields[column]);
            return Err(TableError::NotNumeric { line: *line, column: column + 1, text }.into());
        }
    }
    if let [Record { line, raw, .. }, ..] = &records[..]
        && separator == ','
        && width == 2
        && !named
        && records.iter().all(|record| one_decimal(record.raw))
    {
        let readings = "two columns or a number with a decimal comma: name the columns in a first line, or separate them by semicolons";
        return Err(TableError::Ambiguous { line: *line, column: 1, text: shortened(raw.trim()), readings }.into());
    }
    let (mut rows, mut numbers) = (Vec::with_capacity(records.len()), Numbers::default());
    for Record { line, mut fields, .. } in records {
        drop_empty(&mut fields, width);
        check_width(line, &fields, width, width, &names)?;
        let mut number = |column: usize| numbers.read(line, column + 1, &fields[column]);
        let x = number(order[0])? * units.abscissa;
        let values = order[1..].iter().map(|&column| Ok(number(column)? * units.value)).collect::<Result<_>>()?;
        rows.push(Row { place: Place::Line(line), x, values });
    }
    numbers.finish()?;
    Ok(rows)
}

/// Drops empty fields beyond `width`, left by separators at the end of a line.
fn drop_empty(fields: &mut Vec<String>, width: usize) {
    while fields.len() > width && fields.last().is_some_and(String::is_empty) {
        fields.pop();
    }
}

/// Rejects a row of fewer fields than `least`, or more than `most`.
fn check_width(line: u64, fields: &[String], least: usize, most: usize, names: &[&str]) -> Result<()> {
    if (least..=most).contains(&fields.len()) {
        return Ok(());
    }
    Err(TableError::Columns { line, found: fields.len(), expected: least, columns: names.join(", ") }.into())
}
