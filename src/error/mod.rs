//! The one error type of the crate, and the checks that raise it.

#[cfg(feature = "checkpoint")]
mod checkpoint;
mod checks;
mod convergence;
mod kernel;
mod load;
mod map;
mod material;
mod table;

#[cfg(feature = "checkpoint")]
pub use checkpoint::CheckpointError;
pub(crate) use checks::{LONGEST, exact_length, finite, least_length, length, non_negative, positive, within};
pub use convergence::{Convergence, Trend};
pub use kernel::KernelError;
pub use load::LoadError;
pub use map::MapError;
pub use material::MaterialError;
pub use table::{Place, TableError};

/// What went wrong, with the numbers needed to mend it.
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
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside the range its meaning allows, or is not finite.
    #[error("{field} = {value:?} is not allowed: it must be {allowed}")]
    OutOfRange {
        /// What the number stands for.
        field: &'static str,
        /// The number given.
        value: f64,
        /// The range it must lie in.
        allowed: &'static str,
    },

    /// A count lies outside the allowed range: cells of a grid, iterations of a solver.
    #[error("{field} = {value} is not allowed: it must be {allowed}")]
    CountOutOfRange {
        /// What is counted.
        field: &'static str,
        /// The count given.
        value: usize,
        /// The range it must lie in.
        allowed: &'static str,
    },

    /// Something needs more memory than there is, or than may be addressed. Take fewer cells; a contact computes fewer of them by
    /// [`Settings::symmetry`](crate::contact::Settings::symmetry) and [`Settings::window`](crate::contact::Settings::window), and tells what it takes before
    /// it is built ([`Builder::memory`](crate::contact::Builder::memory)).
    #[error("{what} needs {bytes} bytes ({:.1} GB), more than there is: take fewer cells, or let symmetry and window of the Settings compute fewer of them", *.bytes as f64 * 1e-9)]
    OutOfMemory {
        /// What was to be made.
        what: &'static str,
        /// The bytes that it needs; `u64::MAX` where they are more.
        bytes: u64,
    },

    /// A slice or table does not have the length it needs: a field of one value a cell, two slices that belong together, a table too short to define a
    /// function.
    #[error("{field} holds {len} values, but needs {expected}{}", if *.exact { "" } else { " at least" })]
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

    /// A table that must be in order is not.
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
        /// The order that the values must keep.
        rule: &'static str,
    },

    /// A load or a load history is not allowed.
    #[error(transparent)]
    Load(#[from] LoadError),

    /// A force acts at a point where no pressure can balance it: outside the convex hull of the cells that the body may touch, so that it would topple.
    #[error("at t = {time} s the load acts at ({:e}, {:e}) m, outside the convex hull of the cells that body {body} may touch: it would topple", .at[0], .at[1])]
    LoadOutsideHull {
        /// End of the step \[s\].
        time: f64,
        /// The body, 0 for the only one.
        body: usize,
        /// The point at which the load acts \[m\]; a coordinate whose tilt is given does not matter and is 0.
        at: [f64; 2],
    },

    /// The number of loads of a step is not the number of rigid bodies.
    #[error("{loads} loads are given for {bodies} rigid bodies")]
    WrongNumberOfLoads {
        /// Loads given.
        loads: usize,
        /// Bodies of the contact.
        bodies: usize,
    },

    /// The number of geometries is not the number of rigid bodies that the contact was built with.
    #[error("{given} geometries are given for {bodies} rigid bodies")]
    WrongNumberOfBodies {
        /// Geometries given.
        given: usize,
        /// Bodies of the contact.
        bodies: usize,
    },

    /// A geometry returned NaN or −∞ for the gap of a cell; allowed are finite gaps and +∞ (nothing there).
    #[error("the initial gap at cell [{}, {}], x = ({:e}, {:e}) m, is {value}: it must be finite, or +inf where there is nothing to touch", .cell[0], .cell[1], .position[0], .position[1])]
    InvalidGap {
        /// Indices of the cell.
        cell: [usize; 2],
        /// Centre of the cell \[m\].
        position: [f64; 2],
        /// The gap returned.
        value: f64,
    },

    /// The geometry of a body is +∞ on every cell of the grid, or lies above another body everywhere: it has nothing to touch. Check its position and size
    /// against [`Grid::lengths`](crate::Grid::lengths).
    #[error(
        "body {body} has no cell with a finite initial gap of its own: it can touch nothing on the {cells} cells of the grid"
    )]
    NothingToTouch {
        /// The body, 0 for the only one.
        body: usize,
        /// Number of cells of the grid.
        cells: usize,
    },

    /// A [`Builder`](crate::contact::Builder) was asked to build without a part it needs.
    #[error("a contact needs {part}: call Builder::{part} before build")]
    Missing {
        /// The method of the builder that supplies the part.
        part: &'static str,
    },

    /// An influence kernel is not allowed.
    #[error(transparent)]
    Kernel(#[from] KernelError),

    /// A body may not tilt against a surface that is periodic along the axis of its tilt.
    #[error("at t = {time} s the load tilts the body along x{}, along which the bodies are periodic: a tilted plane is not", .axis + 1)]
    TiltOfPeriodic {
        /// End of the step \[s\].
        time: f64,
        /// The axis, 0 or 1.
        axis: usize,
    },

    /// Something needs the grid to be fixed to the other of indenter and bodies ([`Frame`](crate::contact::Frame)): a step over the bodies to the indenter, a
    /// path or a direct sum to the bodies.
    #[error("{what} is not possible with the grid fixed to what Settings::frame says: choose the other Frame")]
    WrongFrame {
        /// What was asked for.
        what: &'static str,
    },

    /// An approach lies beyond full contact on a surface whose mean displacement is held ([`InfluenceKernel::periodic`](crate::InfluenceKernel::periodic)):
    /// no pressure closes the gap further.
    #[error(
        "at t = {time} s the approach {approach:e} m is not below {greatest:e} m, that of full contact, which no pressure can exceed on a periodic body: control the force"
    )]
    BeyondFullContact {
        /// End of the step \[s\].
        time: f64,
        /// The approach asked for \[m\].
        approach: f64,
        /// The approach of full contact \[m\].
        greatest: f64,
    },

    /// The body has no elastic response (J(0) = 0, as Kelvin–Voigt): it cannot follow a jump of the load, a step of length zero, unless nothing presses it
    /// after the jump or the load is what the present state satisfies already; nor is the paper's rectangle rule possible. Ramp the load over a short time,
    /// or give the body a glassy compliance.
    #[error(
        "at t = {time} s: {what} needs an elastic response, but the material has none (its compliance at t = 0 is zero); ramp the load over a short time or add a glassy compliance"
    )]
    NoElasticResponse {
        /// Time of the contact \[s\].
        time: f64,
        /// What was asked for.
        what: &'static str,
    },

    /// A rheology or a material is not allowed, or lacks what is needed.
    #[error(transparent)]
    Material(#[from] MaterialError),

    /// A step would look further into the past of the material than it is known: beyond the data of a table, or beyond the times that a series was fitted
    /// over. Give [`Builder::times`](crate::contact::Builder::times) a longer range, or let the table be extrapolated.
    #[error(
        "at t = {time} s the bodies remember {age} s, but the material is known for {known_until} s only: fit its series over longer times (Builder::times), or let its table be extrapolated"
    )]
    BeyondMaterial {
        /// End of the step \[s\].
        time: f64,
        /// Time since the bodies were undisturbed \[s\].
        age: f64,
        /// [`Rheology::known_until`](crate::rheology::Rheology::known_until) \[s\].
        known_until: f64,
    },

    /// A step is shorter than the times that the series of the material was fitted over, which the first step chose by its own length. Say from the start
    /// which times matter: [`Builder::times`](crate::contact::Builder::times).
    #[error(
        "at t = {time} s: a step of {dt:e} s is shorter than the material's series resolves, {known_from:e} s, as the first step chose it: say with Builder::times which times matter"
    )]
    BelowMaterial {
        /// End of the step \[s\].
        time: f64,
        /// Length of the step \[s\].
        dt: f64,
        /// Shortest time that the series was fitted to \[s\].
        known_from: f64,
    },

    /// The past of a direct sum has filled the memory that [`Settings::history_limit`](crate::contact::Settings) allows. Raise it, or use
    /// [`TimeRule::Automatic`](crate::contact::TimeRule::Automatic), whose memory does not grow.
    #[error(
        "at t = {time} s the direct sum over {steps} past steps would take {bytes} bytes, more than Settings::history_limit = {limit}: raise it, or use TimeRule::Automatic, whose memory does not grow"
    )]
    HistoryFull {
        /// End of the step \[s\].
        time: f64,
        /// Steps in the past.
        steps: usize,
        /// Bytes the past would take with this step.
        bytes: usize,
        /// Bytes allowed.
        limit: usize,
    },

    /// A table of measured data is not one that a body could have given.
    #[error(transparent)]
    Table(#[from] TableError),

    /// A map of heights, or a file of one, is not what a measurement could have given.
    #[error(transparent)]
    Map(#[from] MapError),

    /// A file of results cannot be written: the medium, the permissions, or what stands there already.
    #[error("{path} cannot be written: {what}")]
    Output {
        /// The file or folder.
        path: String,
        /// What stood in the way.
        what: String,
    },

    /// What stands at the path is no regular file, and is left alone: only files are replaced.
    #[error("{path} cannot be written: {kind} is there, not a file")]
    NotAFile {
        /// The path.
        path: String,
        /// What is there.
        kind: &'static str,
    },

    /// A checkpoint cannot be continued from.
    #[cfg(feature = "checkpoint")]
    #[error("{path}: {source}")]
    Checkpoint {
        /// The file.
        path: String,
        /// Why not.
        source: CheckpointError,
    },

    /// Contact reaches the edge of the grid, beyond which the bodies go on: the pressure there would be wrong. Enlarge the grid, or allow it with
    /// [`Edge::Allow`](crate::contact::Edge::Allow) where the body really ends at the grid's edge.
    #[error(
        "at t = {time} s the contact touches the edge of the grid on {cells} cells: enlarge the grid, or set Settings::edge to Edge::Allow if the body ends there"
    )]
    ContactAtEdge {
        /// End of the step \[s\].
        time: f64,
        /// Number of cells in contact along the edge.
        cells: usize,
    },

    /// The contact of an [`AxisymmetricContact`](crate::analytic::AxisymmetricContact) reaches the end of its foundation: give it a longer one.
    #[error("at t = {time} s the contact reaches the end of the foundation, {reach:e} m from the axis: make it longer")]
    BeyondReach {
        /// End of the step \[s\].
        time: f64,
        /// Length of the foundation \[m\].
        reach: f64,
    },

    /// The contact problem of a step was not solved within [`Settings::max_iterations`](crate::contact::Settings::max_iterations): what to do, the history of
    /// the residual says.
    #[error(
        "at t = {time} s (step of {dt} s): residual {residual:e} after {iterations} iterations, above the tolerance {tolerance:e}; {convergence}"
    )]
    NotConverged {
        /// End of the step \[s\].
        time: f64,
        /// Length of the step \[s\].
        dt: f64,
        /// Iterations done.
        iterations: usize,
        /// Residual reached.
        residual: f64,
        /// Residual asked for.
        tolerance: f64,
        /// The residual over the iterations.
        convergence: Box<Convergence>,
    },

    /// A [`Snapshot`](crate::contact::Snapshot) is of another contact than the one to be restored: not of it, nor of a clone.
    #[error("the snapshot is of another contact: only a contact's own, or a clone's, can be restored")]
    OtherContact,

    /// A steady motion needs contact, and its load makes none.
    #[error("at t = {time} s the load does not make the bodies touch: a steady motion needs contact")]
    NoContact {
        /// Time of the contact \[s\].
        time: f64,
    },

    /// A steady motion does not become steady: where contact comes and goes, as on a rough surface that moves with the bodies, it has no steady state; else
    /// allow a greater change.
    #[error(
        "after {distance:e} m the pressure still changes by {change:e} over a length of contact, more than {tolerance:e}"
    )]
    NotSteady {
        /// Distance travelled \[m\].
        distance: f64,
        /// Relative change of the pressure.
        change: f64,
        /// Change allowed.
        tolerance: f64,
    },

    /// A [`Plan`](crate::plan::Plan) found no domain that the contact fills: it is never touched, or never ends.
    #[error(
        "no domain was found that holds the contact (the last one tried was {length:e} m wide): check geometry and load"
    )]
    NoDomain {
        /// Side of the last domain tried \[m\].
        length: f64,
    },

    /// The error in time asks for a step too short to change the time: the load changes faster than time itself is resolved, or the tolerance is too small.
    #[error(
        "at t = {time} s a step of {dt:e} s would be needed to keep the error in time below {tolerance:e}, too short to change the time"
    )]
    StepTooShort {
        /// Time of the contact \[s\].
        time: f64,
        /// Length of the step \[s\].
        dt: f64,
        /// Error in time asked for.
        tolerance: f64,
    },

    /// Numbers left the range of `f64` inside a step: the scales of the scene (lengths, moduli, loads, times) are too far apart to be represented.
    #[error("at t = {time} s: {what} is not finite; the scales of the scene are too far apart for f64")]
    Overflow {
        /// End of the step \[s\].
        time: f64,
        /// The quantity that overflowed.
        what: &'static str,
    },
}

/// The result of every fallible call of the crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;
