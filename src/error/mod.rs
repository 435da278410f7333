//! The error type of the crate, and the checks that return it.

#[cfg(feature = "checkpoint")]
mod checkpoint;
mod checks;
mod convergence;
mod debug;
mod kernel;
mod load;
mod map;
mod material;
mod output;
mod ranks;
mod states;
mod table;
mod text;
mod violation;

#[cfg(feature = "checkpoint")]
pub use checkpoint::CheckpointError;
pub(crate) use checks::{
    LONGEST, count_within, exact_length, finite, in_order, least_length, length, non_negative, positive, within,
};
pub use convergence::{Convergence, Trend};
pub use kernel::KernelError;
pub use load::LoadError;
pub use map::MapError;
pub use material::MaterialError;
pub use output::OutputError;
pub use ranks::RanksError;
pub use states::StatesError;
pub use table::{Place, TableError};
pub use text::TextError;
pub use violation::{Location, Verdict, Violation};

use crate::axis::Axis;
use crate::rounded::{TIME, rounded};

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
/// `Debug` prints the message and its causes, so that a program whose `main` returns [`Result`] ends with what to do; `{:#?}`
/// prints the fields.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is outside its allowed range, or not finite.
    #[error("{field} = {value:?} is not allowed: it must be {allowed}")]
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

    /// More memory is needed than is available, or than can be addressed. Take fewer cells, or compute fewer of them by
    /// [`Settings::symmetry`](crate::contact::Settings::symmetry) and
    /// [`Settings::window`](crate::contact::Settings::window). [`Builder::memory`](crate::contact::Builder::memory)
    /// reports the need of a contact before it is built.
    #[error("{what} needs {bytes} bytes ({:.1} GB), more than is available: take fewer cells, or compute fewer of them with Settings::symmetry and Settings::window", *.bytes as f64 * 1e-9)]
    OutOfMemory {
        /// What needs it.
        what: &'static str,
        /// Bytes needed; `u64::MAX` if there are more.
        bytes: u64,
    },

    /// A slice or table has the wrong length: a field needs one value per cell, a table enough to define a function, a step
    /// one load for each rigid body.
    #[error("{field} holds {len} values, but needs {}{expected}", if *.exact { "" } else { "at least " })]
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
    #[error("{field}[{index}] = {value} may not follow {previous}: the values must {rule}")]
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

    /// A force acts outside the convex hull of the cells that the body may touch, so that no pressure balances it.
    #[error("at t = {time} s the load acts at ({:e}, {:e}) m, outside the convex hull of the cells that body {body} may touch: it would tip over", .at[0], .at[1], time = rounded(*.time, TIME))]
    LoadOutsideHull {
        /// End of the step \[s\].
        time: f64,
        /// Index of the body.
        body: usize,
        /// The point at which the load acts \[m\]; 0 along an axis whose tilt is prescribed, where it does not matter.
        at: [f64; 2],
    },

    /// A geometry returned NaN or −∞ for the gap of a cell; a gap must be finite, or +∞ where there is no body.
    #[error("the initial gap at cell [{}, {}], x = ({:e}, {:e}) m, is {value}: it must be finite, or +inf where there is no body", .cell[0], .cell[1], .position[0], .position[1])]
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
        "body {body} is the lowest body with a finite gap on none of the {cells} cells of the grid: it can touch nothing"
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

    /// A load tilts a body along an axis along which the bodies are periodic.
    #[error("at t = {time} s the load tilts the body along {axis}, along which the bodies are periodic: a tilted body is not", time = rounded(*.time, TIME))]
    TiltOfPeriodic {
        /// End of the step \[s\].
        time: f64,
        /// The axis.
        axis: Axis,
    },

    /// A call needs the grid in the other [`Frame`](crate::contact::Frame): fixed to the indenter for a step over the
    /// bodies, fixed to the bodies for a path or a direct sum.
    #[error("{what} is not possible in the frame that Settings::frame chooses: choose the other Frame")]
    WrongFrame {
        /// The call.
        what: &'static str,
    },

    /// An approach exceeds the approach of full contact on a surface whose mean displacement is fixed
    /// ([`InfluenceKernel::periodic`](crate::InfluenceKernel::periodic)): no pressure closes the gap further.
    #[error(
        "at t = {time} s the approach {approach:e} m is not below {greatest:e} m, that of full contact, which no pressure can exceed on a periodic body: prescribe the force", time = rounded(*.time, TIME))]
    BeyondFullContact {
        /// End of the step \[s\].
        time: f64,
        /// The approach prescribed \[m\].
        approach: f64,
        /// The approach of full contact \[m\].
        greatest: f64,
    },

    /// The body has no elastic response (J(0) = 0, as Kelvin–Voigt). It cannot follow a jump of the load, a step of
    /// length zero, unless the jump removes the load or the present state already satisfies it; nor is the paper's
    /// rectangle rule possible. Ramp the load over a short time, or give the body a glassy compliance.
    #[error(
        "at t = {time} s: {what} needs an elastic response, but the material has none (its compliance at t = 0 is zero); ramp the load over a short time or add a glassy compliance", time = rounded(*.time, TIME))]
    NoElasticResponse {
        /// Time of the contact \[s\].
        time: f64,
        /// The call.
        what: &'static str,
    },

    /// A rheology or a material is not allowed, or lacks a property that is needed.
    #[error(transparent)]
    Material(#[from] MaterialError),

    /// The loading time exceeds the range in which the material is known: the data of a table, or the times that a
    /// series was fitted over. Give [`Builder::times`](crate::contact::Builder::times) a longer range, or extrapolate
    /// the table.
    #[error(
        "at t = {time} s the loading time {age} s exceeds the range in which the material is known, {known_until} s: fit its series over longer times (Builder::times), or extrapolate its table", time = rounded(*.time, TIME), age = rounded(*.age, TIME))]
    BeyondMaterial {
        /// End of the step \[s\].
        time: f64,
        /// Loading time: time since the bodies were undisturbed \[s\].
        age: f64,
        /// [`Rheology::known_until`](crate::rheology::Rheology::known_until) \[s\].
        known_until: f64,
    },

    /// The history of a direct sum would exceed [`Settings::history_limit`](crate::contact::Settings). Raise the limit,
    /// or use [`TimeRule::Exponential`](crate::contact::TimeRule::Exponential), whose memory does not grow.
    #[error(
        "at t = {time} s the direct sum over {steps} past steps would take {bytes} bytes, more than Settings::history_limit = {limit}: raise it, or use TimeRule::Exponential, whose memory does not grow", time = rounded(*.time, TIME))]
    HistoryFull {
        /// End of the step \[s\].
        time: f64,
        /// Number of past steps.
        steps: usize,
        /// Bytes that the history would take with this step.
        bytes: usize,
        /// Bytes allowed.
        limit: usize,
    },

    /// A file cannot be read, or does not have its format.
    #[error("{file}: {reason}")]
    Unreadable {
        /// Its name, or its format if it has none.
        file: String,
        /// The message of the system or the reader.
        reason: String,
        /// The kind of the system's error; `None` if the contents cannot be read.
        kind: Option<std::io::ErrorKind>,
    },

    /// A table in a text file cannot be read.
    #[error(transparent)]
    Text(#[from] TextError),
    /// A table of measured data is not allowed.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A height map, or its file, is not allowed.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A file of results cannot be written. The cause is the [`source`](std::error::Error::source) of the error.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A contact that [ranks](crate::parallel) share out does not support the call, or a rank has left or failed.
    #[error(transparent)]
    Ranks(#[from] RanksError),
    /// A contact on elastic states is not covered by them.
    #[error(transparent)]
    States(#[from] StatesError),

    /// Something other than a regular file exists at the path. It is left unchanged: only regular files are replaced.
    #[error("{path} cannot be written: it is {kind}, not a regular file")]
    NotAFile {
        /// The path.
        path: String,
        /// What exists there.
        kind: &'static str,
    },

    /// The extension of a file names no format that can be written.
    #[error("{path}: the extension must be .{}", .allowed.join(" or ."))]
    Extension {
        /// The file.
        path: String,
        /// The extensions allowed, without the point.
        allowed: &'static [&'static str],
    },

    /// A run cannot be resumed from a checkpoint. The cause is the [`source`](std::error::Error::source) of the error.
    #[cfg(feature = "checkpoint")]
    #[error("no run can be resumed from {}", .path.display())]
    Checkpoint {
        /// The file.
        path: std::path::PathBuf,
        /// The cause.
        source: CheckpointError,
    },

    /// Contact reaches the edge of the grid, beyond which the bodies continue: the pressure there would be wrong.
    /// Enlarge the grid, or choose [`Edge::Allow`](crate::contact::Edge::Allow) if the body really ends at the edge of
    /// the grid.
    #[error(
        "at t = {time} s the contact touches the edge of the grid on {cells} cells: enlarge the grid, or set Settings::edge to Edge::Allow if the body ends there", time = rounded(*.time, TIME))]
    ContactAtEdge {
        /// End of the step \[s\].
        time: f64,
        /// Number of cells in contact along the edge.
        cells: usize,
    },

    /// The contact of an [`AxisymmetricContact`](crate::analytic::AxisymmetricContact) reaches the end of its
    /// foundation: make it longer.
    #[error("at t = {time} s the contact reaches the end of the foundation, {reach:e} m from the axis: make it longer", time = rounded(*.time, TIME))]
    BeyondReach {
        /// End of the step \[s\].
        time: f64,
        /// Length of the foundation \[m\].
        reach: f64,
    },

    /// The solver did not converge within [`Settings::max_iterations`](crate::contact::Settings::max_iterations); the
    /// residual history suggests a remedy.
    #[error(
        "at t = {time} s (step of {dt} s): residual {residual:e} after {iterations} iterations, above the tolerance {tolerance:e}; {convergence}", time = rounded(*.time, TIME), dt = rounded(*.dt, TIME))]
    NotConverged {
        /// End of the step \[s\].
        time: f64,
        /// Length of the step \[s\].
        dt: f64,
        /// Iterations done.
        iterations: usize,
        /// Residual reached.
        residual: f64,
        /// Residual allowed.
        tolerance: f64,
        /// The residual history.
        convergence: Box<Convergence>,
    },

    /// A [`Snapshot`](crate::contact::Snapshot) was taken of another contact, not of this one or a clone of it.
    #[error("the snapshot was taken of another contact: only snapshots of the contact or of a clone can be restored")]
    OtherContact,

    /// The load of a steady motion brings no cell into contact.
    #[error("at t = {time} s the load brings no cell into contact: a steady motion needs contact", time = rounded(*.time, TIME))]
    NoContact {
        /// Time of the contact \[s\].
        time: f64,
    },

    /// The motion did not become steady. Contact that comes and goes, as on a rough surface that moves with the bodies,
    /// has no steady state; otherwise allow a greater change.
    #[error(
        "after {distance:e} m the pressure still changes by {change:e} over a contact length, more than {tolerance:e}"
    )]
    NotSteady {
        /// Distance travelled \[m\].
        distance: f64,
        /// Relative change of the pressure.
        change: f64,
        /// Relative change allowed.
        tolerance: f64,
    },

    /// A [`Plan`](crate::plan::Plan) found no domain that holds the contact: none is large enough.
    #[error(
        "no domain was found that holds the contact (the last one tried was {length:e} m wide): check geometry and load"
    )]
    NoDomain {
        /// Side of the last domain tried \[m\].
        length: f64,
    },

    /// The caller ended the call: by its report of progress, or the flag of
    /// [`Run::cancelled_by`](crate::contact::Run::cancelled_by).
    #[error("{what} was cancelled by its caller")]
    Cancelled {
        /// The call.
        what: &'static str,
    },

    /// The allowed error in time needs a step below the resolution of `f64` at this time: the load changes too fast, or
    /// the tolerance is too small.
    #[error(
        "at t = {time} s a step of {dt:e} s would be needed to keep the error in time below {tolerance:e}: it is shorter than f64 resolves at this time", time = rounded(*.time, TIME))]
    StepTooShort {
        /// Time of the contact \[s\].
        time: f64,
        /// Length of the step \[s\].
        dt: f64,
        /// Error in time allowed.
        tolerance: f64,
    },

    /// A quantity overflowed in a step: the scales of lengths, moduli, loads and times are too far apart for `f64`.
    #[error("at t = {time} s: {what} is not finite; the scales of the scene are too far apart for f64", time = rounded(*.time, TIME))]
    Overflow {
        /// End of the step \[s\].
        time: f64,
        /// The quantity that overflowed.
        what: &'static str,
    },
}

/// The result of every fallible call of the crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;
