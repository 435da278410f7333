use std::fmt;

use crate::rounded::rounded;

/// A place in a table: the entry of a slice, or the line of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
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
    /// A value is outside its range, or not finite. Remove a first row of zeros, recorded before the load: it is not
    /// part of the creep.
    #[error(
        "{table}, {place}: {column} = {value:?} is not allowed: it must be {allowed}; leave out rows without a value"
    )]
    OutOfRange {
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

    /// Two values are given for the same time or frequency: average them, or keep one.
    #[error(
        "{table}: {place} and {earlier} give two values for {column} = {value}: give their mean, take one section of \
        the file (TextTable::section), or read several temperatures as isotherms (Isotherm::from_csv_reader)"
    )]
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
        "{table}, {place}: {column} = {} deviates by {:.2} % from the nearest monotone curve, where the scatter of the data explains {:.2} %: compliances rise, moduli of relaxation fall (Experiment); Measurements::with_scatter states more scatter",
        rounded(*.value, 5), 100.0 * .change, 100.0 * .noise
    )]
    WrongWay {
        /// Which table.
        table: &'static str,
        /// Where the deviation is largest.
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
    #[error("the {table} is not that of a linear body: the best series deviates by {:.0} % in the root mean square, and by {:.0} % at x = {}; Measurements::with_scatter states more scatter", 100.0 * .rms, 100.0 * .worst, rounded(*.x, 3))]
    Inconsistent {
        /// Which table.
        table: &'static str,
        /// Relative misfit, root mean square.
        rms: f64,
        /// Maximum relative misfit.
        worst: f64,
        /// Where it is \[s or rad/s\].
        x: f64,
    },

    /// A heading names a unit other than [`Units`](crate::rheology::Units) gives, an unknown unit, or logarithms:
    /// correct the heading or the units.
    #[error(
        "line {line}, column {column}: the heading {heading:?} says {unit}, but Units::{field} = {given} means \
        {expected}{}",
        .size.map(|size| format!("; of {unit} it is {}", rounded(size, 5))).unwrap_or_default()
    )]
    Unit {
        /// The line of the headings.
        line: u64,
        /// Number of the column, from 1.
        column: usize,
        /// The heading.
        heading: String,
        /// Its unit.
        unit: Box<str>,
        /// The size of this unit in SI; `None` if it is unknown, or a logarithm.
        size: Option<f64>,
        /// `abscissa` or `value`.
        field: &'static str,
        /// The size of the unit given.
        given: f64,
        /// The unit of this size.
        expected: Box<str>,
    },

    /// The headings of a dynamic table name a storage modulus, but neither a loss modulus nor a phase angle or tan δ.
    #[error(
        "line {line}: the headings name a storage modulus, but no loss modulus, phase angle or loss factor (tan): \
        name it, or read the table as Experiment::Storage"
    )]
    StorageOnly {
        /// The line of the headings.
        line: u64,
    },

    /// The headings of a file name moduli in tension (D, E, E′, E″), and it was to be fitted in shear, or the
    /// reverse. Moduli in tension are up to three times those in shear.
    #[error(
        "the headings of the table name {}", if *.in_tension {
            "moduli in tension: use Measurements::fit_tension and Material::from_tension"
        } else {
            "moduli in shear: use Measurements::fit and a material made from shear"
        }
    )]
    Deformation {
        /// Whether the headings name moduli in tension.
        in_tension: bool,
    },

    /// Isotherms of a master curve measure different quantities.
    #[error("a {first} and a {second} cannot be joined to one master curve: give isotherms of one experiment")]
    MixedIsotherms {
        /// The quantity of the first, or the one requested.
        first: &'static str,
        /// The quantity of the other.
        second: &'static str,
    },

    /// An isotherm is constant in time, so that its shift cannot be determined. Use a law
    /// ([`MasterCurve::with_law`](crate::rheology::MasterCurve::with_law)).
    #[error("one of the isotherms at {} K and {} K is constant in time: its shift cannot be determined; use \
        MasterCurve::with_law", .temperatures[0], .temperatures[1])]
    NothingToShift {
        /// The temperatures \[K\].
        temperatures: [f64; 2],
    },

    /// The ranges of values of two isotherms do not overlap, so that no shift aligns them: measure at a temperature in
    /// between, or shift by a law ([`MasterCurve::with_law`](crate::rheology::MasterCurve::with_law)).
    #[error(
        "the isotherms at {} K and {} K do not overlap in their values: at the best shift they differ by {:.0} %, and \
        where they overlap by {:.1} decades by {:.0} %; measure at a temperature in between, or use \
        MasterCurve::with_law",
        .temperatures[0], .temperatures[1], 100.0 * .apart, .overlap, 100.0 * .there
    )]
    NoOverlap {
        /// The temperatures \[K\].
        temperatures: [f64; 2],
        /// Root mean square of the logarithmic distance at the best shift.
        apart: f64,
        /// Decades of the widest overlap in which they are near each other.
        overlap: f64,
        /// Root mean square of the logarithmic distance there.
        there: f64,
    },
}
