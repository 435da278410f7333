use super::ErrorKind;
use crate::Axis;
use crate::rounded::rounded;

/// What is wrong with a height map or its file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// A height is infinite, or beyond ±1e300 m.
    #[error(
        "height {entry} of the map is {value:?}: heights must be finite and within ±1e300 m, or NaN where nothing \
        was measured"
    )]
    NotFinite {
        /// Index of the height.
        entry: usize,
        /// The value.
        value: f64,
    },

    /// No height is known: nothing was measured, or the grid does not overlap the map.
    #[error("no height is known: nothing was measured there; take a part of the map with heights")]
    NothingKnown,

    /// The shortest wavelength of a rough surface is below two cells of its grid.
    #[error(
        "shortest wavelength = {} m is not allowed: it must be at least two cells of the grid, which are {} m \
        along {axis}: take a longer wavelength, or {cells} cells along \
        {axis}", rounded(*.shortest, 4), rounded(*.minimum, 4)
    )]
    TooFine {
        /// The shortest wavelength \[m\].
        shortest: f64,
        /// The length of two cells \[m\].
        minimum: f64,
        /// The axis of the cells.
        axis: Axis,
        /// Number of cells along the axis that resolves the wavelength.
        cells: usize,
    },

    /// Some heights are missing and all are needed: fill them
    /// ([`HeightMap::filled`](crate::geometry::HeightMap::filled)) or crop the map.
    #[error("{missing} heights of the map are missing: fill them with HeightMap::filled, or crop the map")]
    Incomplete {
        /// Number of missing heights.
        missing: usize,
    },

    /// The interpolation of the missing heights did not converge to rounding: the known heights differ too much, or are
    /// too few.
    #[error(
        "the interpolation of the missing heights did not converge in {iterations} iterations: the residual is \
        {residual:.1e} m; crop the part without heights"
    )]
    NotFilled {
        /// Iterations done.
        iterations: usize,
        /// Maximum distance of a height from the mean of its neighbours \[m\].
        residual: f64,
    },

    /// A file could not be written.
    #[error("the {format} file could not be written: {reason}")]
    Unwritable {
        /// Its format.
        format: &'static str,
        /// The message of the system.
        reason: String,
        /// The kind of its error.
        kind: Option<std::io::ErrorKind>,
    },

    /// The extension of a file names no format that stores the side lengths of its map. Other formats are read
    /// by [`from_npy`](crate::geometry::HeightMap), [`from_text`](crate::geometry::HeightMap::from_text) and
    /// [`from_xyz`](crate::geometry::HeightMap::from_xyz), which take them as arguments.
    #[error(
        "{file}: the extension must be {known}; other formats do not store the side lengths of a map: use \
        HeightMap::from_npy, from_text or from_xyz; instrument formats (.opd, .ibw, .spm, .tif) are exported as \
        GSF by Gwyddion"
    )]
    Extension {
        /// The name of the file.
        file: String,
        /// The known extensions.
        known: &'static str,
    },

    /// The file does not begin with the magic number of its format.
    #[error(
        "not a {format} file: it does not begin with {magic} and the line end of its format; export it anew, or \
        as GSF by Gwyddion"
    )]
    Magic {
        /// The format.
        format: &'static str,
        /// The magic number.
        magic: &'static str,
    },

    /// A required part of a file is missing.
    #[error("the {format} file has no {key}: add it, or export the map anew")]
    Missing {
        /// The format.
        format: &'static str,
        /// The missing part.
        key: &'static str,
    },

    /// An entry of the header of a file cannot be read.
    #[error("the {format} file has {key} = {text:?}, which must be {allowed}")]
    Entry {
        /// The format.
        format: &'static str,
        /// The name of the entry.
        key: &'static str,
        /// Its value.
        text: String,
        /// The values allowed.
        allowed: &'static str,
    },

    /// A file does not name the unit of its numbers: give it, as with
    /// [`HeightMap::from_gsf`](crate::geometry::HeightMap::from_gsf).
    #[error("the {format} file has no {key}, the unit of its numbers: give it, as to HeightMap::from_gsf")]
    NoUnit {
        /// The format.
        format: &'static str,
        /// The entry that would name the unit.
        key: &'static str,
    },

    /// A unit is not a known unit of length.
    #[error("{symbol:?} is not a known unit of length: m, cm, mm, µm (um), nm, Å (A) or pm")]
    Unit {
        /// Its symbol.
        symbol: String,
    },

    /// A file holds more or fewer values than its header states: it is truncated or damaged.
    #[error("the {format} file should hold {expected} {what}, but holds {found}{}", if *.exact { "" } else { " or more" })]
    Size {
        /// The format.
        format: &'static str,
        /// What is counted.
        what: &'static str,
        /// The number found.
        found: u64,
        /// The number expected.
        expected: u64,
        /// Whether `found` is the total, or only a count that exceeds the expected one.
        exact: bool,
    },

    /// The points are not on a regular grid: the one that is furthest off.
    #[error("line {line}: {axis} = {} m is {:.3} spacings of {} m off the regular grid of the points; {:.3} are \
        allowed: interpolate the points on a regular \
        grid", rounded(*.value, 5), .off, rounded(*.spacing, 4), .allowed)]
    OffGrid {
        /// The line, from 1.
        line: u64,
        /// The coordinate: x or y.
        axis: &'static str,
        /// Its value \[m\].
        value: f64,
        /// The spacing of the grid \[m\].
        spacing: f64,
        /// The distance from the nearest line of the grid, in spacings.
        off: f64,
        /// The maximum distance allowed, in spacings.
        allowed: f64,
    },

    /// Two points of a file are at the same point of the grid: average them, or keep one.
    #[error("lines {earlier} and {line} give two heights for the point ({}, {}) m: give their mean", rounded(.at[0], 5), rounded(.at[1], 5))]
    Duplicate {
        /// The line, from 1.
        line: u64,
        /// The earlier line.
        earlier: u64,
        /// The point \[m\].
        at: [f64; 2],
    },

    /// The points of a file cover too little of the regular grid that their spacing suggests: they are scattered.
    #[error("{points} points are too few for the regular grid of {} x {} that their distances suggest: \
        interpolate scattered points on a regular grid", .cells[0], .cells[1])]
    Sparse {
        /// Number of points.
        points: usize,
        /// Number of points of that grid along x and y.
        cells: [usize; 2],
    },

    /// A text is no matrix of heights: it has coordinates.
    #[error("the text has {found}: use {remedy}, or HeightMap::new for a matrix that looks so")]
    NotAMatrix {
        /// What it has.
        found: &'static str,
        /// What reads it.
        remedy: &'static str,
    },

    /// Some heights of a text look like a number for points that were not measured: they are far from all others.
    #[error(
        "{count} of the heights are {value}, far from all others: state TextFormat::with_missing_height({value}) \
        if nothing was measured there, or with_missing_height(f64::NAN) if it was"
    )]
    StandIn {
        /// The height, in the unit of the file.
        value: f64,
        /// Number of these heights.
        count: usize,
    },

    /// A heading names another unit than the one given.
    #[error(
        "column {column}: the heading {heading:?} names another unit than {given}, which was given: give that of \
        the heading"
    )]
    OtherUnit {
        /// The column, from 1.
        column: usize,
        /// Its heading.
        heading: String,
        /// The unit given.
        given: String,
    },
}

impl MapError {
    pub(super) fn error_kind(&self) -> ErrorKind {
        match self {
            MapError::NotFinite { .. }
            | MapError::NothingKnown
            | MapError::TooFine { .. }
            | MapError::Incomplete { .. }
            | MapError::NotFilled { .. } => ErrorKind::Value,
            _ => ErrorKind::File,
        }
    }

    /// The kind of the system's error behind this one.
    pub(super) fn io_kind(&self) -> Option<std::io::ErrorKind> {
        if let MapError::Unwritable { kind, .. } = self { *kind } else { None }
    }
}
