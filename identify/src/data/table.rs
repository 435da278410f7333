//! The rows of a text file.

use viscocontact::{Delimiter, TextError, TextFormat};

use crate::data::Recording;
use crate::data::error::DataError;
use crate::data::headings::{DEFLECTION, DEPTH, DRIVE, FORCE, TIME};
use crate::error::Result;

/// The fields of a line, and its number from 1.
struct Row {
    line: u64,
    fields: Vec<String>,
}

/// Reads a recording from a text.
pub(super) fn recording(text: &str, format: TextFormat) -> Result<Recording> {
    let (rows, delimiter) = rows(text, format)?;
    let mut rows = rows.into_iter();
    let headings = rows.next().unwrap_or(Row { line: 1, fields: Vec::new() });
    let width = headings.fields.len();
    let find = |column: &super::headings::Column| column.find(headings.line, &headings.fields);
    let missing = |column: &super::headings::Column| column.missing(headings.line, &headings.fields);
    let time = find(&TIME)?.ok_or_else(|| missing(&TIME))?;
    let [force, deflection, drive, depth] = [find(&FORCE)?, find(&DEFLECTION)?, find(&DRIVE)?, find(&DEPTH)?];
    if force.or(deflection).is_none() {
        return Err(missing(&FORCE).into());
    }
    if drive.or(depth).is_none() {
        return Err(missing(&DRIVE).into());
    }
    let found = [Some(time), force, deflection, drive, depth];
    let mut columns = found.map(|place| place.map(|_| Vec::new()));
    for Row { line, fields } in rows {
        if fields.len() != width {
            let columns = headings.fields.join(", ");
            return Err(text_error(TextError::Columns {
                line,
                found: fields.len(),
                expected: width,
                columns,
                delimiter,
            }));
        }
        for (place, column) in found.iter().zip(&mut columns) {
            if let (&Some((place, size)), Some(column)) = (place, column) {
                column.push(size * number(&fields[place], line, place, format)?);
            }
        }
        if let Some(&[.., previous, value]) = columns[0].as_deref()
            && (value <= previous || value.is_nan())
        {
            return Err(DataError::TimesNotAscending { line, value, previous }.into());
        }
    }
    let [times, force, deflection, drive, depth] = columns;
    Ok(Recording { times: times.unwrap_or_default(), force, deflection, drive, depth })
}

fn text_error(error: TextError) -> crate::Error {
    viscocontact::Error::from(error).into()
}

/// The rows with fields, and the name of the delimiter.
fn rows(text: &str, format: TextFormat) -> Result<(Vec<Row>, &'static str)> {
    // byte order mark of some spreadsheets
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let is_kept = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let numbered = || (1_u64..).zip(text.lines()).filter(|(_, line)| is_kept(line));
    let first = numbered().next().map_or("", |(_, line)| line);
    let candidates: &[(char, Delimiter)] =
        &[(';', Delimiter::Semicolon), ('\t', Delimiter::Tab), (',', Delimiter::Comma)];
    let delimiter = match format.delimiter() {
        Delimiter::FirstLine => {
            let candidates = &candidates[..if format.decimal_comma() { 2 } else { 3 }];
            let found = candidates.iter().find(|(mark, _)| first.contains(*mark));
            found.map_or(Delimiter::Blanks, |(_, delimiter)| *delimiter)
        }
        stated => stated,
    };
    let (mark, name) = match delimiter {
        Delimiter::Semicolon => (b';', "semicolons"),
        Delimiter::Comma => (b',', "commas"),
        Delimiter::Tab => (b'\t', "tabs"),
        _ => (b'\t', "blanks"),
    };
    let is_blank = name == "blanks";
    // rows of one line each, so that the position of a row gives its line
    let lines: Vec<u64> = numbered().map(|(line, _)| line).collect();
    let kept = numbered().map(|(_, line)| if is_blank { tabbed(line) } else { line.to_owned() });
    let kept = kept.collect::<Vec<_>>().join("\n");
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .delimiter(mark)
        .from_reader(kept.as_bytes());
    let row = |(index, record): (usize, csv::Result<csv::StringRecord>)| {
        let line = lines.get(index).copied().unwrap_or_default();
        let record =
            record.map_err(|_| TextError::NotNumeric { line, column: 1, text: "text in another encoding".into() });
        let mut fields: Vec<String> = record.map_err(text_error)?.iter().map(str::to_owned).collect();
        while fields.len() > 1 && fields.last().is_some_and(String::is_empty) {
            fields.pop();
        }
        Ok(Row { line, fields })
    };
    Ok((reader.records().enumerate().map(row).collect::<Result<_>>()?, name))
}

/// A line with tabs for blanks, but before units in brackets.
fn tabbed(line: &str) -> String {
    let mut tabbed = String::new();
    for word in line.split_whitespace() {
        if !tabbed.is_empty() {
            tabbed.push(if word.starts_with(['[', '(', '{']) { ' ' } else { '\t' });
        }
        tabbed += word;
    }
    tabbed
}

fn number(text: &str, line: u64, place: usize, format: TextFormat) -> Result<f64> {
    let parse = |decimal_comma: bool| -> Option<f64> {
        match decimal_comma {
            true if text.contains('.') => None,
            true => text.replace(',', ".").parse().ok(),
            false => text.parse().ok(),
        }
    };
    let (decimal_comma, column, text) = (format.decimal_comma(), place + 1, text.chars().take(60).collect());
    parse(decimal_comma).filter(|value| value.is_finite()).ok_or_else(|| {
        text_error(match parse(!decimal_comma) {
            Some(_) => TextError::DecimalMark { line, column, text, decimal_comma },
            None => TextError::NotNumeric { line, column, text },
        })
    })
}
