//! The contact problem of one step, and its solver.

mod active_set;
mod bands;
mod cold_start;
mod contact_set;
mod extension;
mod outcome;
mod passes;
mod preconditioner;
mod problem;
mod resting_position;
mod rigid_motion;
mod row_segments;
#[cfg(feature = "observe")]
mod stiffness;

pub(crate) use active_set::ActiveSet;
pub(crate) use bands::Bands;
pub(crate) use extension::{Extension, ExtensionKind, HaloExchange, HaloRows};
pub(crate) use outcome::{Outcome, PENETRATION_SLACK};
pub(crate) use problem::{Counts, Problem, Solution, Solve, Stop};
pub(crate) use resting_position::RestingPosition;
pub(crate) use rigid_motion::{Freedom, Gram, ModeCoefficients, Modes, RigidMotion, dot};
#[cfg(feature = "observe")]
pub(crate) use stiffness::{FLAT_PUNCH_TOLERANCE, flat_punch};

use bands::BandSums;
use cold_start::{balance, cold_start, make_feasible, press_everywhere};
use contact_set::ContactSet;
use extension::Attenuation;
use outcome::ResidualSums;
use passes::{Passes, Search, add};
use preconditioner::Preconditioner;
use rigid_motion::RowModes;
use row_segments::{Cut, PIECE_CELLS, Piece, RowSegments};
