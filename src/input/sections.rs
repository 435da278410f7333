//! Sections of a table: instruments write the headings anew before every step or interval.

use super::lines::{Text, TextRow};
use super::table::are_units;
use crate::error::TextError;

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
