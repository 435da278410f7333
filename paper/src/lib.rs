//! The algorithm of S. Spinu, *The surface contact of viscoelastic materials, Part I – Algorithm overview*, as the paper
//! has it: equations in the paper's order, by their numbers, and the flow chart of its Figure 1 as a loop. It shares
//! nothing with the crate `viscocontact`, which differs from it in the time rule, in the solver, and in what it covers:
//! its tests compare both. Read this first.
//!
//! | the paper | here |
//! |---|---|
//! | Eq. 6, 8, 12: influence coefficients | [`Influence`] |
//! | Eq. 7, 11: convolution, by the discrete convolution and FFT of Liu, Wang and Liu (2000), or by sums | [`Influence::displacement`], [`Influence::displacement_by_sums`] |
//! | Eq. 1 to 5: an elastic contact under an eccentric force, by the conjugate gradients of Polonsky and Keer (1999) | [`solve`] |
//! | Eq. 9 to 12: the hereditary integral, as a sum over all steps so far | [`History`] |
//! | Figure 1: the flow chart | [`History::step`] |
//!
//! Lengths in m, forces in N, moduli in Pa. A field has one value per cell of a square grid, row by row.

mod contact;
mod history;
mod influence;

pub use contact::{Load, State, solve};
pub use history::{Creep, History};
pub use influence::{Grid, Influence};
