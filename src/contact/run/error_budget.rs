//! Where the error of a run comes from.

use crate::observe::mesh_error::MeshError;

/// Where the error of a run comes from, made by
/// [`Follow::error_budget`](crate::contact::Follow::error_budget). All relative.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ErrorBudget {
    /// Greatest error in time estimated for a step, of the displacement; 0 for fixed steps, which nothing is estimated for.
    pub time: f64,
    /// Errors due to the mesh, of the present state.
    pub mesh: MeshError,
    /// Greatest residual of the contact problems, of the displacement.
    pub solver: f64,
}
