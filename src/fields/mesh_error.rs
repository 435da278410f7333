//! Error due to the mesh.

use std::fmt;

/// Measured relative errors of a state due to the width of its cells, made by
/// [`Fields::mesh_error`](crate::fields::Fields::mesh_error). Typical sizes, not bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshError {
    /// Error of the approach, or of the force where the approach is given.
    pub approach: f64,
    /// Error of the maximum pressure. `None` where it does not converge: the tip of a cone, the edge of a punch, a
    /// peak that the cells do not resolve, or a contact too small to tell.
    pub max_pressure: Option<f64>,
    /// Error of the pressure field, Σ |δp| over Σ p, with p the mean over each cell: nearly all of it is at the rim.
    pub pressure_field: f64,
    /// Error of the contact area.
    pub area: f64,
}

/// One line: `approach 1.0e-3, pressure 3.4e-3, area 2.1e-3`.
impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MeshError { approach, max_pressure, area, .. } = self;
        match max_pressure {
            Some(max_pressure) => write!(f, "approach {approach:.1e}, pressure {max_pressure:.1e}, area {area:.1e}"),
            None => write!(f, "approach {approach:.1e}, pressure not converged, area {area:.1e}"),
        }
    }
}
