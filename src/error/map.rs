/// What is wrong with a map of heights, or a file of one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// A height is infinite, or beyond ±1e300 m.
    #[error(
        "height {entry} of the map is {value}: heights must be finite and within ±1e300 m, or NaN where nothing was measured"
    )]
    NotFinite {
        /// Index of the height.
        entry: usize,
        /// The value.
        value: f64,
    },

    /// No height is known: nothing was measured, or the grid lies beside the map.
    #[error("no height is known: nothing was measured there")]
    NothingKnown,

    /// Heights are missing where all are needed: fill them
    /// ([`HeightMap::filled`](crate::geometry::HeightMap::filled)) or crop the map.
    #[error("{missing} heights of the map are missing: fill them with HeightMap::filled, or crop the map")]
    Incomplete {
        /// How many.
        missing: usize,
    },

    /// The heights between the known ones were not found to the accuracy of the numbers; those known are too far
    /// apart in height, or too few.
    #[error("the missing heights were not found in {iterations} iterations: the residual is {residual:e} m")]
    NotFilled {
        /// Iterations done.
        iterations: usize,
        /// Greatest distance of a height from the mean of its neighbours \[m\].
        residual: f64,
    },

    /// A file could not be read, or is not one of its format.
    #[error("{file}: {reason}")]
    Unreadable {
        /// Its name, or its format if it has none.
        file: String,
        /// What the system or the reader says.
        reason: String,
    },

    /// A file could not be written.
    #[error("the {format} file could not be written: {reason}")]
    Unwritable {
        /// Its format.
        format: &'static str,
        /// What the system says.
        reason: String,
    },

    /// The name of a file tells no format that carries the lengths of its map. Formats that do not are read by
    /// [`from_npy`](crate::geometry::HeightMap), [`from_text`](crate::geometry::HeightMap::from_text) and
    /// [`from_xyz`](crate::geometry::HeightMap::from_xyz), which are told them.
    #[error(
        "{file}: the extension must be {known}; other formats do not say how long their maps are: use HeightMap::from_npy, from_text or from_xyz"
    )]
    Extension {
        /// The name of the file.
        file: String,
        /// The extensions that are known.
        known: &'static str,
    },

    /// A file does not begin as those of its format do.
    #[error("not a {format} file: it does not begin with {magic}")]
    Magic {
        /// The format.
        format: &'static str,
        /// How such files begin.
        magic: &'static str,
    },

    /// A file lacks something it must have.
    #[error("the {format} file has no {key}")]
    Missing {
        /// The format.
        format: &'static str,
        /// What it lacks.
        key: &'static str,
    },

    /// An entry of a file's header is not one that can be read.
    #[error("the {format} file has {key} = {text:?}, which must be {allowed}")]
    Entry {
        /// The format.
        format: &'static str,
        /// The name of the entry.
        key: &'static str,
        /// What it says.
        text: String,
        /// What it may say.
        allowed: &'static str,
    },

    /// A file does not say in which unit its numbers are: say it, as
    /// [`HeightMap::from_gsf_with`](crate::geometry::HeightMap::from_gsf_with) lets you.
    #[error("the {format} file has no {key}, its numbers no unit: give it, as in HeightMap::from_gsf_with")]
    NoUnit {
        /// The format.
        format: &'static str,
        /// The entry that would name the unit.
        key: &'static str,
    },

    /// A unit is not one of length.
    #[error("{symbol:?} is not a unit of length that is known: m, cm, mm, µm (um), nm, Å (A) or pm")]
    Unit {
        /// Its symbol.
        symbol: String,
    },

    /// A file holds more or fewer heights than it says: it is cut short or damaged.
    #[error("the {format} file should hold {expected} {what}, but holds {found}{}", if *.exact { "" } else { " or more" })]
    Size {
        /// The format.
        format: &'static str,
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: u64,
        /// How many there should be.
        expected: u64,
        /// Whether all were counted, or only as many as were needed to see that there are too many.
        exact: bool,
    },

    /// A line of a file has another number of columns than needed.
    #[error("line {line}: {found} columns, but {expected} are needed")]
    Columns {
        /// The line, from 1.
        line: u64,
        /// Columns found.
        found: usize,
        /// Columns needed.
        expected: usize,
    },

    /// An entry of a file is not a finite number, and does not say that nothing was measured.
    #[error("line {line}, column {column}: {text:?} is not a finite number")]
    NotNumeric {
        /// The line, from 1.
        line: u64,
        /// The column, from 1.
        column: usize,
        /// What is there.
        text: String,
    },

    /// A point does not lie on the regular grid that the others make.
    #[error("line {line}: {axis} = {value:e} m lies {:.2} spacings of {spacing:e} m off the regular grid of the points; {:.3} are allowed", .off, .allowed)]
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
        /// The most that is allowed, in spacings.
        allowed: f64,
    },

    /// Two points of a file are the same point of the grid: average them, or keep one.
    #[error("lines {earlier} and {line} give two heights for the point ({:e}, {:e}) m", .at[0], .at[1])]
    Duplicate {
        /// The line, from 1.
        line: u64,
        /// The line that gave it first.
        earlier: u64,
        /// The point \[m\].
        at: [f64; 2],
    },

    /// The points of a file are too few for the regular grid they seem to lie on, and are scattered rather than a grid.
    #[error("{points} points are less than 1 % of a regular grid of {} x {}: they are scattered, not a map", .cells[0], .cells[1])]
    Sparse {
        /// How many points there are.
        points: usize,
        /// How many the grid would have along x and y.
        cells: [usize; 2],
    },
}
