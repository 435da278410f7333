//! The error type of the crate, and the checks that return it.

#[cfg(feature = "adhesion")]
mod adhesion;
#[cfg(feature = "checkpoint")]
mod checkpoint;
mod checks;
mod convergence;
pub(crate) mod coverage;
mod debug;
mod file;
#[cfg(feature = "friction")]
mod friction;
mod kernel;
mod kind;
mod load;
#[cfg(feature = "surfaces")]
mod map;
mod material;
mod output;
mod ranks;
#[cfg(feature = "sliding")]
mod sliding;
#[cfg(feature = "states")]
mod states;
mod step;
#[cfg(feature = "data")]
mod table;
#[cfg(feature = "text")]
mod text;
mod user;
#[cfg(feature = "adhesion")]
mod violation;

#[cfg(feature = "adhesion")]
pub use adhesion::AdhesionError;
#[cfg(feature = "checkpoint")]
pub use checkpoint::CheckpointError;
pub(crate) use checks::{
    LONGEST, count_within, exact_length, finite, in_order, least_length, length, non_negative, poisson_ratio, positive,
    within,
};
pub use convergence::{Convergence, Trend};
pub use coverage::Special;
pub use file::FileError;
#[cfg(feature = "friction")]
pub use friction::FrictionError;
pub use kernel::KernelError;
pub use kind::ErrorKind;
pub use load::LoadError;
#[cfg(feature = "surfaces")]
pub use map::MapError;
pub use material::MaterialError;
pub use output::OutputError;
pub use ranks::RanksError;
#[cfg(feature = "sliding")]
pub use sliding::SlidingError;
#[cfg(feature = "states")]
pub use states::StatesError;
pub use step::StepError;
#[cfg(feature = "data")]
pub use table::{Place, TableError};
#[cfg(feature = "text")]
pub use text::TextError;
pub use user::UserError;
pub(crate) use user::{Failure, or_failure_of};
#[cfg(feature = "laws")]
pub(crate) use violation::KIND_OF_LOAD;
#[cfg(feature = "adhesion")]
pub use violation::{Location, Verdict, Violation};

use crate::rounded::{rounded, without_noise};

/// Everything that can go wrong, with the numbers needed to correct it.
///
/// Every constructor validates its arguments, so an invalid model cannot be built; a
/// [`step`](crate::ViscoelasticContact::step) that fails leaves the contact as it was.
///
/// ```
/// use viscocontact::{Error, rheology::Maxwell};
///
/// let error = Maxwell::new(-1.0e6, 1.0e6).unwrap_err();
/// assert_eq!(error.to_string(), "shear modulus = -1000000.0 is not allowed: it must be finite and > 0");
/// ```
///
/// `Debug` prints the message and its causes, so that a program whose `main` returns [`Result`] ends with what to do.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene or request is not covered.
    #[error("{what} is not covered {special}: {remedy}")]
    NotCovered {
        /// What makes the scene special.
        special: Special,
        /// The request, or what the scene has.
        what: &'static str,
        /// What to do.
        remedy: &'static str,
    },

    /// A number is outside its allowed range, or not finite.
    #[error("{field} = {:?} is not allowed: it must be {allowed}", without_noise(*.value, .allowed))]
    OutOfRange {
        /// The quantity.
        field: &'static str,
        /// The value given.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },

    /// A count is outside its allowed range: cells of a grid, iterations of a solver.
    #[error("{field} = {value} is not allowed: it must be {allowed}")]
    CountOutOfRange {
        /// What is counted.
        field: &'static str,
        /// The count given.
        value: usize,
        /// The allowed range.
        allowed: &'static str,
    },

    /// More memory is needed than is available, or than can be addressed. Take fewer cells; a contact computes fewer
    /// of them by
    /// [`Settings::symmetry`](crate::contact::Settings::symmetry) and
    /// [`Settings::window`](crate::contact::Settings::window). [`Builder::memory`](crate::contact::Builder::memory)
    /// reports the need of a contact before it is built.
    #[error("{what} needs {bytes} bytes ({:.1} GB), more than is available: take fewer cells; a contact computes \
        fewer of them with Settings::symmetry and Settings::window", *.bytes as f64 * 1e-9)]
    OutOfMemory {
        /// What needs it.
        what: &'static str,
        /// Bytes needed; `u64::MAX` if there are more.
        bytes: u64,
    },

    /// A slice or table has the wrong length: a field needs one value per cell, a table enough to define a function,
    /// a step one load for each rigid body.
    #[error("{field}: {len} given, {}{expected} needed", if *.exact { "" } else { "at least " })]
    WrongLength {
        /// Which slice or table.
        field: &'static str,
        /// The length given.
        len: usize,
        /// The length needed.
        expected: usize,
        /// Whether exactly `expected` values are needed, or at least as many.
        exact: bool,
    },

    /// The values of a table are not in the required order.
    #[error("{field}[{index}] = {value:?} may not follow {previous:?}: the values must {rule}")]
    OutOfOrder {
        /// Which table.
        field: &'static str,
        /// Index of the first entry that breaks the order.
        index: usize,
        /// The entry.
        value: f64,
        /// The entry before it.
        previous: f64,
        /// The order required.
        rule: &'static str,
    },

    /// A load or a load history is not allowed.
    #[error(transparent)]
    Load(#[from] LoadError),

    /// A geometry returned NaN or −∞ for the gap of a cell; a gap must be finite, or +∞ where there is no body.
    #[error("the initial gap at cell [{}, {}], x = ({}, {}) m, is {value}: it must be finite, or +inf where there \
        is no body; points of a map that were not measured are filled by HeightMap::filled or left out by \
        HeightMap::masked", .cell[0], .cell[1], rounded(.position[0], 4), rounded(.position[1], 4))]
    InvalidGap {
        /// Indices of the cell.
        cell: [usize; 2],
        /// Centre of the cell \[m\].
        position: [f64; 2],
        /// The gap returned.
        value: f64,
    },

    /// A body can touch nothing: its gap is +∞ on every cell of the grid, or it is above another body everywhere.
    /// Compare its position and size with [`Grid::lengths`](crate::Grid::lengths).
    #[error(
        "body {body} is the lowest body with a finite gap on none of the {cells} cells of the grid: it can touch \
        nothing; compare its position and size with Grid::lengths"
    )]
    NothingToTouch {
        /// Index of the body.
        body: usize,
        /// Number of cells of the grid.
        cells: usize,
    },

    /// A [`Builder`](crate::contact::Builder) lacks a part that every contact needs.
    #[error("a contact needs {part}: call Builder::{part} before build")]
    Missing {
        /// The method of the builder that sets the part.
        part: &'static str,
    },

    /// An influence kernel is not allowed.
    #[error(transparent)]
    Kernel(#[from] KernelError),

    /// Friction in space is not covered, or was not found.
    #[cfg(feature = "friction")]
    #[error(transparent)]
    Friction(#[from] FrictionError),

    /// A steady motion was not found, or there is none.
    #[cfg(feature = "sliding")]
    #[error(transparent)]
    Sliding(#[from] SlidingError),

    /// A rheology or a material is not allowed, or lacks a property that is needed.
    #[error(transparent)]
    Material(#[from] MaterialError),

    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),

    /// A table in a text file cannot be read.
    #[cfg(feature = "text")]
    #[error(transparent)]
    Text(#[from] TextError),

    /// A table of measured data is not allowed.
    #[cfg(feature = "data")]
    #[error(transparent)]
    Table(#[from] TableError),

    /// A height map, or its file, is not allowed.
    #[cfg(feature = "surfaces")]
    #[error(transparent)]
    Map(#[from] MapError),

    /// A file of results cannot be written. The cause is the [`source`](std::error::Error::source) of the error.
    #[error(transparent)]
    Output(#[from] OutputError),

    /// A rank of a contact that [ranks](crate::parallel) share out has left or failed, or ranks do not agree.
    #[error(transparent)]
    Ranks(#[from] RanksError),
    /// A contact of surfaces that attract each other is not covered, not resolved, or comes off.
    #[cfg(feature = "adhesion")]
    #[error(transparent)]
    Adhesion(#[from] AdhesionError),
    /// A contact on elastic states is not covered by them.
    #[cfg(feature = "states")]
    #[error(transparent)]
    States(#[from] StatesError),

    /// A run cannot be resumed from a checkpoint.
    #[cfg(feature = "checkpoint")]
    #[error("no run can be resumed from {}: {cause}", .path.display())]
    Checkpoint {
        /// The file.
        path: std::path::PathBuf,
        /// Why not.
        cause: CheckpointError,
    },

    /// A step of a contact failed, or a run of steps. The contact is as it was.
    #[error(transparent)]
    Step(#[from] StepError),

    /// A [`Snapshot`](crate::contact::Snapshot), or a history of the stress, is of another contact.
    #[error("{what} was taken of another contact: {remedy}")]
    OtherContact {
        /// What was made of another contact.
        what: &'static str,
        /// What to do.
        remedy: &'static str,
    },

    /// A [`Study`](crate::study::Study) found no domain that holds the contact: none is large enough.
    #[cfg(feature = "study")]
    #[error(
        "no domain was found that holds the contact (the last one tried was {length:.1e} m wide): check geometry \
        and load"
    )]
    NoDomain {
        /// Side of the last domain tried \[m\].
        length: f64,
    },

    /// A function that you wrote could not give a value: a load history, a gap or a creep function. Its error is the
    /// [`source`](std::error::Error::source).
    #[error(transparent)]
    User(#[from] UserError),

    /// The caller ended the call: by its report of progress, or the flag of
    /// [`Run::cancelled_by`](crate::run::Run::cancelled_by).
    #[error("{what} was cancelled by its caller")]
    Cancelled {
        /// The call.
        what: &'static str,
    },
}

impl Error {
    /// A snapshot that is not of the contact to be restored.
    pub(crate) const OF_OTHER_CONTACT: Error = Error::OtherContact {
        what: "the snapshot",
        remedy: "only snapshots of the contact or of a clone can be restored",
    };
}

/// The result of every fallible call of the crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;
