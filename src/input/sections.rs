//! Rows of units, and sections of a table: instruments write the headings anew before every step or interval.

use super::lines::{Text, TextRow};
use super::unit::readings;
use crate::error::TextError;

/// Most characters of a unit, as of `mrad/(N.m)`: a row of longer words is none of units.
const LONGEST_UNIT: usize = 12;

/// First and last lines between the sections of a table: each repeats its headings, below lines that belong to no row,
/// and above its row of units, if there is one.
///
/// # Errors
/// If a section has other units.
pub(super) fn gaps(
    text: &Text,
    names: &TextRow,
    units: Option<&TextRow>,
    first: &TextRow,
) -> Result<Vec<[u64; 2]>, TextError> {
    let mut lines = text.lines_from(names.line).map(|(number, line)| (number, line.trim_end()));
    let Some((_, headings)) = lines.next() else { return Ok(Vec::new()) };
    let again: Vec<u64> = lines.filter(|(_, line)| *line == headings).map(|(number, _)| number).collect();
    if again.is_empty() {
        return Ok(Vec::new());
    }
    let mut rows: Vec<TextRow> = text.rows().filter(|row| row.line >= first.line && !row.is_empty()).collect();
    rows.iter_mut().for_each(|row| row.drop_empty(1));
    let columns: Vec<usize> = (0..first.fields.len()).filter(|&column| first.is_number(column)).collect();
    // a row of the table with a fault has a number in its place, or begins as the others do
    let is_between = |row: &TextRow| {
        let begins_so = row.fields[0] == first.fields[0] || row.is_number(0);
        !columns.iter().any(|&column| row.is_number(column)) || !begins_so && row.fields.len() != first.fields.len()
    };
    let gap = |line: u64| {
        let at = rows.partition_point(|row| row.line < line);
        let own_units = rows.get(at + 1).filter(|row| are_units(row));
        if own_units.map(|row| &row.fields) != units.map(|row| &row.fields) {
            return Err(TextError::Section { line, headings: names.line });
        }
        let between = rows[..at].iter().rev().take_while(|row| is_between(row));
        let start = between.last().map_or(line, |row| row.line);
        Ok([start, own_units.map_or(line, |row| row.line)])
    };
    again.into_iter().map(gap).collect()
}

/// Whether the fields of a row are units: short words, of which one at least is known, and no number but a few ones.
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
pub(super) fn bare(unit: &str) -> &str {
    let within = |open: char, close: char| unit.strip_prefix(open)?.strip_suffix(close);
    within('[', ']').or_else(|| within('(', ')')).map_or(unit, str::trim)
}
