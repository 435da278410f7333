//! The report of an elastic solution.

use std::fmt;

use crate::equilibrium::{Figures, Warnings};
use crate::rounded::rounded;

/// The outcome and the cost of [`ElasticContact::solve`](crate::elastic::ElasticContact::solve).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ElasticReport {
    /// Normal force on all bodies together \[N\].
    pub force: f64,
    /// Approach of the first body, at the origin \[m\].
    pub approach: f64,
    /// Tilt (α1, α2) of the first body \[rad\].
    pub tilt: [f64; 2],
    /// Cells in contact.
    pub contact_cells: usize,
    /// Reasons why the result may be less accurate than expected.
    pub warnings: Warnings,
    /// The numbers of the warnings.
    pub figures: Figures,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Iterations by the fall-back solver, which is slower and always descends.
    pub fallback_iterations: usize,
    /// Convolutions with the influence kernel on the computed cells: forward and inverse padded transforms.
    pub convolutions: usize,
    /// Applications of the preconditioner, each on an unpadded grid of a quarter of the size.
    pub preconditioner_applications: usize,
    /// Residual reached, in the measure of [`Settings::tolerance`](crate::contact::Settings::tolerance).
    pub residual: f64,
}

impl ElasticReport {
    /// The transforms in units of one convolution; a transform without padding counts a quarter.
    pub fn convolution_equivalents(&self) -> f64 {
        self.convolutions as f64 + 0.25 * self.preconditioner_applications as f64
    }

    /// What each warning says, with its number: one line each.
    pub fn messages(&self) -> impl Iterator<Item = String> + '_ {
        self.figures.messages(self.warnings, None)
    }
}

/// One line for logs: the result, its cost, and its warnings.
impl fmt::Display for ElasticReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ElasticReport { force, approach, contact_cells, residual, .. } = *self;
        write!(f, "force {} N, approach {approach:.4e} m, {contact_cells} cells in contact; ", rounded(force, 5))?;
        write!(f, "{} convolutions, residual {residual:.1e}", self.convolution_equivalents())?;
        self.messages().try_for_each(|message| write!(f, "; {message}"))
    }
}
