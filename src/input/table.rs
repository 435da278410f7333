//! Tables in text files: where they begin, and their headings.

use std::fmt;
use std::io::Read;
use std::path::Path;

use super::format::TextFormat;
use super::heading::is_at;
use super::lines::{Text, TextRow};
use super::number::shortened;
use super::sections::{ROWS_OF_NUMBERS, Section, are_numbers, are_units, headings, merged, sections, with_units};
use super::unit::{Quantity, readings};
use crate::error::{Error, Refusal, Result};

/// Rows among which the first row of numbers is looked for, before eight times as many are read.
const SEARCHED: usize = 1000;

/// A table in a text file, as it was understood: print it to see how.
///
/// The table begins with the first rows that have numbers in the same two columns. The row above them has the
/// headings, if none of its fields is a number; a row of units may stand between the two: short words, of which one at
/// least is a unit that is known. All rows from there on belong to the table; where its headings and units are
/// repeated, as in files of several steps or intervals, a section begins that is joined to it. Where a section has
/// others, one is to be chosen ([`TextTable::section`]). Lines before the headings are not read. Without a row of
/// headings, the last comment before the numbers may have them, one for each column, as NumPy writes them; or comments
/// that begin with `columns:` and `units:`.
///
/// ```
/// use viscocontact::rheology::{Experiment, Measurements, Units};
/// use viscocontact::{TextFormat, input::TextTable};
///
/// let text = "Filename\tsweep.tri\n[step]\nAngular frequency\tStorage modulus\tLoss modulus\tTan(delta)\n\
///     rad/s\tMPa\tkPa\t\n0.1\t1.50\t20\t0.013\n1\t1.52\t150\t0.099\n10\t2.25\t750\t0.33\n100\t2.98\t150\t0.05\n";
/// let table = TextTable::read(text.as_bytes(), TextFormat::default())?;
/// println!("{table}");
/// assert_eq!(table.headings()[2], "Loss modulus [kPa]");
/// let measured = Measurements::from_table(Experiment::Dynamic, &table, Units::OF_HEADINGS)?;
/// for column in measured.columns() {
///     println!("{column}"); // what was taken for what
/// }
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct TextTable {
    pub(super) text: Text,
    /// Each with the unit of the row below it in brackets; none, if there is no row of headings.
    pub(super) headings: Vec<String>,
    /// The line of the headings, or of the first row of numbers.
    pub(super) line: u64,
    /// In the order of the file; rows are read of those with the headings of the first.
    sections: Vec<Section>,
    /// Whether the headings are a comment, which may say something else.
    commented: bool,
}

debug_by! { self: TextTable => headings: self.headings, line: self.line, first: self.sections[0].first }

impl TextTable {
    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read or is no text ([`Error::Unreadable`]), or has numbers before its
    /// headings.
    pub fn open(path: impl AsRef<Path>, format: TextFormat) -> Result<TextTable> {
        let path = path.as_ref();
        TextTable::named(crate::file::open(path)?, &path.display().to_string(), format)
    }

    /// [`TextTable::open`] from any reader.
    ///
    /// # Errors
    /// As [`TextTable::open`].
    pub fn read(reader: impl Read, format: TextFormat) -> Result<TextTable> {
        TextTable::named(reader, "text file", format)
    }

    pub(crate) fn named(reader: impl Read, name: &str, format: TextFormat) -> Result<TextTable> {
        let text = Text::read(reader, name, format)?;
        let (rows, start) = beginning(&text);
        let (above, from) = rows.split_at(start);
        let width = from.first().map_or(0, |row| row.fields.len());
        let above_all = above.len().saturating_sub(2);
        let (before, names, units) = match above {
            [.., names, units]
                if names.numbers() == 0 && names.fields.len() >= units.fields.len() && are_units(units) =>
            {
                (&above[..above_all], Some(names), Some(units))
            }
            [before @ .., names] if names.numbers() == 0 => (before, Some(names), None),
            _ => (above, None, None),
        };
        if let Some(row) = before.iter().find(|row| row.fields.len() > 1 && row.numbers() == row.fields.len()) {
            let (line, headings) = (row.line, names.map_or(row.line, |names| names.line));
            let what = format!("line {line} has numbers, but the headings stand in line {headings}");
            let remedy = ": skip the lines before it (TextFormat::with_skipped_lines), or split the file";
            return Err(Refusal::file("text_preamble", what, remedy).into());
        }
        let first = from.first().map_or(u64::MAX, |row| row.line);
        let mut commented = false;
        let (headings, line) = match names {
            Some(names) => (headings(names, units, from.first()), names.line),
            None => {
                let (mut names, mut units) = (None, None);
                for row in text.comments_before(first) {
                    match row.fields[0].to_lowercase().as_str() {
                        "columns:" => names = Some((merged(&row, width).split_off(1), false, row.line)),
                        "units:" => units = Some(merged(&row, width).split_off(1)),
                        _ if names.as_ref().is_none_or(|names| names.1) => {
                            names = Some((merged(&row, width), true, row.line))
                        }
                        _ => {}
                    }
                }
                let none = (Vec::new(), false, if from.is_empty() { 1 } else { first });
                let (names, in_remark, line) =
                    names.filter(|names| names.0.len() == width && width > 1).unwrap_or(none);
                commented = in_remark;
                (with_units(names, units), line)
            }
        };
        let all = Section { headings: headings.clone(), line, first, end: u64::MAX };
        let sections = names.map_or_else(|| vec![all.clone()], |names| sections(&text, names, all.clone()));
        Ok(TextTable { headings, line, sections, commented, text })
    }

    /// The headings, with units of a row of their own in brackets; none, if there is no row of headings.
    pub fn headings(&self) -> &[String] {
        &self.headings
    }

    /// The same without headings that are a comment: it may say something else.
    pub(crate) fn without_comment(&self) -> Option<TextTable> {
        let line = self.sections[0].first;
        self.commented.then(|| TextTable { headings: Vec::new(), line, commented: false, ..self.clone() })
    }

    /// The same with another heading of a column, counted from 1: with a unit in brackets, `z [nm]`. An empty heading
    /// takes the column out of the choice.
    ///
    /// # Errors
    /// If there is no such column.
    pub fn with_heading(mut self, column: usize, heading: &str) -> Result<TextTable> {
        if self.headings.is_empty() {
            let width = self.data().next().map_or(0, |row| row.fields.len());
            self.headings = vec![String::new(); width];
        }
        let none = self.no_column(column);
        let place = column.checked_sub(1).and_then(|place| self.headings.get_mut(place));
        *place.ok_or(none)? = heading.to_owned();
        self.commented = false;
        Ok(self)
    }

    /// The same with these headings only: the other columns are taken out of the choice. A name is a heading, or its
    /// beginning before the unit.
    ///
    /// # Errors
    /// If there is no such heading.
    pub fn only(mut self, names: &[&str]) -> Result<TextTable> {
        let is_named = |heading: &str, name: &str| {
            let rest = heading.strip_prefix(name);
            rest.is_some_and(|rest| rest.is_empty() || rest.trim_start().starts_with(['[', '(', '{', '/']))
        };
        if let Some(name) = names.iter().find(|name| !self.headings.iter().any(|heading| is_named(heading, name))) {
            return Err(self.no_column(name));
        }
        for heading in &mut self.headings {
            if !names.iter().any(|name| is_named(heading, name)) {
                heading.clear();
            }
        }
        Ok(self)
    }

    /// The error of a column that is not there, by its name or number.
    fn no_column(&self, column: impl fmt::Display) -> Error {
        let what = format!("there is no column {column} (headings: {})", shortened(&self.headings.join(", ")));
        Refusal::file("text_no_column", what, "; give one of these, or its number from 1 on").into()
    }

    /// The same with one section alone, from 1 in the order of the file: one step or interval of an instrument.
    /// Headings that were given stay, unless the section has others than the first.
    ///
    /// # Errors
    /// If there is no such section.
    pub fn section(mut self, number: usize) -> Result<TextTable> {
        let sections = self.sections.len();
        if !(1..=sections).contains(&number) {
            let remedy = format!(": give one from 1 to {sections}");
            return Err(Refusal::file("text_no_section", format!("there is no section {number}"), &remedy).into());
        }
        let own = self.sections[number - 1].clone();
        if own.headings != self.sections[0].headings {
            self.headings.clone_from(&own.headings);
        }
        Ok(TextTable { line: own.line, sections: vec![own], ..self })
    }

    /// The first section with other headings than the first of all.
    pub(super) fn other(&self) -> Option<&Section> {
        self.sections.iter().find(|section| section.headings != self.sections[0].headings)
    }

    /// The rows of the table.
    pub(super) fn data(&self) -> impl Iterator<Item = TextRow<'_>> {
        let is_own = |section: &&Section| section.headings == self.sections[0].headings;
        let mut sections = self.sections.iter().filter(is_own).peekable();
        self.text.rows().filter(move |row| {
            while sections.next_if(|section| section.end <= row.line).is_some() {}
            sections.peek().is_some_and(|section| section.first <= row.line) && !row.is_empty()
        })
    }

    /// What the headings look like, if this explains that a column of a quantity was not found.
    pub(super) fn looks_like(&self, quantity: Quantity) -> String {
        let are_units = self.headings.iter().any(|heading| !readings(heading).is_empty());
        let looks = if are_units { format!("; line {} looks like units", self.line) } else { String::new() };
        let choose = |other: &Section| format!("; line {} has others: choose by TextTable::section", other.line);
        let looks = looks + &self.other().map_or(String::new(), choose);
        if self.headings.iter().any(|heading| is_at(heading, quantity)) {
            return looks
                + "; some have it in brackets: write it in a column of its own, and a row for each of its values";
        }
        looks
    }
}

/// The rows up to the first of numbers and some more, and its index.
fn beginning(text: &Text) -> (Vec<TextRow<'_>>, usize) {
    let mut searched = SEARCHED;
    loop {
        let mut rows: Vec<TextRow> = text.rows().filter(|row| !row.is_empty()).take(searched).collect();
        rows.iter_mut().for_each(|row| row.drop_empty(1));
        if let Some(start) = first_of_numbers(&rows, rows.len() < searched) {
            return (rows, start);
        }
        searched *= 8;
    }
}

/// Index of the first row of numbers, if it is among these rows or they are all.
fn first_of_numbers(rows: &[TextRow], are_all: bool) -> Option<usize> {
    let begins = |from: usize| {
        (are_all || rows.len() >= from + ROWS_OF_NUMBERS) && are_numbers(&rows[from..]) && !are_units(&rows[from])
    };
    let numbers = |row: &TextRow| row.numbers() > 0 && !are_units(row);
    let found = (0..rows.len()).find(|&from| begins(from));
    let found = found.or_else(|| rows.iter().position(numbers).filter(|_| are_all));
    // a row with a number just before is one of the table, with a fault
    let Some(mut start) = found else { return are_all.then(|| rows.len().min(1)) };
    while start > 0 && numbers(&rows[start - 1]) {
        start -= 1;
    }
    Some(start)
}

impl fmt::Display for TextTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (dialect, rows) = (self.text.dialect, self.data().count());
        let mark = if dialect.decimal_comma { "commas" } else { "points" };
        write!(
            f,
            "{rows} rows, separated by {}, with decimal {mark}, in {}",
            dialect.delimiter.marks().1,
            self.text.encoding
        )?;
        if self.sections.len() > 1 {
            let (count, lines) =
                (self.sections.len(), self.sections[1..].iter().map(|section| section.line.to_string()));
            let lines = lines.collect::<Vec<_>>().join(", ");
            match self.other() {
                None => write!(f, ", {count} sections with the same headings joined (new ones from lines {lines})")?,
                Some(_) => write!(f, ", {count} sections with different headings, to be chosen from (lines {lines})")?,
            }
        }
        if self.headings.is_empty() {
            return write!(f, ", without headings");
        }
        write!(f, "; headings in line {}: {}", self.line, numbered(self.headings.iter().enumerate()))
    }
}

/// Columns by number, from 1, and heading.
pub(super) fn numbered<'a>(headings: impl Iterator<Item = (usize, &'a String)>) -> String {
    headings.map(|(place, heading)| format!("{} {heading:?}", place + 1)).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::WantedColumn;

    const TIME: WantedColumn =
        WantedColumn { name: "time", words: &["t", "time"], others: &[], quantity: Quantity::TIME, by_unit: true };

    fn read(text: &str) -> TextTable {
        TextTable::read(text.as_bytes(), TextFormat::default()).unwrap()
    }

    #[test]
    fn headings_are_found() {
        for (text, headings, line) in [
            ("a: 1\n\nt;J\n1;2\n3;4\n", &["t", "J"][..], 3),
            ("Probe\tA\t7\nt\tJ\ns\t1/GPa\n1\t2\n3\t4\n", &["t [s]", "J [1/GPa]"], 2),
            ("# t [s] J [1/GPa]\n1 2\n3 4\n", &["t [s]", "J [1/GPa]"], 1),
            ("# by hand\n# columns: t J\n# units: s 1/GPa\n# 7 8\n1 2\n3 4\n", &["t [s]", "J [1/GPa]"], 2),
            ("# made today\n1 2\n3 4\n", &["made", "today"], 1),
            ("creep\n1,2\n3,4\n", &["creep"], 1),
            ("1,2\n3,4\n", &[], 1),
        ] {
            let table = read(text);
            assert_eq!(
                (table.headings(), table.line),
                (&headings.iter().map(|h| (*h).to_owned()).collect::<Vec<_>>()[..], line),
                "{text:?}"
            );
        }
        let two = TextTable::read(&b"1;2\n3;4\nt;J\n1;2\n3;4\n5;6\n"[..], TextFormat::default());
        let numbers = |line| format!("line {line} has numbers, but the headings stand in line 3: ");
        assert!(two.unwrap_err().to_string().starts_with(&numbers(1)));
        let before = TextTable::read(&b"Range;1;2\n7;8;9\nt;J;x\n1;2;3\n3;4;5\n5;6;7\n"[..], TextFormat::default());
        assert!(before.unwrap_err().to_string().starts_with(&numbers(2)));
    }

    #[test]
    fn columns_are_chosen() {
        let table = read("Time [s],Time [ms],F [N]\n1,7,2\n2,8,3\n3,9,4\n");
        assert_eq!(
            table.to_string(),
            "3 rows, separated by commas, with decimal points, in UTF-8; headings in line 1: 1 \"Time [s]\", 2 \"Time [ms]\", \
             3 \"F [N]\""
        );
        let error = table.find(&TIME).unwrap_err();
        assert!(error.to_string().contains("the time: 1 \"Time [s]\", 2 \"Time [ms]\""), "{error}");
        let index =
            |table: &TextTable| table.find(&TIME).unwrap().map(|column| (column.index(), column.unit().unwrap()));
        assert_eq!(index(&table.clone().only(&["Time [ms]", "F"]).unwrap()), Some((1, 1e-3)));
        assert_eq!(index(&table.clone().with_heading(1, "").unwrap()), Some((1, 1e-3)));
        assert_eq!(
            index(&table.clone().with_heading(2, "Time [min]").unwrap().with_heading(1, "x").unwrap()),
            Some((1, 60.0))
        );
        for wrong in [table.clone().with_heading(0, ""), table.clone().with_heading(4, ""), table.only(&["G"])] {
            assert!(wrong.as_ref().is_err_and(|error| error.code() == "text_no_column"));
        }
        // equal in two units
        assert_eq!(index(&read("Time [ms],Time [s]\n1000,1\n2000,2\n3000,3\n")), Some((1, 1.0)));
        assert_eq!(index(&read("1 2\n3 4\n").with_heading(2, "t [h]").unwrap()), Some((1, 3600.0)));
        for temperature in ["T [°C]", "T (C)", "T", "T [K]", "temperature [s]"] {
            assert_eq!(
                read(&format!("{temperature},E\n1,2\n3,4\n"))
                    .find(&TIME)
                    .map(|found| found.is_some_and(|found| found.unit().is_ok())),
                Ok(temperature.ends_with("[s]"))
            );
        }
    }
}
