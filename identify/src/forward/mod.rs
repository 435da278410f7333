//! The force of a tip under any drive.

mod column;
mod cycle;
mod growth;
mod moments;
mod real;
mod roots;
mod tip;

use viscocontact::states::ElasticStates;

use crate::error::{Error, Result};
use crate::series::Prony;
use cycle::Cycle;
pub(crate) use growth::Term;
pub(crate) use real::{Dual, LANES, Real};
pub(crate) use roots::{Roots, root};
use tip::Tip;

/// A drive beyond the contact point \[m\] at times \[s\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive<'a, T> {
    pub(crate) times: &'a [f64],
    pub(crate) drive: &'a [T],
}

/// A sample of a response, as [`Sample`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Response<T> {
    pub(crate) force: T,
    pub(crate) depth: T,
    pub(crate) contact_depth: T,
}

/// Why a response cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stop {
    /// The depth is beyond the last elastic state.
    Beyond(f64),
    /// A balance has no root.
    NoRoot,
}

/// A sample of a response.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Sample {
    /// Force of the contact \[N\].
    pub force: f64,
    /// Depth of the tip, beyond its first touch \[m\]; negative above the surface.
    pub depth: f64,
    /// Depth at which the elastic contact is as large \[m\]: 0 without contact.
    pub contact_depth: f64,
}

impl From<Response<f64>> for Sample {
    fn from(Response { force, depth, contact_depth }: Response<f64>) -> Sample {
        Sample { force, depth, contact_depth }
    }
}

/// The tip of one curve, ready for many evaluations.
#[derive(Clone, Debug)]
pub(crate) struct Forward(Tip);

impl Forward {
    /// The depth is 0 at the approach `surface`.
    pub(crate) fn new(states: &ElasticStates, surface: f64) -> Forward {
        Forward(Tip::new(states, surface))
    }

    /// The response to a drive through a spring of `give` 1/k \[m/N\]. `record` is given each sample with the terms of its force.
    /// `curve` is the index of the curve in errors. Plain numbers find `roots`, and numbers with derivatives use those of the same
    /// evaluation with plain numbers.
    pub(crate) fn respond<T: Real>(
        &self,
        prony: &Prony<T>,
        drive: Drive<'_, T>,
        give: T,
        curve: usize,
        roots: &mut Roots,
        record: impl FnMut(Response<T>, &[Term<T>]),
    ) -> Result<()> {
        if T::DERIVES {
            roots.rewind()
        } else {
            roots.clear()
        }
        Cycle::new(prony, &self.0, give, drive.times, roots).follow(drive, record).map_err(|stop| match stop {
            Stop::Beyond(depth) => Error::BeyondStates { curve, depth },
            Stop::NoRoot => {
                let reason =
                    "the spring and the contact do not balance: check the stiffness of the spring and the moduli";
                Error::NotConverged { iterations: 0, reason }
            }
        })
    }
}

#[cfg(test)]
mod tests;
