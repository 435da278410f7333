//! From measured indentation curves to the moduli of viscoelastic bodies.
#![deny(missing_docs)]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]

mod error;
mod experiment;
mod forward;
mod model;

pub use error::{Error, Result};
pub use experiment::{Curve, Experiment, Protocol};
pub use model::{Model, Scale};
