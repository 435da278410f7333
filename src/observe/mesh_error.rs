//! Error due to the mesh.

use crate::observe::area::Pressed;

/// Estimated relative errors of a state due to the width of its cells, made by
/// [`ViscoelasticContact::mesh_error`](crate::ViscoelasticContact::mesh_error). Typical sizes, not bounds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct MeshError {
    /// Of the approach, or of the force where the approach is given.
    pub approach: f64,
    /// Of the greatest pressure of a smooth contact; the pressure at the rim of a punch is infinite and has none.
    pub greatest_pressure: f64,
    /// Of the contact area.
    pub area: f64,
    /// The part of the approach's error that is of first order in the cell width: that of singular edges. The rest is of
    /// second order.
    pub singular: f64,
}

/// The share of the force on the rim of a smooth contact is this times (rim cells/2 cells)^(3/2): 2.3 for spheres, 1.6
/// for cones.
const SMOOTH_SHARE: f64 = 2.3;
/// Errors over (share of the rim)·√(rim cells/2 cells), as measured on spheres, ellipsoids, cones and punches of 12 to 200
/// cells across: approach of smooth contacts (0.02 … 0.04), of singular ones (0.10 … 0.15), peak pressure (0.11 … 0.14 below 24 cells).
const SMOOTH_APPROACH: f64 = 0.035;
const SINGULAR_APPROACH: f64 = 0.13;
const PEAK: f64 = 0.12;
/// Pressure of the rim over that of the mean cell, above which the edge counts as singular: 1.8 and more under punches.
const SINGULAR: f64 = 1.4;
/// Error of the area, 0.13 (rim cells/2 cells)^1.2 on spheres.
const AREA: f64 = 0.13;
const AREA_ORDER: f64 = 1.2;

impl Pressed<'_> {
    /// The errors due to the mesh, estimated from the cells on the rim of a contact of so many cells.
    pub(crate) fn mesh_error(&self, contact_cells: usize) -> MeshError {
        let n2 = self.grid.cells()[1];
        let (mut rim_cells, mut rim, mut total) = (0_usize, 0.0, 0.0);
        for (k, &p) in self.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            total += p;
            let (i, j) = ((k / n2) as isize, (k % n2) as isize);
            let neighbours = [[i - 1, j], [i + 1, j], [i, j - 1], [i, j + 1]];
            if neighbours.into_iter().any(|cell| self.pressure_at(cell) == 0.0) {
                rim_cells += 1;
                rim += p;
            }
        }
        if total == 0.0 || rim_cells == 0 {
            return MeshError::default();
        }
        let (share, delta) = (rim / total, rim_cells as f64 / (2 * contact_cells) as f64);
        let smooth = share.min(SMOOTH_SHARE * delta.powf(1.5)) * delta.sqrt();
        // at a singular edge the pressure rises to the rim; creep raises it towards a growing rim, but lets it fall there
        let rises = rim / rim_cells as f64 > SINGULAR * total / contact_cells as f64;
        let singular = if rises { SINGULAR_APPROACH * (share * delta.sqrt() - smooth) } else { 0.0 };
        MeshError {
            approach: SMOOTH_APPROACH * smooth + singular,
            greatest_pressure: PEAK * smooth + singular,
            area: AREA * delta.powf(AREA_ORDER),
            singular,
        }
    }
}
