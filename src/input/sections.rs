//! Rows of headings and units, and sections of a text: instruments write headings anew before every step or interval.

use super::format::Delimiter;
use super::lines::{Text, TextRow};
use super::unit::readings;

/// Most characters of a unit, as of `mrad/(N.m)`: a row of longer words is none of units.
const LONGEST_UNIT: usize = 12;
/// Rows in which the same two columns have numbers: a table has begun.
pub(super) const ROWS_OF_NUMBERS: usize = 3;

/// Rows below the same headings.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Section {
    /// Each with the unit of the row below it in brackets; none, if there is no row of headings.
    pub(super) headings: Vec<String>,
    /// The line of the headings, or of the first row of numbers.
    pub(super) line: u64,
    /// The lines of the first row of numbers, and after the last.
    pub(super) first: u64,
    pub(super) end: u64,
}

/// The `first` section, whose headings are `names`, and those after it: they repeat these headings or have others,
/// below lines that belong to no row.
pub(super) fn sections(text: &Text, names: &TextRow, first: Section) -> Vec<Section> {
    let from = |row: &TextRow| row.line >= first.first && !row.is_empty();
    let column = text.rows().find(from).and_then(|row| (0..row.fields.len()).find(|&column| row.is_number(column)));
    let mut sections = vec![first.clone()];
    // mostly all rows have a number there
    let is_heading = |row: TextRow| from(&row) && column.is_some_and(|column| !row.is_number(column));
    if !text.rows().any(is_heading) {
        return sections;
    }
    let mut rows: Vec<TextRow> = text.rows().filter(from).collect();
    rows.iter_mut().for_each(|row| row.drop_empty(1));
    let mut start = 0;
    for at in 0..rows.len() {
        let row = &rows[at];
        let units = rows.get(at + 1).filter(|row| are_units(row));
        let next = at + 1 + usize::from(units.is_some());
        let is_section = row.fields == names.fields || begins(row, units, &rows[next.min(rows.len())..]);
        if at < start || !is_section {
            continue;
        }
        let between = rows[start..at].iter().rev().take_while(|row| is_between(row, &rows[start]));
        let end = between.last().map_or(row.line, |row| row.line);
        sections.last_mut().into_iter().for_each(|before| before.end = end);
        let first = rows.get(next);
        let (headings, first) = (headings(row, units, first), first.map_or(u64::MAX, |row| row.line));
        sections.push(Section { headings, line: row.line, first, end: u64::MAX });
        start = next;
    }
    sections
}

/// Whether a row is no row of a section whose `first` is this: one with a fault has a number in its place, or begins as
/// the others do.
fn is_between(row: &TextRow, first: &TextRow) -> bool {
    let begins_so = row.fields[0] == first.fields[0] || row.is_number(0);
    let has_number = (0..first.fields.len()).any(|column| first.is_number(column) && row.is_number(column));
    !has_number || !begins_so && row.fields.len() != first.fields.len()
}

/// Whether a section with other headings begins: different words, or some with units below them, above rows of numbers.
fn begins(names: &TextRow, units: Option<&TextRow>, rows: &[TextRow]) -> bool {
    let words: Vec<&str> = names.fields.iter().map(|field| &**field).filter(|field| !field.is_empty()).collect();
    let are_different = || (1..words.len()).all(|k| !words[..k].contains(&words[k]));
    words.len() > 1 && names.numbers() == 0 && are_numbers(rows) && (units.is_some() || are_different())
}

/// Whether the same two columns of the first rows, or more, have numbers.
pub(super) fn are_numbers(rows: &[TextRow]) -> bool {
    let next = &rows[..rows.len().min(ROWS_OF_NUMBERS)];
    let is_column = |&column: &usize| next.iter().all(|row| row.is_number(column));
    next.first().is_some_and(|row| (0..row.fields.len()).filter(is_column).count() > 1)
}

/// The fields of a row; units in brackets belong to the field before them, if blanks have torn them off.
pub(super) fn merged(row: &TextRow, width: usize) -> Vec<String> {
    let mut merged: Vec<String> = Vec::new();
    let torn = row.dialect.delimiter == Delimiter::Blanks && row.fields.len() > width;
    for field in &row.fields {
        match merged.last_mut().filter(|_| torn && field.starts_with(['[', '(', '{'])) {
            Some(last) => *last += &format!(" {field}"),
            None => merged.push(field.to_string()),
        }
    }
    merged
}

/// Headings of a table that begins with this row, with the units below them.
pub(super) fn headings(names: &TextRow, units: Option<&TextRow>, first: Option<&TextRow>) -> Vec<String> {
    let width = first.map_or(0, |row| row.fields.len());
    let [mut names, mut units] = [Some(names), units].map(|row| row.map_or(Vec::new(), |row| merged(row, width)));
    // `Interval data:` above the first column, or before it
    let is_before = names[0].ends_with(':') && names.len() == width + 1;
    if is_before && first.is_some_and(|row| row.is_number(0)) {
        for row in [&mut names, &mut units] {
            row.drain(..row.len().min(1));
        }
    }
    with_units(names, Some(units))
}

pub(super) fn with_units(mut names: Vec<String>, units: Option<Vec<String>>) -> Vec<String> {
    for (name, unit) in names.iter_mut().zip(units.into_iter().flatten()) {
        let unit = bare(&unit);
        if !["", "-"].contains(&unit) {
            *name += &format!(" [{unit}]");
        }
    }
    names
}

/// Whether the fields of a row are units: short words, at least one of which is known. The only numbers are the digit 1,
/// for quantities without a unit, in at most half of the fields.
pub(super) fn are_units(row: &TextRow) -> bool {
    let fields = || row.fields.iter().map(|field| bare(field)).filter(|field| !["", "-", "%"].contains(field));
    let is_known = |field: &&str| !readings(field).is_empty();
    let (all, known, ones) =
        (fields().count(), fields().filter(is_known).count(), fields().filter(|field| *field == "1").count());
    // a letter may be a symbol: h of a depth
    let is_clear = |field: &&str| is_known(field) && field.chars().count() > 1;
    let are_few = 2 * ones <= all && row.numbers() <= ones;
    let are_short = fields().all(|field| field.chars().count() <= LONGEST_UNIT);
    known > 0 && are_few && (known + ones == all || are_short && fields().any(|field| is_clear(&field)))
}

/// A unit without the brackets around it.
fn bare(unit: &str) -> &str {
    let within = |open: char, close: char| unit.strip_prefix(open)?.strip_suffix(close);
    within('[', ']').or_else(|| within('(', ')')).map_or(unit, str::trim)
}
