//! Lines of text files: delimiters, quotes, comments and numbers.

use std::borrow::Cow;
use std::io::Read;

use super::encoding::decoded;
use super::format::{Delimiter, TextFormat};
use super::number::{no_number, not_numeric, number};
use crate::error::{Error, Refusal, Result};

/// Most rows at the beginning and at the end of a text, and most fields, from which delimiter and decimal mark are
/// found out: the beginning may be a long preamble.
const ROWS: usize = 200;
const FIELDS: usize = 10_000;
/// Of delimiters that make nearly as many numbers as the best, the first is taken.
const NEARLY: f64 = 0.8;

/// A text, with line ends of one character, and how it is written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Text {
    text: String,
    /// Number of the first line that is read, from 1.
    line: u64,
    pub(super) encoding: &'static str,
    pub(super) dialect: Dialect,
}

/// How the fields of a text are separated and its numbers written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dialect {
    pub(super) delimiter: Delimiter,
    pub(super) decimal_comma: bool,
}

impl Text {
    /// Reads a text whose `name` stands for the file in errors.
    pub(crate) fn read(reader: impl Read, name: &str, format: TextFormat) -> Result<Text> {
        let bytes = super::bytes(reader, name)?;
        let not_a_text = || {
            let reason = "it is not a text file".into();
            Error::Unreadable { file: name.into(), reason, kind: None }
        };
        let (mut text, encoding) = decoded(&bytes).ok_or_else(not_a_text)?;
        if let Some(last) = format.skipped_lines.checked_sub(1) {
            let end = text.match_indices('\n').nth(usize::try_from(last).unwrap_or(usize::MAX));
            text.drain(..end.map_or(text.len(), |(at, _)| at + 1));
        }
        let dialect = Dialect { delimiter: format.delimiter, decimal_comma: format.decimal_comma == Some(true) };
        let text = Text { text, line: format.skipped_lines.saturating_add(1), encoding, dialect };
        Ok(Text { dialect: text.detected(format), ..text })
    }

    /// The dialect that makes the most numbers of the fields, among the dialects that `format` allows.
    fn detected(&self, format: TextFormat) -> Dialect {
        use Delimiter::{Blanks, Comma, Semicolon, Tab};
        let delimiters = match format.delimiter {
            Delimiter::Detected => vec![Semicolon, Tab, Comma, Blanks],
            stated => vec![stated],
        };
        let marks = format.decimal_comma.map_or(vec![false, true], |mark| vec![mark]);
        let of_mark = |delimiter: Delimiter| {
            let scored = marks.iter().map(|&decimal_comma| {
                let dialect = Dialect { delimiter, decimal_comma };
                (dialect, self.score(dialect, marks.len() > 1))
            });
            // points, if nothing speaks for commas
            scored.reduce(|points, commas| if commas.1 > points.1 { commas } else { points })
        };
        // without numbers, a mark of the first line; every other piece of it is quoted
        let first = self.text.lines().find(|line| !line.trim().is_empty() && !is_comment(line)).unwrap_or_default();
        let unquoted: String = first.split('"').step_by(2).collect();
        let is_in_first = |mark: &&Delimiter| unquoted.contains(mark.marks().0) && !(marks[0] && **mark == Comma);
        let in_first = delimiters.iter().find(is_in_first).or(delimiters.last()).copied();
        let scored: Vec<(Dialect, f64)> = delimiters.into_iter().filter_map(of_mark).collect();
        let most = scored.iter().fold(0.0, |most: f64, (_, score)| most.max(*score));
        let best = scored.iter().find(|(_, score)| *score > 0.0 && *score >= NEARLY * most);
        let none = Dialect { delimiter: in_first.unwrap_or(Delimiter::Blanks), decimal_comma: marks[0] };
        best.map_or(none, |best| best.0)
    }

    /// The sum over rows of the squared share of numbers among the fields; none, if decimal commas may separate
    /// thousands and it is not `stated` which they do.
    fn score(&self, dialect: Dialect, unstated: bool) -> f64 {
        let (mut score, mut unclear, mut seen) = (0.0, dialect.decimal_comma && unstated, 0);
        // commas do both only where numbers are quoted
        let mut both = dialect.decimal_comma && dialect.delimiter == Delimiter::Comma;
        let end = TextRows { rest: self.end(), line: 1, dialect }.take(ROWS);
        for row in self.rows_in(dialect).take(ROWS).chain(end).take_while(|row| {
            seen += row.fields.len();
            seen <= FIELDS + row.fields.len()
        }) {
            let fields = row.fields.iter().filter(|field| !field.is_empty());
            let numbers: Vec<_> =
                fields.clone().filter(|field| number(field, dialect.decimal_comma).is_some()).collect();
            // 234;5 is no word
            let is_torn =
                |field: &Cow<str>| field.contains([';', '\t']) && field.ends_with(|c: char| c.is_ascii_digit());
            if numbers.len() > 1 && !fields.clone().any(is_torn) {
                score += (numbers.len() as f64 / fields.count() as f64).powi(2);
                both &= !numbers.iter().any(|number| number.contains(','));
                unclear &= numbers.iter().all(|number| !number.contains(',') || are_thousands(number));
            }
        }
        if unclear || both { 0.0 } else { score }
    }

    /// The last lines of a text of many.
    fn end(&self) -> &str {
        let mut ends = self.text.rmatch_indices('\n').map(|(at, _)| at + 1);
        match ends.nth(ROWS) {
            Some(at) if ends.nth(ROWS).is_some() => &self.text[at..],
            _ => "",
        }
    }

    /// Whether the text ends in a row, where it may be cut off.
    pub(super) fn ends_in(&self, row: &TextRow) -> bool {
        !self.text.ends_with('\n') && self.rows().last().is_some_and(|last| last.line == row.line)
    }

    /// The lines that are neither empty nor comments.
    pub(crate) fn rows(&self) -> TextRows<'_> {
        self.rows_in(self.dialect)
    }

    fn rows_in(&self, dialect: Dialect) -> TextRows<'_> {
        TextRows { rest: &self.text, line: self.line, dialect }
    }

    /// The comments in lines before `line`, without their marks, and their lines.
    pub(super) fn comments_before(&self, line: u64) -> impl Iterator<Item = TextRow<'_>> {
        let numbered = (self.line..line).zip(self.text.lines()).filter(|(_, text)| is_comment(text));
        numbered.filter_map(|(line, text)| {
            let text = text.trim();
            let text = text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text);
            let rest = text.trim_start_matches(['#', '%', ' ', '\t']);
            TextRows { rest, line, dialect: self.dialect }.next()
        })
    }
}

/// Whether all commas of a number may separate thousands.
fn are_thousands(number: &str) -> bool {
    let mut groups = number.trim_start_matches(['-', '+']).split(',');
    groups.next().is_some_and(|first| (1..=3).contains(&first.len()) && first != "0")
        && groups.all(|group| group.len() == 3 && group.bytes().all(|digit| digit.is_ascii_digit()))
}

fn is_comment(line: &str) -> bool {
    line.trim_start_matches([' ', '\t', '"']).starts_with(['#', '%'])
}

/// Iterates over the rows of a text.
#[derive(Debug, Clone)]
pub(crate) struct TextRows<'a> {
    rest: &'a str,
    line: u64,
    dialect: Dialect,
}

impl<'a> Iterator for TextRows<'a> {
    type Item = TextRow<'a>;

    fn next(&mut self) -> Option<TextRow<'a>> {
        while !self.rest.is_empty() {
            let (from, line, dialect) = (self.rest, self.line, self.dialect);
            let (marks, blanks) = (dialect.delimiter.marks().0, dialect.delimiter == Delimiter::Blanks);
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
                return Some(TextRow { line, fields, dialect });
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
    // two words for one missing height
    let words = text.get(..7).filter(|words| ends(' ') && words.eq_ignore_ascii_case("no data")).map_or(0, str::len);
    let end = text[words..].find(ends).map_or(text.len(), |end| words + end);
    (text[..end].trim().into(), &text[end..])
}

/// A line of a text, or several with a quoted line end.
#[derive(Debug)]
pub(crate) struct TextRow<'a> {
    /// Number of the line in which it begins, from 1.
    pub(crate) line: u64,
    /// Without surrounding blanks and quotes.
    pub(crate) fields: Vec<Cow<'a, str>>,
    pub(super) dialect: Dialect,
}

impl TextRow<'_> {
    /// Accepts rows of `expected` fields, whose `columns` the error names.
    pub(crate) fn check_width(&self, expected: usize, columns: &str) -> Result<()> {
        let (line, found) = (self.line, self.fields.len());
        if found == expected {
            return Ok(());
        }
        let delimiter = self.dialect.delimiter.marks().1;
        let what =
            format!("line {line}: {found} columns separated by {delimiter}, but {expected} are needed ({columns})");
        let remedy = "; TextFormat::with_delimiter states another delimiter; if another table begins here, split the \
            file; of a row that is cut off, leave the line out by # at its beginning";
        Err(Refusal::file("text_columns", what, remedy).into())
    }

    /// The number in a field.
    pub(crate) fn number(&self, column: usize) -> Result<f64> {
        let (field, decimal_comma) = (&*self.fields[column], self.dialect.decimal_comma);
        number(field, decimal_comma).ok_or_else(|| match number(field, !decimal_comma) {
            Some(_) => {
                let found = no_number(self.line, column, field);
                let what = format!("{found} with TextFormat::with_decimal_comma = {decimal_comma}");
                let remedy = ": state the other value, or remove separators of thousands";
                Refusal::file("text_decimal_mark", what, remedy).into()
            }
            None => self.not_numeric(column),
        })
    }

    /// The error of a field that is not a number.
    pub(crate) fn not_numeric(&self, column: usize) -> Error {
        not_numeric(self.line, column, &self.fields[column])
    }

    /// Whether a field is a number with a decimal point or a decimal comma.
    pub(crate) fn is_number(&self, column: usize) -> bool {
        self.fields.get(column).is_some_and(|field| number(field, false).or(number(field, true)).is_some())
    }

    /// Number of fields that are numbers.
    pub(crate) fn numbers(&self) -> usize {
        (0..self.fields.len()).filter(|&column| self.is_number(column)).count()
    }

    /// Whether it has delimiters alone.
    pub(super) fn is_empty(&self) -> bool {
        self.fields.iter().all(|field| field.is_empty())
    }

    /// Whether blanks separate its fields, which say nothing of empty ones.
    pub(super) fn is_by_blanks(&self) -> bool {
        self.dialect.delimiter == Delimiter::Blanks
    }

    /// Drops empty fields beyond `width`, left by delimiters at the end of a line.
    pub(crate) fn drop_empty(&mut self, width: usize) {
        while self.fields.len() > width && self.fields.last().is_some_and(|field| field.is_empty()) {
            self.fields.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str, format: TextFormat) -> Vec<(u64, Vec<String>)> {
        let table = Text::read(text.as_bytes(), "text", format).unwrap();
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
    fn delimiter_and_decimal_mark_are_found() {
        use Delimiter::{Blanks, Comma, Semicolon, Tab};
        for (text, delimiter, decimal_comma) in [
            ("t;J\n1,5;2,5\n", Semicolon, true),
            ("t, s\tJ\n1,5\t2,5\n", Tab, true),
            ("# a;b\n\nt,J\n1,2\n", Comma, false),
            ("1,5 2,5\n", Blanks, true),
            ("1,5\n2,5\n", Comma, false),
            ("1 2\n3 4\n", Blanks, false),
            ("\"a;b\",\"c;d\"\n1,2\n", Comma, false),
            ("\"0,1\",\"2,5\"\n", Comma, true),
            ("k: 1;2;3;4\nt,J\n1,2\n2,3\n", Comma, false),
            ("Load;1,5;2,5\nHold;2;3\n", Semicolon, true),
            // thousands, or decimals
            ("1,234;5,678\n", Semicolon, false),
            ("1,234;0,678\n", Semicolon, true),
            ("", Blanks, false),
        ] {
            let table = Text::read(text.as_bytes(), "text", TextFormat::default()).unwrap();
            assert_eq!(table.dialect, Dialect { delimiter, decimal_comma }, "{text:?}");
        }
    }

    #[test]
    fn lines_are_skipped_and_counted() {
        let text = "1;2;3\n\n4,5\n6,7\n";
        let read = Text::read(text.as_bytes(), "text", TextFormat::default().with_skipped_lines(1)).unwrap();
        assert_eq!(read.rows().map(|row| row.line).collect::<Vec<_>>(), [3, 4]);
        assert_eq!(read.rows().next().unwrap().fields, ["4", "5"]);
        let none = Text::read(text.as_bytes(), "text", TextFormat::default().with_skipped_lines(9)).unwrap();
        assert_eq!(none.rows().count(), 0);
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
            let table = Text::read(text.as_bytes(), "text", TextFormat::default().with_decimal_comma(decimal_comma));
            let (table, mark) = (table.unwrap(), if decimal_comma { "1.000" } else { "1,000" });
            let error = table.rows().next().unwrap().number(1).unwrap_err();
            assert_eq!(error.code(), "text_decimal_mark");
            assert!(error.to_string().starts_with(&format!("line 1, column 2: {mark:?} is not")), "{error}");
            assert!(error.to_string().contains(&format!("decimal_comma = {decimal_comma}")), "{error}");
        }
    }
}
