//! From measured indentation curves to the moduli of viscoelastic bodies.
#![deny(missing_docs)]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]

mod bounds;
mod data;
mod drainage;
mod dynamic;
mod error;
mod experiment;
mod fit;
mod forward;
mod identification;
mod least_squares;
mod model;
mod noise;
mod non_negative;
mod parameters;
mod problem;
mod protocol;
mod spectrum;
mod start;
mod statistics;
pub mod usual;

pub use bounds::Bounds;
pub use data::{DataError, Recording};
pub use drainage::{Scaling, TimeAtSize, Verdict};
pub use dynamic::ComplexModulus;
pub use error::{Error, Result};
pub use experiment::{Curve, Experiment};
pub use fit::{Estimate, Fit, FitWarning, ranked};
pub use forward::Sample;
pub use identification::Identification;
pub use model::{Model, Scale};
pub use noise::Noise;
pub use parameters::Nuisance;
pub use protocol::{Protocol, ProtocolBuilder};
pub use spectrum::{Decade, FreeSpectrum};
pub use statistics::ResidualTest;
