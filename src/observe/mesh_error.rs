//! Error due to the mesh.

use std::fmt;

use crate::contact::Extent;
use crate::observe::area::Pressed;

/// Estimated relative errors of a state due to the width of its cells, made by
/// [`ViscoelasticContact::mesh_error`](crate::ViscoelasticContact::mesh_error). Typical sizes, not bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshError {
    /// Of the approach, or of the force where the approach is given.
    pub approach: f64,
    /// Of the greatest pressure of a smooth contact; the pressure at the rim of a punch is infinite and has none.
    pub max_pressure: f64,
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

impl MeshError {
    /// The greater of each error.
    pub(crate) fn max(self, other: MeshError) -> MeshError {
        MeshError {
            approach: self.approach.max(other.approach),
            max_pressure: self.max_pressure.max(other.max_pressure),
            area: self.area.max(other.area),
            singular: self.singular.max(other.singular),
        }
    }
}

/// One line: `approach 1.0e-3, pressure 3.4e-3, area 2.1e-3`.
impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MeshError { approach, max_pressure, area, .. } = self;
        write!(f, "approach {approach:.1e}, pressure {max_pressure:.1e}, area {area:.1e}")
    }
}

impl Pressed<'_> {
    /// The errors due to the mesh, estimated from the cells on the rim of a contact of so many cells; none without a rim.
    pub(crate) fn mesh_error(&self, contact_cells: usize) -> Option<MeshError> {
        let Extent { low, high } = self.extent?;
        let [n1, n2] = self.grid.cells();
        let (mut rim_cells, mut rim, mut total) = (0_usize, 0.0, 0.0);
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                let k = i * n2 + j;
                let p = self.pressure[k];
                if p == 0.0 {
                    continue;
                }
                total += p;
                let on_rim = if i > 0 && i + 1 < n1 && j > 0 && j + 1 < n2 {
                    [k - n2, k - 1, k + 1, k + n2].into_iter().any(|neighbour| self.pressure[neighbour] == 0.0)
                } else {
                    let (i, j) = (i as isize, j as isize);
                    let neighbours = [[i - 1, j], [i + 1, j], [i, j - 1], [i, j + 1]];
                    neighbours.into_iter().any(|cell| self.pressure_at(cell) == 0.0)
                };
                if on_rim {
                    (rim_cells, rim) = (rim_cells + 1, rim + p);
                }
            }
        }
        if total == 0.0 || rim_cells == 0 {
            return None;
        }
        let (share, delta) = (rim / total, rim_cells as f64 / (2 * contact_cells) as f64);
        let smooth = share.min(SMOOTH_SHARE * delta.powf(1.5)) * delta.sqrt();
        // at a singular edge the pressure rises to the rim; creep raises it towards a growing rim, but lets it fall there
        let rises = rim / rim_cells as f64 > SINGULAR * total / contact_cells as f64;
        let singular = if rises { SINGULAR_APPROACH * (share * delta.sqrt() - smooth) } else { 0.0 };
        Some(MeshError {
            approach: SMOOTH_APPROACH * smooth + singular,
            max_pressure: PEAK * smooth + singular,
            area: AREA * delta.powf(AREA_ORDER),
            singular,
        })
    }
}
