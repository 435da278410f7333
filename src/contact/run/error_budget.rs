//! Where the error of a run comes from.

use crate::observe::mesh_error::MeshError;

/// Where the error of a run comes from, made by
/// [`Follow::error_budget`](crate::contact::Follow::error_budget). All relative.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ErrorBudget {
    /// Greatest error in time estimated for a step: of the approach where a force is given, of the force where a motion is.
    /// Relative to the displacement, or to v = K p; below a part of the greatest so far, to that part. 0 where nothing is
    /// estimated: of elastic bodies, which make no such error, and of steps over the bodies.
    pub time: f64,
    /// Greatest error in time estimated for a step in a single cell, relative to the mean in contact: what the pressure at a
    /// point, and the greatest pressure, may be off by. It is largest where a body meets cells faster than the steps resolve,
    /// which hardly moves the body.
    pub pressure: f64,
    /// Errors due to the mesh, of the present state.
    pub mesh: MeshError,
    /// Greatest residual of the contact problems, of the displacement.
    pub solver: f64,
}
