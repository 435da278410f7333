//! Bodies that stick.

mod dmt;
mod flat_punch;
mod jkr;
mod line_contact;
mod maugis_dugdale;
mod opening_edge;
mod wave;

pub use dmt::Dmt;
pub use flat_punch::AdhesivePunch;
pub use jkr::Jkr;
pub use line_contact::AdhesiveCylinder;
pub use maugis_dugdale::MaugisDugdale;
pub use opening_edge::{OpeningEdge, PullOff};
pub use wave::AdhesiveWave;

use crate::error::{Result, positive};

/// Contact modulus E* \[Pa\] and work of separation w \[J/m²\] of two bodies, with a length of their shape \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bodies {
    length: f64,
    modulus: f64,
    work: f64,
}

impl Bodies {
    fn new(what: &'static str, length: f64, modulus: f64, work: f64) -> Result<Bodies> {
        positive(what, length)?;
        positive("contact modulus", modulus)?;
        positive("work of separation", work)?;
        Ok(Bodies { length, modulus, work })
    }
}
