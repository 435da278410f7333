use std::fmt;

/// Where in a table: the entry of a slice, or the line of a file.
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
    /// There is no data at all.
    #[error("the {table} table is empty")]
    Empty {
        /// Which table.
        table: &'static str,
    },

    /// Too few values to fit a series to.
    #[error("the {table} table holds {rows} values, but a fit needs {least} at least")]
    TooFew {
        /// Which table.
        table: &'static str,
        /// Values given.
        rows: usize,
        /// Values needed.
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

    /// A time is negative, or a frequency or a time that must be positive is not.
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
        /// The range it must lie in.
        allowed: &'static str,
    },

    /// A compliance or modulus is not positive. A first row of zeros, from before the load, does not belong to
    /// the creep: remove it.
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
        /// Where it was given first.
        earlier: Place,
        /// Which column.
        column: &'static str,
        /// The time or frequency.
        value: f64,
    },

    /// A compliance decreases, a relaxation modulus increases, or a storage modulus decreases with frequency,
    /// by more than the scatter of the data explains: no passive body does. Remove the outlier, or what was recorded
    /// after the specimen failed or slipped.
    #[error(
        "{table} table, {place}: {column} = {value:?} strays by {:.2} % from any curve that does not turn back; the scatter of the data explains {:.2} %",
        100.0 * .change, 100.0 * .noise
    )]
    WrongWay {
        /// Which table.
        table: &'static str,
        /// Where it is worst.
        place: Place,
        /// Which column.
        column: &'static str,
        /// The value.
        value: f64,
        /// Relative distance from the nearest monotone curve.
        change: f64,
        /// Relative distance that would have been tolerated.
        noise: f64,
    },

    /// No series with positive coefficients comes near the data: they are not those of a body of springs and dashpots
    /// (tertiary creep, a step, moduli that contradict each other, wrong units), or too few for how steep they are.
    #[error("the {table} table is not that of a linear body: the best series misses it by {:.0} % in the root mean square, and by {:.0} % at x = {x:e}", 100.0 * .rms, 100.0 * .worst)]
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

    /// A heading says Hz, but the units given make it rad/s: give 2π as [`Units::abscissa`](crate::rheology::Units).
    #[error("line {line}: the column {heading:?} is in Hz, but Units::abscissa is 1: give 2π")]
    Hertz {
        /// The line of the headings.
        line: u64,
        /// The heading.
        heading: String,
    },

    /// A heading says another unit than [`Units`](crate::rheology::Units) does, one that is not known, or that its column holds
    /// logarithms: correct one of them.
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
        /// What was given as the size of the unit.
        given: f64,
        /// The unit of this size.
        expected: String,
    },

    /// A file could not be read.
    #[error("{file}: {reason}")]
    Unreadable {
        /// Its name.
        file: String,
        /// What the system or the reader says.
        reason: String,
    },

    /// A line of a file has another number of columns than needed.
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

    /// A heading names no column, or two, of those needed.
    #[error("line {line}: no single column is headed as {column} (headings: {found})")]
    Heading {
        /// The line of the headings.
        line: u64,
        /// What is looked for.
        column: &'static str,
        /// The headings there are.
        found: String,
    },

    /// An entry of a file is not a number.
    #[error("line {line}, column {column}: {text:?} is not a number")]
    NotNumeric {
        /// The line.
        line: u64,
        /// Number of the column, from 1.
        column: usize,
        /// What is there.
        text: String,
    },

    /// An entry of a file can be read in more than one way.
    #[error("line {line}, column {column}: {text:?} can be {readings}")]
    Ambiguous {
        /// The line.
        line: u64,
        /// Number of the column, from 1.
        column: usize,
        /// What is there.
        text: String,
        /// What it may mean.
        readings: &'static str,
    },

    /// Isotherms of a master curve measure different things.
    #[error("the {first} isotherms cannot be joined to {second} isotherms")]
    MixedIsotherms {
        /// What the first measures, or what is asked for.
        first: &'static str,
        /// What the other measures.
        second: &'static str,
    },

    /// An isotherm is flat: nothing tells by how much it is shifted. Use a law
    /// ([`MasterCurve::with_law`](crate::rheology::MasterCurve::with_law)).
    #[error("of the isotherms at {} K and {} K one does not change with time: nothing tells by how much it is shifted; use MasterCurve::with_law", .temperatures[0], .temperatures[1])]
    NothingToShift {
        /// The temperatures \[K\].
        temperatures: [f64; 2],
    },

    /// Two isotherms have no values in common, so that no shift brings them together: measure at a temperature in
    /// between, or shift by a law ([`MasterCurve::with_law`](crate::rheology::MasterCurve::with_law)).
    #[error(
        "the isotherms at {} K and {} K do not overlap in their values: at the best shift they are {:.0} % apart; measure at a temperature in between, or use MasterCurve::with_law",
        .temperatures[0], .temperatures[1], 100.0 * .apart
    )]
    NoOverlap {
        /// The temperatures \[K\].
        temperatures: [f64; 2],
        /// Root mean square of the logarithmic distance at the best shift.
        apart: f64,
    },
}
