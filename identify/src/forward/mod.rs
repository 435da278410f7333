//! The force of a tip under any drive.

mod column;
mod cycle;
mod growth;
mod moments;
mod real;
mod roots;
mod tip;

use viscocontact::states::ElasticStates;

use crate::error::Result;
use crate::series::Prony;
use cycle::Cycle;
pub(crate) use growth::Term;
pub(crate) use real::{LANES, Real};
pub(crate) use roots::{Roots, root};
use tip::Tip;

/// A sample of a response, as [`Sample`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Response<const N: usize> {
    pub(crate) force: Real<N>,
    pub(crate) depth: Real<N>,
    pub(crate) contact_depth: Real<N>,
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

impl From<Response<0>> for Sample {
    fn from(of: Response<0>) -> Sample {
        Sample { force: of.force.value(), depth: of.depth.value(), contact_depth: of.contact_depth.value() }
    }
}

impl From<&Prony> for Prony<Real<0>> {
    fn from(of: &Prony) -> Self {
        let real = |values: &[f64]| values.iter().map(|&value| Real::from(value)).collect();
        Prony { moduli: real(&of.moduli), rates: real(&of.rates) }
    }
}

/// The tip of one curve, ready for many evaluations.
#[derive(Clone, Debug)]
pub(crate) struct Forward(Tip);

impl Forward {
    /// The depth is 0 at the approach `surface`. `curve` is the index of the curve in errors.
    pub(crate) fn new(curve: usize, states: &ElasticStates, surface: f64) -> Forward {
        Forward(Tip::new(curve, states, surface))
    }

    /// The response to a drive beyond the contact point \[m\] at some times, through a spring of `give` 1/k \[m/N\]. `record` is given each sample
    /// with the terms of its force. Plain numbers find `roots`, and numbers with derivatives use those of the same evaluation with plain numbers.
    pub(crate) fn respond<const N: usize>(
        &self,
        prony: &Prony<Real<N>>,
        times: &[f64],
        drive: &[Real<N>],
        give: Real<N>,
        roots: &mut Roots,
        record: impl FnMut(Response<N>, &[Term<N>]),
    ) -> Result<()> {
        roots.begin(N > 0);
        Cycle::new(prony, &self.0, give, times, roots).follow(drive, record)
    }
}

#[cfg(test)]
mod tests;
