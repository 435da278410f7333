//! The error type of the crate, and the checks that return it.

mod checks;
pub(crate) mod coverage;
mod debug;
mod kind;
mod output;
mod ranks;
mod refusal;
mod step;
mod user;
#[cfg(feature = "adhesion")]
mod violation;

pub(crate) use checks::{
    LONGEST, count_within, exact_length, finite, in_order, least_length, length, missing, non_negative,
    of_other_contact, poisson_ratio, positive, within,
};
pub(crate) use coverage::Special;
pub use kind::ErrorKind;
pub use output::OutputError;
pub use ranks::RanksError;
pub use refusal::Refusal;
pub use step::StepError;
pub use user::UserError;
pub(crate) use user::{Failure, or_failure_of};
#[cfg(feature = "laws")]
pub(crate) use violation::KIND_OF_LOAD;
#[cfg(feature = "adhesion")]
pub use violation::{Location, Verdict, Violation};

use crate::rounded::{TIME, rounded, without_noise};

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
        special: &'static str,
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

    /// A load history returned a value that no load can have, at the end of a step or at a time within it.
    #[error("the load history returned {field} = {value:?} at t = {time} s: it must be {allowed}", time = rounded(*.time, TIME))]
    LoadOutOfRange {
        /// The time asked for \[s\].
        time: f64,
        /// The quantity.
        field: &'static str,
        /// The value returned.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },

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

    /// The mesh does not resolve the zone in which the attraction acts.
    #[error(
        "the attraction acts over a zone of {cells:.2} cells at the edge of the contact, and at least {minimum} are \
        needed: take cells of at most {} m, or a range of at least {} m (a longer range at the same work of \
        separation changes the pull-off force of an elastic body by little while Tabor's number stays above 3; on \
        a creeping body it stands for a slower pull)",
        rounded(*.spacing, 3), rounded(*.range, 3)
    )]
    ZoneNotResolved {
        /// Cells in the zone: E* at once over the steepest slope of the attraction, or over w/ρ² if that is more, and
        /// over the side of a cell.
        cells: f64,
        /// Minimum number of cells.
        minimum: f64,
        /// Maximum side of a cell that resolves the zone \[m\].
        spacing: f64,
        /// Minimum range of the attraction that this mesh resolves \[m\].
        range: f64,
    },

    /// The load pulls harder than the surfaces hold: no state carries it. The contact stays as it was before the
    /// step; under a given approach ([`Load::approach`](crate::load::Load::approach)) it continues apart:
    ///
    /// ```
    /// use viscocontact::adhesion::ExponentialAttraction;
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(24, 8.0)?)
    ///     .geometry(&Sphere::new(1.0)?)
    ///     .material(Material::incompressible(Zener::relaxing(0.5, 0.25, 1.0)?))
    ///     .attraction(ExponentialAttraction::new(1.0, 1.0)?)
    ///     .settings(Settings::default().with_edge(Edge::Allow))
    ///     .build()?;
    /// contact.step(1.0, Load::force(1.0))?;
    /// // a pull that grows, until it separates the bodies
    /// let pulled_off = (1..).find_map(|k| contact.step(0.5, Load::force(-0.5 * f64::from(k))).err());
    /// let Some(Error::PulledOff { time, force }) = pulled_off else { panic!("{pulled_off:?}") };
    /// assert!(force < -4.0 && time == contact.time() + 0.5);
    /// // 20 R away nothing acts: the surface recovers
    /// contact.step(0.5, Load::approach(-20.0))?;
    /// assert!(contact.fields().is_separated());
    /// # Ok::<(), Error>(())
    /// ```
    #[error("at t = {} s the force of {} N pulls the bodies off: no contact carries it; go on under a given \
        approach, or with a spring", rounded(*.time, TIME), rounded(*.force, 5))]
    PulledOff {
        /// End of the step \[s\].
        time: f64,
        /// The force of the load \[N\].
        force: f64,
    },

    /// A force along the surface is more than friction carries.
    #[error("at t = {} s the {}", rounded(*.time, TIME), sliding(*.over_limit, *.direction))]
    Slides {
        /// End of the step \[s\].
        time: f64,
        /// The force over what is carried; in space, the forces in their ratio.
        over_limit: f64,
        /// In space, shifts and twist of the sliding motion, of the largest component 1.
        direction: Option<[f64; 3]>,
    },

    /// The pressure of an elastic contact falls somewhere while its load grows, so that its states are no family of
    /// contacts that only grow. [`ViscoelasticContact`](crate::ViscoelasticContact) computes such a scene.
    #[error(
        "between the levels {} and {} m² the pressure of the elastic contact falls by {} of the maximum pressure \
        somewhere, where at most {} is rounding: its elastic states do not superpose; step it with \
        ViscoelasticContact",
        rounded(.levels[0], 3), rounded(.levels[1], 3), rounded(*.fall, 3), rounded(*.allowed, 3)
    )]
    Shrinks {
        /// Levels between which the pressure falls \[m²\].
        levels: [f64; 2],
        /// Maximum fall of the pressure of a cell over the maximum pressure.
        fall: f64,
        /// Maximum fall that is taken for rounding.
        allowed: f64,
    },

    /// A file cannot be read, or does not have its format.
    #[error("{file} cannot be read: {reason}")]
    Unreadable {
        /// Its name, or its format if it has none.
        file: String,
        /// The message of the system or the reader.
        reason: String,
        /// The kind of the system's error; `None` if the contents cannot be read.
        kind: Option<std::io::ErrorKind>,
    },

    /// A file of results cannot be written. The cause is the [`source`](std::error::Error::source) of the error.
    #[error(transparent)]
    Output(#[from] OutputError),

    /// A run cannot be resumed from a checkpoint.
    #[error("no run can be resumed from {}: {cause}", .path.display())]
    Checkpoint {
        /// The file.
        path: std::path::PathBuf,
        /// Why not.
        cause: Refusal,
    },

    /// A rank of a contact that [ranks](crate::parallel) share out has left or failed, or ranks do not agree.
    #[error(transparent)]
    Ranks(#[from] RanksError),

    /// A step of a contact failed, or a run of steps. The contact is as it was.
    #[error(transparent)]
    Step(#[from] StepError),

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

    /// Anything else: [`Error::code`] tells which.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

impl Error {
    /// What was refused, by itself or in a checkpoint.
    fn refusal(&self) -> Option<&Refusal> {
        match self {
            Error::Refused(refusal) | Error::Checkpoint { cause: refusal, .. } => Some(refusal),
            _ => None,
        }
    }
}

/// What slides, by how much, and what to do.
fn sliding(over_limit: f64, direction: Option<[f64; 3]>) -> String {
    let times = rounded(over_limit, 5);
    match direction {
        None => format!(
            "force along the surface is {times} times what friction carries, f P: the body slides away; give less, or \
             prescribe its motion or a spring"
        ),
        Some(direction) => format!(
            "load along the surface is {times} times what friction carries: the body slides along {direction:?}; give \
             less, or prescribe its motion"
        ),
    }
}

/// The result of every fallible call of the crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;
