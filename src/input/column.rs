//! The columns that a reader needs, found by their headings and units.

use std::cell::OnceCell;
use std::fmt;

use super::heading::{UnitOf, begins_with, symbol, unit_of};
use super::lines::TextRow;
use super::number::{not_numeric, shortened};
use super::table::{TextTable, numbered};
use super::unit::{Quantity, name};
use crate::error::{Error, Refusal, Result};

/// Columns of equal values are one: a frequency in Hz and in rad/s.
const EQUAL: f64 = 0.02;

/// A column that a reader needs.
///
/// ```
/// use viscocontact::input::{Quantity, TextTable, WantedColumn};
///
/// const LOAD: WantedColumn =
///     WantedColumn { name: "load", words: &["load", "p"], others: &["rate"], quantity: Quantity::FORCE, by_unit: true };
/// let text = "Time (s),Load (mN),Loading rate (mN/s)\n0,0.0,1\n1,1.0,1\n2,2.0,1\n";
/// let table = TextTable::read(text.as_bytes(), Default::default())?;
/// let load = table.find(&LOAD)?.expect("there is one");
/// assert_eq!((load.heading(), load.unit()?), ("Load (mN)", 1.0e-3));
/// assert_eq!(table.rows(&[load])?[2].values, [2.0]);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::exhaustive_structs, reason = "readers write it out")]
pub struct WantedColumn {
    /// Its name in errors.
    pub name: &'static str,
    /// First words or symbols of its headings, in lower case.
    pub words: &'static [&'static str],
    /// Parts that a heading must not contain: it then belongs to another column that begins alike.
    pub others: &'static [&'static str],
    /// Its quantity.
    pub quantity: Quantity,
    /// Whether it may have another name, if it is the only column with a unit of its quantity.
    pub by_unit: bool,
}

/// A column that was taken for what a reader needs.
#[derive(Debug, Clone, PartialEq)]
pub struct TakenColumn {
    name: &'static str,
    index: usize,
    line: u64,
    heading: String,
    pub(crate) quantity: Quantity,
    pub(crate) unit_of: UnitOf,
}

impl TakenColumn {
    /// What it was taken for.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Its index, from 0.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Its heading.
    pub fn heading(&self) -> &str {
        &self.heading
    }

    /// The line of its heading.
    pub(crate) fn line(&self) -> u64 {
        self.line
    }

    /// The size of its unit in SI.
    ///
    /// # Errors
    /// If the heading has no unit of its quantity, or one of two meanings.
    pub fn unit(&self) -> Result<f64> {
        match &self.unit_of {
            UnitOf::Sizes(_, sizes) if sizes.len() == 1 => Ok(sizes[0]),
            _ => {
                let (line, column, heading) = (self.line, self.index + 1, shortened(&self.heading));
                let (quantity, example) = (self.name, self.quantity.si());
                let what = format!(
                    "line {line}, column {column}: the heading {heading:?} has no unit of the {quantity}, or an \
                     ambiguous one"
                );
                let remedy = format!(
                    "; write it in brackets, as in '[{example}]' or '[10^3 {example}]', or state it \
                     (TextTable::with_heading, Units)"
                );
                Err(Refusal::file("text_unit", what, &remedy).naming(quantity).into())
            }
        }
    }

    /// The same with a unit of this size, which the heading does not name.
    pub(crate) fn with_unit(self, size: f64) -> TakenColumn {
        let unit_of = UnitOf::Sizes(name(self.quantity, size), vec![size]);
        TakenColumn { unit_of, ..self }
    }
}

impl fmt::Display for TakenColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: column {}", self.name, self.index + 1)?;
        if !self.heading.is_empty() {
            write!(f, " {:?}", self.heading)?;
        }
        match &self.unit_of {
            UnitOf::Sizes(text, sizes) if sizes.len() == 1 && sizes[0] != 1.0 => {
                write!(f, ", 1 {text} = {:e} {}", sizes[0], self.quantity.si())
            }
            UnitOf::Other(_) => f.write_str(", of another unit"),
            UnitOf::Unclear(_) => f.write_str(", of an ambiguous unit"),
            UnitOf::Sizes(_, sizes) if sizes.len() > 1 => f.write_str(", of a unit with two meanings"),
            _ => write!(f, " in {}", self.quantity.si()),
        }
    }
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TableRow {
    /// Its line in the file, from 1.
    pub line: u64,
    /// The numbers of the columns asked for.
    pub values: Vec<f64>,
}

impl TableRow {
    /// Accepts finite numbers of these columns.
    ///
    /// # Errors
    /// If one is not finite, with its line and column.
    pub fn check_finite(&self, columns: &[TakenColumn]) -> Result<()> {
        let not_finite = self.values.iter().zip(columns).find(|(value, _)| !value.is_finite());
        let error = |(value, column): (&f64, &TakenColumn)| not_numeric(self.line, column.index, &value.to_string());
        not_finite.map_or(Ok(()), |found| Err(error(found)))
    }
}

impl TextTable {
    /// The numbers of `columns` in every row, in the units of the file.
    ///
    /// # Errors
    /// If a row has another number of columns than the headings (or than `columns`, without headings), but for words
    /// that are lacking at its end; if a field is not a number; each with its line; or if a section has
    /// other headings.
    pub fn rows(&self, columns: &[TakenColumn]) -> Result<Vec<TableRow>> {
        self.rows_by(columns, |row, column| row.number(column))
    }

    /// The same with the numbers that `number` makes of the fields.
    pub(crate) fn rows_by(
        &self,
        columns: &[TakenColumn],
        number: impl Fn(&TextRow<'_>, usize) -> Result<f64>,
    ) -> Result<Vec<TableRow>> {
        let width = if self.headings.is_empty() { columns.len() } else { self.headings.len() };
        let names: Vec<&str> = if self.headings.is_empty() {
            columns.iter().map(|column| column.name).collect()
        } else {
            self.headings.iter().map(String::as_str).collect()
        };
        if let Some(other) = self.other() {
            let what = format!(
                "line {} begins a section with other headings or units than those of line {}",
                other.line, self.line
            );
            let remedy = ": choose one by TextTable::section, or split the file";
            return Err(Refusal::file("text_section", what, remedy).into());
        }
        let names = shortened(&names.join(", "));
        let (last, ends) = (columns.iter().map(|column| column.index).max().unwrap_or(0), OnceCell::new());
        // fields at the end alone: behind a mark that is lost within, words come where all other rows have numbers
        let lacks_its_end = |row: &TextRow| {
            let count = row.fields.len();
            let ends = || ends.get_or_init(|| self.last_of_numbers(width)).iter();
            let is_in_place = |end: &usize| (last..count).contains(end) && row.is_number(*end);
            let is_cut = || count == last + 1 && self.text.ends_in(row);
            count < width && !row.is_by_blanks() && ends().any(is_in_place) && !is_cut()
        };
        let row = |mut row: TextRow<'_>| {
            row.drop_empty(width);
            if !lacks_its_end(&row) {
                row.check_width(width, &names)?;
            }
            // a quote that nobody closed takes the next row into its field
            if let Some(column) = row.fields.iter().position(|field| field.contains('\n')) {
                return Err(row.not_numeric(column));
            }
            let values = columns.iter().map(|column| number(&row, column.index)).collect::<Result<_, _>>()?;
            Ok(TableRow { line: row.line, values })
        };
        self.data().map(row).collect()
    }

    /// The columns that have numbers in all rows of `width` fields, and none in the next column.
    fn last_of_numbers(&self, width: usize) -> Vec<usize> {
        let (mut rows, mut numbers) = (0, vec![0; width]);
        for row in self.data().filter(|row| row.fields.len() >= width) {
            rows += 1;
            numbers.iter_mut().enumerate().for_each(|(column, count)| *count += usize::from(row.is_number(column)));
        }
        (1..width).filter(|&next| rows > 0 && numbers[next - 1] == rows && numbers[next] == 0).map(|k| k - 1).collect()
    }

    /// The column that is `wanted`; `None` if no heading names it.
    ///
    /// Among several columns of this name, the one with a unit of its quantity is taken. Columns of equal values are
    /// one.
    ///
    /// # Errors
    /// If several may be it: the error names them.
    pub fn find(&self, wanted: &WantedColumn) -> Result<Option<TakenColumn>> {
        let taken = |index: usize| {
            let heading = self.headings[index].clone();
            let unit_of = unit_of(&heading, wanted.quantity);
            TakenColumn { name: wanted.name, index, line: self.line, heading, quantity: wanted.quantity, unit_of }
        };
        let columns: Vec<TakenColumn> = (0..self.headings.len()).map(taken).collect();
        let has_unit = |column: &TakenColumn| matches!(column.unit_of, UnitOf::Sizes(..));
        // of E / MPa, which is a modulus, `/ MPa` is a unit of compliances too
        let is_by_unit =
            |column: &TakenColumn| matches!(&column.unit_of, UnitOf::Sizes(text, _) if !text.starts_with('/'));
        let is_named = |column: &TakenColumn| {
            let heading = column.heading.to_lowercase();
            // T is a temperature, unless its unit is one of time
            let is_temperature = wanted.quantity == Quantity::TIME && column.heading.trim().starts_with('T');
            begins_with(&heading, wanted.words)
                && !wanted.others.iter().any(|other| heading.contains(other))
                && (has_unit(column) || !is_temperature || symbol(&heading) != "t")
        };
        let named = |fits: &dyn Fn(&TakenColumn) -> bool| -> Vec<TakenColumn> {
            columns.iter().filter(|column| is_named(column) && fits(column)).cloned().collect()
        };
        let candidates = [
            named(&has_unit),
            named(&|column| matches!(column.unit_of, UnitOf::Unnamed | UnitOf::Unclear(_))),
            columns.iter().filter(|column| wanted.by_unit && is_by_unit(column)).cloned().collect(),
            named(&|_| true),
        ];
        let Some(candidates) = candidates.into_iter().find(|candidates| !candidates.is_empty()) else {
            return Ok(None);
        };
        if let [first, rest @ ..] = &candidates[..]
            && !rest.iter().all(|other| self.are_equal(first, other))
        {
            let both = numbered(candidates.iter().map(|column| (column.index, &column.heading)));
            return Err(self.missing(wanted, &both));
        }
        // of equal columns, one in SI
        let distance = |column: &TakenColumn| column.unit().map_or(f64::INFINITY, |size| size.ln().abs());
        Ok(candidates.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))))
    }

    /// Whether two columns have the same values, in the rows where both have some.
    fn are_equal(&self, one: &TakenColumn, other: &TakenColumn) -> bool {
        let (Ok(a), Ok(b)) = (one.unit(), other.unit()) else { return false };
        let numbers = |row: TextRow<'_>| {
            let number = |column: usize| row.fields.get(column).and_then(|_| row.number(column).ok());
            Some([a * number(one.index)?, b * number(other.index)?])
        };
        let is_equal = |[x, y]: [f64; 2]| (x - y).abs() <= EQUAL * x.abs().max(y.abs());
        let mut rows = self.data().filter_map(numbers).peekable();
        rows.peek().is_some() && rows.all(is_equal)
    }

    /// The error of a column that no heading names, or that `several` columns may be.
    pub fn missing(&self, wanted: &WantedColumn, several: &str) -> Error {
        let found = if self.headings.is_empty() {
            "none".into()
        } else {
            shortened(&self.headings.join(", ")) + &self.looks_like(wanted.quantity)
        };
        let several = if several.is_empty() { String::new() } else { format!(": {several}") };
        let (line, column, words) = (self.line, wanted.name, wanted.words.join(", "));
        let what = format!("line {line}: not exactly one heading names the {column}{several} (headings: {found})");
        let remedy = format!(
            "; begin one with {words}, choose by TextTable::only, name columns by TextTable::with_heading, skip lines \
             above the table by TextFormat::with_skipped_lines, or state TextFormat::with_delimiter"
        );
        Refusal::file("text_heading", what, &remedy).naming(column).into()
    }

    /// A column of a table without headings, by its place.
    pub(crate) fn by_place(&self, wanted: &WantedColumn, index: usize) -> TakenColumn {
        let (name, line, quantity) = (wanted.name, self.line, wanted.quantity);
        TakenColumn { name, index, line, heading: String::new(), quantity, unit_of: UnitOf::Unnamed }
    }
}
