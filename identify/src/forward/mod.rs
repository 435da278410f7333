//! The force of a tip under any drive.

mod column;
mod cycle;
mod growth;
mod moments;
mod real;
mod tip;

use crate::series::Prony;
pub(crate) use cycle::Cycle;
pub(crate) use real::{LANES, PLAIN, Real};
pub(crate) use tip::Tip;

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

impl From<&Prony> for Prony<Real<PLAIN>> {
    fn from(of: &Prony) -> Self {
        let real = |values: &[f64]| values.iter().map(|&value| Real::from(value)).collect();
        Prony { moduli: real(&of.moduli), rates: real(&of.rates) }
    }
}

#[cfg(test)]
mod tests;
