//! Indenters that move along the surface.

pub(in crate::contact) mod along_path;
mod lateral_force;
mod over_bodies;
pub(in crate::contact) mod spare;
pub(in crate::contact) mod steady;
