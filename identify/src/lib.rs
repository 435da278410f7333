//! From measured indentation curves to the moduli of viscoelastic bodies.
#![deny(missing_docs)]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]

mod data;
mod drainage;
mod dynamic;
mod error;
mod experiment;
mod protocol;
pub mod usual;

pub use data::{DataError, Recording};
pub use drainage::{Scaling, TimeAtSize, Verdict};
pub use dynamic::ComplexModulus;
pub use error::{Error, Result};
pub use experiment::{Curve, Experiment};
pub use protocol::{Protocol, ProtocolBuilder};
