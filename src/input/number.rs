//! Numbers in texts.

use std::borrow::Cow;

use crate::error::{Error, Refusal};

/// The number that a text is.
pub(crate) fn number(text: &str, decimal_comma: bool) -> Option<f64> {
    let text = match decimal_comma {
        true if text.contains('.') => return None,
        true => Cow::Owned(text.replace(',', ".")),
        false => Cow::Borrowed(text),
    };
    text.parse().ok().or_else(|| text.replace(['d', 'D'], "e").parse().ok())
}

/// The error of such a text.
pub(super) fn not_numeric(line: u64, column: usize, text: &str) -> Error {
    let remedy = "; leave the line out by # at its beginning or TextFormat::with_skipped_lines, and remove separators \
        of thousands";
    Refusal::file("text_not_numeric", no_number(line, column, text), remedy).into()
}

/// What says that the text in a column, from 0, is not a number.
pub(super) fn no_number(line: u64, column: usize, text: &str) -> String {
    format!("line {line}, column {}: {:?} is not a number", column + 1, shortened(text))
}

/// A text, shortened for errors.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    if text.chars().count() <= MOST { text.to_owned() } else { text.chars().take(MOST).chain("…".chars()).collect() }
}
