/// What is wrong with a table in a text file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextError {
    /// A line has the wrong number of columns.
    #[error(
        "line {line}: {found} columns separated by {delimiter}, but {expected} are needed ({columns}); \
        TextFormat::with_delimiter states another delimiter; if another table begins here, split the file; of a row \
        that is cut off, leave the line out by # at its beginning"
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
    #[error(
        "line {line}, column {column}: {text:?} is not a number; leave the line out by # at its beginning or \
        TextFormat::with_skipped_lines, and remove separators of thousands"
    )]
    NotNumeric {
        /// The line, from 1.
        line: u64,
        /// The column, from 1.
        column: usize,
        /// The entry.
        text: String,
    },

    /// An entry has a decimal comma in place of a decimal point, a decimal point in place of a decimal comma, or
    /// separators of thousands: state [`TextFormat::with_decimal_comma`](crate::TextFormat::with_decimal_comma), or
    /// remove the separators.
    #[error(
        "line {line}, column {column}: {text:?} is not a number with TextFormat::with_decimal_comma = \
        {decimal_comma}: state the other value, or remove separators of thousands"
    )]
    DecimalMark {
        /// The line, from 1.
        line: u64,
        /// The column, from 1.
        column: usize,
        /// The entry.
        text: String,
        /// [`TextFormat::with_decimal_comma`](crate::TextFormat::with_decimal_comma) as it was stated.
        decimal_comma: bool,
    },

    /// No heading names a column that is needed, or several may.
    #[error(
        "line {line}: not exactly one heading names the {column}{several} (headings: {found}); begin one with {words}, choose by TextTable::only, name columns by TextTable::with_heading, skip lines above the table by TextFormat::with_skipped_lines, or state TextFormat::with_delimiter"
    )]
    Heading {
        /// The line of the headings, from 1; of the first row of numbers, if there are none.
        line: u64,
        /// The column.
        column: &'static str,
        /// First words of headings that name it.
        words: String,
        /// The columns that may be it, after a colon.
        several: String,
        /// The headings found.
        found: String,
    },

    /// A heading has no unit of the quantity of its column, or one of two meanings: beside a factor, by which values
    /// may be multiplied or divided, after words that may change it, or of logarithms.
    #[error(
        "line {line}, column {column}: the heading {heading:?} has no unit of the {quantity}, or an ambiguous \
        one; write it in brackets, as in '[{example}]' or '[10^3 {example}]', or state it \
        (TextTable::with_heading, Units)"
    )]
    Unit {
        /// The line of the headings, from 1.
        line: u64,
        /// The column, from 1.
        column: usize,
        /// The heading.
        heading: String,
        /// What the column is.
        quantity: &'static str,
        /// A unit of its quantity.
        example: &'static str,
    },

    /// Rows of numbers stand before the headings.
    #[error(
        "line {line} has numbers, but the headings stand in line {headings}: skip the lines before it \
        (TextFormat::with_skipped_lines), or split the file"
    )]
    Preamble {
        /// The first row of numbers, from 1.
        line: u64,
        /// The line of the headings.
        headings: u64,
    },

    /// A section has other headings or units, so that it cannot be joined to the table.
    #[error(
        "line {line} begins a section with other headings or units than those of line {headings}: choose one by \
        TextTable::section, or split the file"
    )]
    Section {
        /// The line of the headings of the section, from 1.
        line: u64,
        /// The line of the headings of the table.
        headings: u64,
    },

    /// A section that was asked for is not in the table.
    #[error("there is no section {section}: give one from 1 to {sections}")]
    NoSection {
        /// Its number.
        section: usize,
        /// The number of sections.
        sections: usize,
    },

    /// A column that was asked for is not in the table.
    #[error("there is no column {column} (headings: {found}); give one of these, or its number from 1 on")]
    NoColumn {
        /// Its name, or its number.
        column: String,
        /// The headings found.
        found: String,
    },
}
