use std::fmt;

/// A place in a table: the entry of a slice, or the line of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// Index into the slices given.
    Entry(usize),
    /// Line of the file, from 1.
    Line(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Entry(index) => write!(f, "entry {index}"),
            Place::Line(line) => write!(f, "line {line}"),
        }
    }
}

/// What is wrong with a table of measured data.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The table has no rows.
    #[error("the {table} table is empty")]
    Empty {
        /// Which table.
        table: &'static str,
    },

    /// Too few values to fit a series to.
    #[error("the {table} table holds {rows} values, but a fit needs at least {least}")]
    TooFew {
        /// Which table.
        table: &'static str,
        /// Number of values given.
        rows: usize,
        /// Number of values needed.
        least: usize,
    },

    /// A value is NaN or infinite.
    #[error("{table} table, {place}: {column} = {value:?} is not a number")]
    NotFinite {
        /// Which table.
        table: &'static str,
        /// Where.
        place: Place,
        /// Which column.
        column: &'static str,
        /// The value.
        value: f64,
    },

    /// A time is negative, or a frequency, or a time that must be positive, is not positive.
    #[error("{table} table, {place}: {column} = {value:?} must be {allowed}")]
    Abscissa {
        /// Which table.
        table: &'static str,
        /// Where.
        place: Place,
        /// Which column.
        column: &'static str,
        /// The value.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },

    /// A compliance or modulus is not positive. Remove a first row of zeros, recorded before the load: it is not part
    /// of the creep.
    #[error("{table} table, {place}: {column} = {value:?} must be > 0")]
    NotPositive {
        /// Which table.
        table: &'static str,
        /// Where.
        place: Place,
        /// Which column.
        column: &'static str,
        /// The value.
        value: f64,
    },

    /// Two values are given for the same time or frequency: average them, or keep one.
    #[error("{table} table: {place} and {earlier} give two values for {column} = {value}")]
    Duplicate {
        /// Which table.
        table: &'static str,
        /// Where.
        place: Place,
        /// The earlier place.
        earlier: Place,
        /// Which column.
        column: &'static str,
        /// The time or frequency.
        value: f64,
    },

    /// A compliance decreases, a relaxation modulus increases, or a storage modulus decreases with frequency, by more
    /// than the scatter of the data explains. No passive body responds so. Remove the outlier, or the data recorded
    /// after the specimen failed or slipped.
    #[error(
        "{table} table, {place}: {column} = {value:?} deviates by {:.2} % from the nearest monotone curve; the scatter of the data explains {:.2} %",
        100.0 * .change, 100.0 * .noise
    )]
    WrongWay {
        /// Which table.
        table: &'static str,
        /// Where the deviation is greatest.
        place: Place,
        /// Which column.
        column: &'static str,
        /// The value.
        value: f64,
        /// Relative deviation from the nearest monotone curve.
        change: f64,
        /// Relative deviation that the scatter explains.
        noise: f64,
    },

    /// No series with positive coefficients fits the data: they do not describe a body of springs and dashpots
    /// (tertiary creep, a step, moduli that contradict each other, wrong units), or too few for their steepness.
    #[error("the {table} table is not that of a linear body: the best series deviates by {:.0} % in the root mean square, and by {:.0} % at x = {x:e}", 100.0 * .rms, 100.0 * .worst)]
    Inconsistent {
        /// Which table.
        table: &'static str,
        /// Relative misfit, root mean square.
        rms: f64,
        /// Greatest relative misfit.
        worst: f64,
        /// Where it is \[s or rad/s\].
        x: f64,
    },

    /// A heading names Hz, but the units given mean rad/s: give 2π as [`Units::abscissa`](crate::rheology::Units).
    #[error("line {line}: the column {heading:?} is in Hz, but Units::abscissa is 1: give 2π")]
    Hertz {
        /// The line of the headings.
        line: u64,
        /// The heading.
        heading: String,
    },

    /// A heading names a unit other than [`Units`](crate::rheology::Units) gives, an unknown unit, or logarithms:
    /// correct the heading or the units.
    #[error(
        "line {line}, column {column}: the heading {heading:?} says {unit}, but Units::{field} = {given} means {expected}"
    )]
    Unit {
        /// The line of the headings.
        line: u64,
        /// Number of the column, from 1.
        column: usize,
        /// The heading.
        heading: String,
        /// Its unit.
        unit: String,
        /// `abscissa` or `value`.
        field: &'static str,
        /// The size of the unit given.
        given: f64,
        /// The unit of this size.
        expected: String,
    },

    /// A file could not be read.
    #[error("{file}: {reason}")]
    Unreadable {
        /// Its name.
        file: String,
        /// The message of the system or the reader.
        reason: String,
        /// The kind of the system's error; `None` if the contents cannot be read.
        kind: Option<std::io::ErrorKind>,
    },

    /// A line of a file has the wrong number of columns.
    #[error("line {line}: {found} columns, but {expected} are needed ({columns})")]
    Columns {
        /// The line.
        line: u64,
        /// Columns found.
        found: usize,
        /// Columns needed.
        expected: usize,
        /// Their names.
        columns: String,
    },

    /// No heading, or more than one, names a column that is needed.
    #[error("line {line}: not exactly one heading names the {column} (headings: {found})")]
    Heading {
        /// The line of the headings.
        line: u64,
        /// The column needed.
        column: &'static str,
        /// The headings found.
        found: String,
    },

    /// An entry of a file is not a number.
    #[error("line {line}, column {column}: {text:?} is not a number")]
    NotNumeric {
        /// The line.
        line: u64,
        /// Number of the column, from 1.
        column: usize,
        /// The entry.
        text: String,
    },

    /// An entry of a file can be read in more than one way.
    #[error("line {line}, column {column}: {text:?} can be {readings}")]
    Ambiguous {
        /// The line.
        line: u64,
        /// Number of the column, from 1.
        column: usize,
        /// The entry.
        text: String,
        /// Its possible meanings.
        readings: &'static str,
    },

    /// Isotherms of a master curve measure different quantities.
    #[error("the {first} isotherms cannot be joined to {second} isotherms")]
    MixedIsotherms {
        /// The quantity of the first, or the one requested.
        first: &'static str,
        /// The quantity of the other.
        second: &'static str,
    },

    /// An isotherm is constant in time, so that its shift cannot be determined. Use a law
    /// ([`MasterCurve::with_law`](crate::rheology::MasterCurve::with_law)).
    #[error("one of the isotherms at {} K and {} K is constant in time: its shift cannot be determined; use MasterCurve::with_law", .temperatures[0], .temperatures[1])]
    NothingToShift {
        /// The temperatures \[K\].
        temperatures: [f64; 2],
    },

    /// The ranges of values of two isotherms do not overlap, so that no shift aligns them: measure at a temperature in
    /// between, or shift by a law ([`MasterCurve::with_law`](crate::rheology::MasterCurve::with_law)).
    #[error(
        "the isotherms at {} K and {} K do not overlap in their values: at the best shift they differ by {:.0} %; measure at a temperature in between, or use MasterCurve::with_law",
        .temperatures[0], .temperatures[1], 100.0 * .apart
    )]
    NoOverlap {
        /// The temperatures \[K\].
        temperatures: [f64; 2],
        /// Root mean square of the logarithmic distance at the best shift.
        apart: f64,
    },
}
