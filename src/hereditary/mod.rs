//! Hereditary integral (Eq. 9 and Eq. 10 of the paper): the part of the displacement at the end of a step that
//! follows from the past.
//!
//! Every time rule writes the displacement at the end of a step as
//!
//! u = u_old + c K p,
//!
//! with one number c, the compliance of the step, and one field u_old. The contact problem of the step is then the
//! problem of an elastic body. [`History`] is the one interface to this: a step predicts c and u_old, responds to a
//! pressure, and is committed when it is accepted. One rule is behind it, of which the error
//! of a step is estimated, too (`time_error`); bodies that move under the grid apply it to sources:
//!
//! * [`ExponentialRule`]: a recursion with one field per relaxation time, updated in place; stable for steps of any
//!   length. Within a step u is a polynomial of time, see [`Interpolant`].
//! * [`MovingFrame`](moving_frame::MovingFrame): the exponential rule for the field whose convolution is the
//!   displacement, so that the bodies can move under the grid.
//!
//! [`RememberedField`] is a field at the start of a step and at its end, with its past. It serves the displacement, the far
//! field of a window, and the moving frame alike.

#[cfg(feature = "energies")]
mod branch_energies;
mod error_factors;
mod error_weight;
mod exponential_rule;
mod field;
#[cfg(any(feature = "friction", feature = "states"))]
mod group_history;
mod history;
mod interval;
mod kink;
mod lasting_error;
mod moments;
mod moving_frame;
mod outlook;
mod remembered_field;
#[cfg(test)]
mod rule_tests;
mod time_error;

#[cfg(feature = "energies")]
pub(crate) use branch_energies::BranchEnergies;
pub(crate) use error_factors::ERROR_FACTORS;
pub(crate) use exponential_rule::{ExponentialRule, Interpolant};
pub(crate) use field::{Field, Role};
#[cfg(feature = "checkpoint")]
pub(crate) use field::{interleaved, runs};
#[cfg(any(feature = "friction", feature = "states"))]
pub(crate) use group_history::GroupHistory;
pub(crate) use history::History;
pub(crate) use interval::{HistoryInputs, Interval};
pub(crate) use lasting_error::LastingError;
pub(crate) use outlook::{Meeting, Outlook};
pub(crate) use time_error::{ErrorMeasure, TimeError};
