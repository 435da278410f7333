//! Tests of the public interface: one module for each doubt that a user may have.

use viscocontact_scenes as common;

mod friction;
mod io;
mod kernel;
mod materials;
mod properties;
mod solver;
mod surfaces;
mod time;
mod validation;
