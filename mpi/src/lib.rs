#![doc = include_str!("../README.md")]
#![deny(missing_docs)]
#![forbid(unsafe_code)]
#![warn(missing_debug_implementations)]

mod chunks;
mod universe;

pub use universe::{Mpi, MpiError};
