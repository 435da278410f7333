//! From measured indentation curves to the moduli of viscoelastic bodies, for experimenters with an atomic force microscope, a
//! nanoindenter or a load cell.
//!
//! A tip is pressed into a body, held, and drawn back; force and drive are measured over time. The crate finds the contact
//! modulus over time, E*(t), with its uncertainty. The force of every model is computed for any tip, layer and history,
//! retraction and renewed contact included, as on elastic states ([`viscocontact::states`]).
//!
//! | task | start at |
//! |---|---|
//! | read a curve from a file, check its signs and units | [`Recording`] |
//! | plan an experiment, and predict how well it determines a material | [`Protocol`], [`Identification::bounds`] |
//! | fit a model to one or more curves | [`Identification::fit`] |
//! | fit each curve of a force map, on several threads | [`Identification::fit_each`] |
//! | find the decades of time that the data determine, whatever the model | [`Fit::decades`] |
//! | compare models | [`ranked`] |
//! | see what a misfit does to the modulus | [`Fit::variants`] |
//! | cut a curve | [`Curve::within`], [`Curve::until_release`] |
//! | check a fit by the stepper in space | [`Fit::verify`] |
//! | tables and pictures | [`Summary`], `Fit::picture` with the feature `plot` |
//! | the complex modulus of a small oscillation | [`Curve::complex_modulus`] |
//! | the usual formulas, for comparison | [`usual`] |
//!
//! The [`guide`] has programs from curves to materials, and what can go wrong in each.
//!
//! # Conventions
//!
//! * **Units**: SI. Drive and force grow toward the sample; the drive is the depth of the tip, or the position of the base of a
//!   spring that carries the tip.
//! * **Modulus**: E* is the contact modulus: 2G/(1 − ν) of a body of shear modulus G under a rigid tip. One contact does not
//!   determine ν, so that G needs a ν from elsewhere ([`Fit::shear_modulus`]).
//! * **Deviations** of moduli and times are deviations of their logarithms.
//!
//! # Features
//!
//! `rayon` (on by default): many curves on several threads. `plot`: pictures of data, fit, band and residuals. `serde`: results as JSON, and `Serialize` for them.

#![deny(missing_docs)]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]

mod bounds;
mod data;
mod dynamic;
mod error;
mod experiment;
mod fit;
mod forward;
mod fractional;
mod identification;
mod model;
mod noise;
mod parameters;
mod part;
#[cfg(feature = "plot")]
mod plot;
mod problem;
mod protocol;
mod results;
mod segments;
mod series;
mod spectrum;
mod start;
mod statistics;
pub mod tips;
pub mod usual;
mod verify;
mod watch;
#[cfg(any(doc, doctest))]
pub mod guide {
    #![doc = include_str!("../docs/guide.md")]

    use crate::*;
}

pub use bounds::Bounds;
pub use data::Recording;
pub use dynamic::ComplexModulus;
pub use error::{Error, Result};
pub use experiment::{Curve, Experiment};
pub use fit::{Estimate, Fit, FitState, FitWarning, Variant, ranked};
pub use forward::Sample;
pub use identification::Identification;
pub use model::{Law, Model, Scale};
pub use noise::Noise;
pub use parameters::{Nuisance, PerCurve};
pub use protocol::{Protocol, ProtocolBuilder};
pub use results::Summary;
pub use spectrum::Decade;
pub use verify::Verification;

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
