/// What is wrong with a table in a text file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextError {
    /// A line has the wrong number of columns.
    #[error(
        "line {line}: {found} columns separated by {delimiter}, but {expected} are needed ({columns}); TextFormat::delimiter states another delimiter"
    )]
    Columns {
        /// The line, from 1.
        line: u64,
        /// Columns found.
        found: usize,
        /// Columns needed.
        expected: usize,
        /// Their names.
        columns: String,
        /// The delimiter: stated, or found in the first line.
        delimiter: &'static str,
    },

    /// An entry is not a number.
    #[error("line {line}, column {column}: {text:?} is not a number")]
    NotNumeric {
        /// The line, from 1.
        line: u64,
        /// The column, from 1.
        column: usize,
        /// The entry.
        text: String,
    },

    /// An entry has a decimal comma in place of a decimal point, a decimal point in place of a decimal comma, or
    /// separators of thousands: state [`TextFormat::decimal_comma`](crate::TextFormat::decimal_comma), or remove the
    /// separators.
    #[error(
        "line {line}, column {column}: {text:?} is not a number with TextFormat::decimal_comma = {decimal_comma}: state the other value, or remove separators of thousands"
    )]
    DecimalMark {
        /// The line, from 1.
        line: u64,
        /// The column, from 1.
        column: usize,
        /// The entry.
        text: String,
        /// [`TextFormat::decimal_comma`](crate::TextFormat::decimal_comma) as it was stated.
        decimal_comma: bool,
    },
}
