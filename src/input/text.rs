//! Tables in text files: lines, delimiters, quotes and numbers.

use std::borrow::Cow;
use std::io::Read;

use crate::error::{Error, FileError, Result, TextError};

value! {
/// How a text file separates its fields and writes its numbers.
///
/// Fields that contain the delimiter or a line end are quoted. Numbers have an exponent with `e`, or with `d` as in
/// Fortran, and no separators of thousands. Empty lines and lines that start with `#` are skipped.
///
/// ```
/// use viscocontact::rheology::{Experiment, Measurements, Units};
/// use viscocontact::{Delimiter, TextFormat};
///
/// let text = "t J\n0,5 1,0e-9\n1,5 1,1e-9\n5 1,2e-9\n15 1,3e-9\n";
/// let format = TextFormat::default().with_delimiter(Delimiter::Blanks).with_decimal_comma(true);
/// let body = Measurements::from_csv_reader(Experiment::Creep, text.as_bytes(), Units::SI, format)?.fit()?;
/// assert_eq!(body.report().samples()[0].x, 0.5);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TextFormat {
    /// What separates the fields of a line.
    delimiter: Delimiter, with_delimiter;
    /// Whether numbers have a decimal comma, or else a decimal point.
    decimal_comma: bool, with_decimal_comma;
}
}

/// What separates the fields of a line of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Delimiter {
    /// The first of semicolon, tab and comma that the first line contains outside quotes, else blanks. With
    /// [`TextFormat::decimal_comma`] the comma is not looked for.
    #[default]
    FirstLine,
    /// A comma.
    Comma,
    /// A semicolon.
    Semicolon,
    /// A tab.
    Tab,
    /// Any number of blanks and tabs.
    Blanks,
}

impl Delimiter {
    /// The characters, and their name for errors.
    fn marks(self) -> (&'static [char], &'static str) {
        match self {
            Delimiter::Comma => (&[','], "commas"),
            Delimiter::Semicolon => (&[';'], "semicolons"),
            Delimiter::Tab => (&['\t'], "tabs"),
            Delimiter::Blanks | Delimiter::FirstLine => (&[' ', '\t'], "blanks"),
        }
    }
}

/// A text, with line ends of one character, and its format.
#[derive(Debug)]
pub(crate) struct TextTable {
    text: String,
    /// With the delimiter of the first line, if none was stated.
    format: TextFormat,
}

impl TextTable {
    /// Reads a text whose `name` stands for the file in errors. Comments may be in any encoding; numbers are ASCII.
    pub(crate) fn read(reader: impl Read, name: &str, mut format: TextFormat) -> Result<TextTable> {
        let bytes = super::bytes(reader, name)?;
        if bytes.contains(&0) {
            return Err(Error::File(FileError::Unreadable {
                file: name.into(),
                reason: "it is not a text file".into(),
                kind: None,
            }));
        }
        let text = String::from_utf8_lossy(&bytes);
        // byte order mark of some spreadsheets
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text).replace("\r\n", "\n").replace('\r', "\n");
        if format.delimiter == Delimiter::FirstLine {
            let first = text.lines().find(|line| !line.trim().is_empty() && !is_comment(line)).unwrap_or_default();
            // every other piece is quoted
            let unquoted: String = first.split('"').step_by(2).collect();
            let marks = [Delimiter::Semicolon, Delimiter::Tab, Delimiter::Comma];
            let found =
                marks[..if format.decimal_comma { 2 } else { 3 }].iter().find(|mark| unquoted.contains(mark.marks().0));
            format.delimiter = *found.unwrap_or(&Delimiter::Blanks);
        }
        Ok(TextTable { text, format })
    }

    /// The lines that are neither empty nor comments.
    pub(crate) fn rows(&self) -> TextRows<'_> {
        TextRows { rest: &self.text, line: 1, format: self.format }
    }
}

fn is_comment(line: &str) -> bool {
    line.trim_start_matches([' ', '\t', '"']).starts_with('#')
}

/// Iterates over the rows of a text.
#[derive(Debug, Clone)]
pub(crate) struct TextRows<'a> {
    rest: &'a str,
    line: u64,
    format: TextFormat,
}

impl<'a> Iterator for TextRows<'a> {
    type Item = TextRow<'a>;

    fn next(&mut self) -> Option<TextRow<'a>> {
        while !self.rest.is_empty() {
            let (from, line, format) = (self.rest, self.line, self.format);
            let (marks, blanks) = (format.delimiter.marks().0, format.delimiter == Delimiter::Blanks);
            let mut fields = Vec::new();
            let mut rest = from;
            if is_comment(from) {
                rest = &from[from.find('\n').unwrap_or(from.len())..];
            } else {
                loop {
                    let (field, after) = field(rest, marks);
                    if !blanks || !field.is_empty() {
                        fields.push(field);
                    }
                    let Some(next) = after.strip_prefix(marks) else {
                        rest = after;
                        break;
                    };
                    rest = next;
                }
            }
            self.rest = rest.strip_prefix('\n').unwrap_or(rest);
            self.line += from[..from.len() - self.rest.len()].matches('\n').count() as u64;
            if fields.len() > 1 || fields.first().is_some_and(|field| !field.is_empty()) {
                return Some(TextRow { line, fields, format });
            }
        }
        None
    }
}

/// The field at the beginning of `text`, without blanks and quotes around it, and the rest of the text: it begins with
/// one of the `marks` or a line end, or is empty. A quote that is not closed, or not followed by a mark, is part of its
/// field.
fn field<'a>(text: &'a str, marks: &[char]) -> (Cow<'a, str>, &'a str) {
    let ends = |c: char| c == '\n' || marks.contains(&c);
    let blank = |c: char| " \t".contains(c) && !ends(c);
    if let Some(quoted) = text.trim_start_matches(blank).strip_prefix('"') {
        // quotes within a field are doubled
        let mut from = 0;
        while let Some(quote) = quoted[from..].find('"').map(|at| from + at) {
            let after = &quoted[quote + 1..];
            if after.starts_with('"') {
                from = quote + 2;
                continue;
            }
            let after = after.trim_start_matches(blank);
            if after.is_empty() || after.starts_with(ends) {
                return (quoted[..quote].trim().replace("\"\"", "\"").into(), after);
            }
            break;
        }
    }
    let end = text.find(ends).unwrap_or(text.len());
    (text[..end].trim().into(), &text[end..])
}

/// A line of a text, or several with a quoted line end.
#[derive(Debug)]
pub(crate) struct TextRow<'a> {
    /// Number of the line in which it begins, from 1.
    pub(crate) line: u64,
    /// Without surrounding blanks and quotes.
    pub(crate) fields: Vec<Cow<'a, str>>,
    format: TextFormat,
}

impl TextRow<'_> {
    /// Accepts rows of `expected` fields, whose `columns` the error names.
    pub(crate) fn check_width(&self, expected: usize, columns: &str) -> Result<(), TextError> {
        let (line, found) = (self.line, self.fields.len());
        if found == expected {
            return Ok(());
        }
        let delimiter = self.format.delimiter.marks().1;
        Err(TextError::Columns { line, found, expected, columns: columns.into(), delimiter })
    }

    /// The number in a field.
    pub(crate) fn number(&self, column: usize) -> Result<f64, TextError> {
        let (field, decimal_comma) = (&*self.fields[column], self.format.decimal_comma);
        number(field, decimal_comma).ok_or_else(|| match number(field, !decimal_comma) {
            Some(_) => {
                TextError::DecimalMark { line: self.line, column: column + 1, text: shortened(field), decimal_comma }
            }
            None => self.not_numeric(column),
        })
    }

    /// The error of a field that is not a number.
    pub(crate) fn not_numeric(&self, column: usize) -> TextError {
        TextError::NotNumeric { line: self.line, column: column + 1, text: shortened(&self.fields[column]) }
    }

    /// Whether a field is a number with a decimal point or a decimal comma.
    pub(crate) fn has_numbers(&self) -> bool {
        self.fields.iter().any(|field| number(field, false).or(number(field, true)).is_some())
    }
}

fn number(text: &str, decimal_comma: bool) -> Option<f64> {
    let text = match decimal_comma {
        true if text.contains('.') => return None,
        true => Cow::Owned(text.replace(',', ".")),
        false => Cow::Borrowed(text),
    };
    text.parse().ok().or_else(|| text.replace(['d', 'D'], "e").parse().ok())
}

/// A text, shortened for errors.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    if text.chars().count() <= MOST { text.to_owned() } else { text.chars().take(MOST).chain("…".chars()).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str, format: TextFormat) -> Vec<(u64, Vec<String>)> {
        let table = TextTable::read(text.as_bytes(), "text", format).unwrap();
        table.rows().map(|row| (row.line, row.fields.into_iter().map(Cow::into_owned).collect())).collect()
    }

    fn row(line: u64, fields: &[&str]) -> (u64, Vec<String>) {
        (line, fields.iter().map(|&field| field.to_owned()).collect())
    }

    #[test]
    fn rows_are_split_into_fields() {
        let [comma, blanks] =
            [Delimiter::Comma, Delimiter::Blanks].map(|mark| TextFormat::default().with_delimiter(mark));
        assert_eq!(
            rows("# a, \"b\r\n\r\n 1 , 2\r\n\"x, \"\"y\"\"\" ,\r\r3,\"4\n5\"\n,,\n6", comma),
            [
                row(3, &["1", "2"]),
                row(4, &["x, \"y\"", ""]),
                row(6, &["3", "4\n5"]),
                row(8, &["", "", ""]),
                row(9, &["6"])
            ]
        );
        assert_eq!(rows("  1   \t2 \n 3 4\n \"# a\" \n \t \n", blanks), [row(1, &["1", "2"]), row(2, &["3", "4"])]);
        // quotes that enclose no field
        assert_eq!(
            rows("1,\"2\n3,G\"H\n\"4\"5,6\n", comma),
            [row(1, &["1", "\"2"]), row(2, &["3", "G\"H"]), row(3, &["\"4\"5", "6"])]
        );
    }

    #[test]
    fn delimiters_of_the_first_line_are_found() {
        for (text, decimal_comma, delimiter) in [
            ("t;J\n1,5;2,5\n", true, Delimiter::Semicolon),
            ("t, s\tJ\n1,5\t2,5\n", true, Delimiter::Tab),
            ("# a;b\n\nt,J\n1;2\n", false, Delimiter::Comma),
            ("1,5 2,5\n", false, Delimiter::Comma),
            ("1,5 2,5\n", true, Delimiter::Blanks),
            ("1 2\n3 4\n", false, Delimiter::Blanks),
            ("\"a;b\",\"c;d\"\n", false, Delimiter::Comma),
            ("", false, Delimiter::Blanks),
        ] {
            let format = TextFormat::default().with_decimal_comma(decimal_comma);
            let table = TextTable::read(text.as_bytes(), "text", format).unwrap();
            assert_eq!(table.format.delimiter, delimiter, "{text:?}");
        }
    }

    #[test]
    fn numbers_are_read_in_every_notation() {
        let texts =
            [("1", 1.0), ("-1.5", -1.5), (".5", 0.5), ("+1e3", 1e3), ("1.D0", 1.0), ("2d-3", 2e-3), ("1.5D+02", 150.0)];
        for (text, value) in texts {
            assert_eq!(number(text, false), Some(value), "{text}");
            assert_eq!(number(&text.replace('.', ","), true), Some(value), "{text}");
        }
        for text in ["", "<1", "1.5.2", "1,000.5", "1 000", "1e", "d5", "1d5d5", "1D", "O.5", "--1", "1e5.0"] {
            assert_eq!(number(text, false), None, "{text}");
            assert_eq!(number(text, true), None, "{text}");
            assert_eq!(number(&text.replace('.', ","), true), None, "{text}");
        }
    }

    #[test]
    fn the_other_decimal_mark_is_an_error_that_names_the_option() {
        for (text, decimal_comma) in [("1,5;1,000", false), ("1.5;1.000", true)] {
            let table =
                TextTable::read(text.as_bytes(), "text", TextFormat::default().with_decimal_comma(decimal_comma));
            let (table, mark) = (table.unwrap(), if decimal_comma { "1.000" } else { "1,000" });
            let error = table.rows().next().unwrap().number(1).unwrap_err();
            assert_eq!(error, TextError::DecimalMark { line: 1, column: 2, text: mark.into(), decimal_comma });
            assert!(error.to_string().contains(&format!("decimal_comma = {decimal_comma}")), "{error}");
        }
    }
}
