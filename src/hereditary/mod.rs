//! The memory of the bodies: what of the displacement at the end of a step is already decided by the
//! past.
//!
//! Every time rule writes the displacement at the end of a step as
//!
//! u = u_old + c K p,
//!
//! with one number c, the compliance of the step, and one field u_old. The contact problem of the step
//! is then that of an elastic body. Two ways to keep the past:
//!
//! * [`Exponential`]: one field for each relaxation time, updated in place; second order, safe for
//!   steps of any length.
//! * [`Direct`]: every past increment of v = K p, summed anew at each step with weights from C(t);
//!   needs no exponential series, and serves the paper's rectangle rule and the backward rule.
//! * [`Sources`]: the exponential rule for what causes the displacement, so that the bodies can move under the grid.
//!
//! A rheology without an exact series starts as [`Unfitted`], unless the scene says over which times it is wanted.

mod direct;
mod exponential;
mod sources;
mod unfitted;

pub(crate) use direct::{Direct, Weighting};
pub(crate) use exponential::Exponential;
pub(crate) use sources::Sources;
pub(crate) use unfitted::Unfitted;

use crate::error::{Error, Result};
use crate::rheology::Material;

/// The past of one contact.
#[derive(Debug, Clone)]
pub(crate) enum History {
    Exponential(Exponential),
    Direct(Direct),
    Unfitted(Box<Unfitted>),
    Sources(Box<Sources>),
}

impl History {
    /// Writes u_old of a step of length `dt` that ends at `time` over `u_old`, given the displacement at its
    /// start, and returns c, which is 0 in jumps of bodies without elastic response. After a commit, `u_old` must still
    /// hold the displacement at the start of the step committed.
    pub(crate) fn predict(&mut self, time: f64, dt: f64, displacement: &[f64], u_old: &mut [f64]) -> Result<f64> {
        match self {
            History::Exponential(history) => Ok(history.predict(dt, displacement, u_old)),
            History::Direct(history) => {
                let c = history.predict(time, dt, u_old)?;
                if c == 0.0 {
                    u_old.copy_from_slice(displacement); // the sum is the same but for rounding
                }
                Ok(c)
            }
            History::Unfitted(history) => history.predict(dt, displacement, u_old),
            // u_old is a convolution away
            History::Sources(history) => Ok(history.predict(dt, [0; 2])),
        }
    }

    /// The error of a jump that a body without elastic response cannot follow.
    pub(crate) fn no_elastic_response(&self, time: f64) -> Error {
        let what = match self {
            History::Unfitted(_) => {
                "a jump of the load that changes the pressure (ramp the load over a short time, or say with Builder::times from which time on the body creeps)"
            }
            _ => "a jump of the load that changes the pressure (ramp the load over a short time instead)",
        };
        Error::NoElasticResponse { time, what }
    }

    /// Whether the displacement itself is part of the memory, rather than computed anew from v.
    pub(crate) fn keeps_displacement(&self) -> bool {
        match self {
            History::Exponential(history) => history.remembers(),
            History::Direct(_) => false,
            History::Sources(history) => history.remembers(),
            History::Unfitted(_) => true,
        }
    }

    /// Takes the step that was predicted last into the past; `touched` tells whether anything has ever been displaced.
    /// Returns the material whose series was fitted for it, and the times of the fit.
    pub(crate) fn commit(&mut self, change: &Change<'_>, touched: bool) -> Option<(Material, [f64; 2])> {
        match self {
            History::Exponential(history) => history.commit(),
            History::Direct(history) if touched => history.commit(change),
            History::Direct(_) => {}
            History::Sources(history) => history.commit(),
            History::Unfitted(history) => {
                let fitted = history.commit(touched)?;
                *self = History::Exponential(fitted.history);
                return Some((fitted.material, fitted.times));
            }
        }
        None
    }

    /// Takes over another's values, in its own memory where there is a field for each relaxation time.
    pub(crate) fn copy_from(&mut self, other: &History) {
        match (self, other) {
            (History::Exponential(own), History::Exponential(other)) => own.copy_from(other),
            (History::Sources(own), History::Sources(other)) => own.copy_from(other),
            (own, other) => *own = other.clone(),
        }
    }

    /// Bytes of an undisturbed past on so many cells.
    pub(crate) fn bytes(&self, cells: usize) -> u128 {
        let a_cell = match self {
            History::Exponential(history) => 8 * history.branches(),
            History::Sources(history) => 40 + 16 * history.branches(),
            History::Direct(_) | History::Unfitted(_) => 0,
        };
        a_cell as u128 * cells as u128
    }

    /// An undisturbed past on so many cells.
    pub(crate) fn undisturbed_on(&mut self, cells: [usize; 2]) {
        match self {
            History::Exponential(history) => history.undisturbed_on(cells[0] * cells[1]),
            History::Direct(_) => {}
            History::Unfitted(history) => history.carry(cells[0] * cells[1]),
            History::Sources(history) => history.undisturbed_on(cells),
        }
    }

    /// Lets everything follow the step committed last, whose ends are `before` and `displacement`.
    pub(crate) fn settle(&mut self, before: &[f64], displacement: &[f64]) {
        if let History::Exponential(history) = self {
            history.settle(before, displacement);
        }
    }

    /// Says that the run lasts at least so long after its start \[s\].
    pub(crate) fn expect(&mut self, duration: f64) {
        if let History::Unfitted(history) = self {
            history.expected = history.expected.max(duration);
        }
    }
}

/// A step, and v = K p at both of its ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Change<'a> {
    pub(crate) time: f64,
    pub(crate) dt: f64,
    pub(crate) potential: [&'a [f64]; 2],
}
