//! Tables of measured data from CSV files.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use ::csv::{ByteRecord, ReaderBuilder, StringRecord, Trim};

use crate::error::{Result, positive};
use crate::rheology::table::data::{CREEP, DYNAMIC, Layout, RELAXATION, Row};
use crate::rheology::table::{Place, TableError, TabulatedCreep, TabulatedDynamic, TabulatedRelaxation};

/// What one unit of a file is in SI.
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
            /// their first word or symbol, whatever the case and the unit behind it); without headings, or with
            /// headings that say nothing, they are taken in the order above. Values are separated by commas,
            /// semicolons, tabs or blanks; lines that start with `#` and empty lines are skipped.
            ///
            /// # Errors
            /// If the file cannot be read, a line has too few columns or something that is not a number, each told
            /// with its line, or the data cannot be fitted.
            pub fn from_csv(path: impl AsRef<Path>, units: Units) -> Result<$table> {
                let path = path.as_ref();
                let unreadable = |error: std::io::Error| TableError::Unreadable {
                    file: path.display().to_string(),
                    reason: error.to_string(),
                };
                $table::from_csv_reader(File::open(path).map_err(unreadable)?, units)
            }

            #[doc = concat!("[`", stringify!($table), "::from_csv`] from anything that can be read.")]
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

/// First words of headings, lower case.
const ABSCISSA: &[&str] = &["time", "t", "omega", "ω", "angular", "frequency", "freq", "f", "w"];
const CREEP_WORDS: &[&str] = &["j", "creep", "compliance"];
const RELAXATION_WORDS: &[&str] = &["g", "e", "relaxation", "modulus"];
const STORAGE_WORDS: &[&str] = &["g'", "g′", "e'", "e′", "storage", "gp"];
const LOSS_WORDS: &[&str] = &["g''", "g″", "g\"", "e''", "e″", "e\"", "loss", "gpp"];

/// What a heading of something else says.
const OTHERS: &[&str] = &["factor", "tan", "strain", "stress", "phase", "%"];

fn words(column: &str) -> &'static [&'static str] {
    match column {
        "creep compliance" => CREEP_WORDS,
        "relaxation modulus" => RELAXATION_WORDS,
        "storage modulus" => STORAGE_WORDS,
        "loss modulus" => LOSS_WORDS,
        _ => ABSCISSA,
    }
}

fn read(mut reader: impl Read, layout: Layout, units: Units) -> Result<Vec<Row>> {
    positive("Units::abscissa", units.abscissa)?;
    positive("Units::value", units.value)?;
    let unreadable = |reason: String| TableError::Unreadable { file: format!("{} table", layout.table), reason };
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(|error| unreadable(error.to_string()))?;
    if bytes.contains(&0) {
        return Err(unreadable("it is not a text file".into()).into());
    }
    // remarks may be in any encoding, numbers are not
    let text = String::from_utf8_lossy(&bytes);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text); // some spreadsheets mark UTF-8 so
    let mark = delimiter(text);
    let mut lines = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(Trim::All)
        .delimiter(mark)
        .from_reader(text.as_bytes());

    let names: Vec<&'static str> =
        std::iter::once(layout.abscissa).chain(layout.columns.iter().map(|&(name, _)| name)).collect();
    let mut order: Vec<usize> = (0..names.len()).collect();
    let (mut rows, mut width, mut record) = (Vec::new(), None, ByteRecord::new());
    while lines.read_byte_record(&mut record).map_err(|error| unreadable(error.to_string()))? {
        let line = record.position().map_or(0, ::csv::Position::line);
        let record = StringRecord::from_byte_record_lossy(std::mem::take(&mut record));
        // blanks in a row separate nothing
        let mut fields: Vec<&str> = record.iter().filter(|field| !field.is_empty() || mark != b' ').collect();
        while fields.last().is_some_and(|field| field.is_empty()) {
            fields.pop(); // a separator at the end of a line
        }
        if fields.is_empty() || fields[0].starts_with('#') {
            continue;
        }
        let headings = width.is_none() && fields.iter().all(|field| field.parse::<f64>().is_err());
        // a table is as wide as its headings, and without any it holds nothing but what is needed
        let expected = *width.get_or_insert(if headings { fields.len() } else { names.len() });
        if fields.len() != expected || expected < names.len() {
            let (expected, columns) = (expected.max(names.len()), names.join(", "));
            return Err(TableError::Columns { line, found: fields.len(), expected, columns }.into());
        }
        if headings {
            order = columns(line, &fields, &names)?;
            let heading = fields[order[0]];
            if heading.to_lowercase().contains("hz") && units.abscissa == 1.0 {
                return Err(TableError::Hertz { line, heading: heading.to_owned() }.into());
            }
            continue;
        }
        let number = |column: usize| -> Result<f64> {
            let text = fields[column];
            text.parse().map_err(|_| TableError::NotNumeric { line, column: column + 1, text: text.to_owned() }.into())
        };
        let x = number(order[0])? * units.abscissa;
        let values = order[1..].iter().map(|&column| Ok(number(column)? * units.value)).collect::<Result<_>>()?;
        rows.push(Row { place: Place::Line(line), x, values });
    }
    Ok(rows)
}

/// Which column holds what, from their headings; in the order of `names` if none of them says anything.
fn columns(line: u64, headings: &[&str], names: &[&'static str]) -> Result<Vec<usize>> {
    let meaning: Vec<Option<&'static str>> = headings
        .iter()
        .map(|heading| {
            let heading = heading.to_lowercase();
            if OTHERS.iter().any(|other| heading.contains(other)) {
                return None;
            }
            let word = heading.split(|c: char| " [(_/,;|*".contains(c)).next().unwrap_or_default();
            names.iter().copied().find(|name| words(name).contains(&word))
        })
        .collect();
    if meaning.iter().all(Option::is_none) && headings.len() == names.len() {
        return Ok((0..names.len()).collect());
    }
    let single = |&name: &&'static str| {
        let mut places = (0..headings.len()).filter(|&k| meaning[k] == Some(name));
        match (places.next(), places.next()) {
            (Some(place), None) => Ok(place),
            _ => Err(TableError::Heading { line, column: name, found: headings.join(", ") }.into()),
        }
    };
    names.iter().map(single).collect()
}

/// The separator of the first line of data: the one of these that it holds.
fn delimiter(text: &str) -> u8 {
    let data = || text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let numbers = data().find(|line| line.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)));
    let line = numbers.or_else(|| data().next()).unwrap_or_default();
    [b';', b'\t', b','].into_iter().find(|&mark| line.contains(char::from(mark))).unwrap_or(b' ')
}
