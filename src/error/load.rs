use crate::rounded::{TIME, rounded};

/// What is wrong with a load or a load history.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Two loads of a history cannot be interpolated because they control different quantities.
    #[error(
        "the {field} mixes loads of different kinds ({first}; {second}), which cannot be interpolated: take loads \
        of one kind, and a run for each kind"
    )]
    MixedKinds {
        /// Which history or table.
        field: &'static str,
        /// Kind of the first load.
        first: String,
        /// Kind of the load that differs.
        second: String,
    },

    /// The kind of load is not the one that a reference solution needs.
    #[error("{field} needs {needed}, not {given}")]
    WrongKind {
        /// What takes the load.
        field: &'static str,
        /// The kind of load it needs.
        needed: &'static str,
        /// The kind of load given.
        given: &'static str,
    },

    /// A load history returned a breakpoint that is not later than the requested time
    /// ([`LoadHistory::next_breakpoint`](crate::load::LoadHistory::next_breakpoint)).
    #[error(
        "the load history returned {breakpoint} s as the first breakpoint after t = {after} s: it must be later; \
        compare times with the breakpoints themselves (guide::own_models)"
    )]
    InvalidBreakpoint {
        /// The time asked for \[s\].
        after: f64,
        /// The breakpoint returned \[s\].
        breakpoint: f64,
    },

    /// A load history returned a value that no load can have, at the end of a step or at a time within it.
    #[error("the load history returned {field} = {value:?} at t = {time} s: it must be {allowed}", time = rounded(*.time, TIME))]
    OutOfRange {
        /// The time asked for \[s\].
        time: f64,
        /// The quantity.
        field: &'static str,
        /// The value returned.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },
}
