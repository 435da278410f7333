//! Error due to the mesh.

use std::fmt;

use crate::extent::Extent;
use crate::observe::area::{End, Pressed};
use crate::sum::{most, sum};

/// Estimated relative errors of a state due to the width of its cells, made by
/// [`Fields::mesh_error`](crate::fields::Fields::mesh_error). Typical sizes, not bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshError {
    /// Error of the approach, or of the force where the approach is given.
    pub approach: f64,
    /// Error of the greatest pressure. `None` where the pressure near its greatest value is not a smooth peak: it does not
    /// converge there (the tip of a cone, the edge of a punch), or the cells do not resolve it.
    pub max_pressure: Option<f64>,
    /// Error of the pressure field, Σ |δp| over Σ p, with p the mean over each cell: nearly all of it is at the rim.
    pub pressure_field: f64,
    /// Greatest error of the mean pressure over a cell of the rim, over the greatest pressure.
    pub rim_pressure: f64,
    /// Error of the contact area.
    pub area: f64,
    /// The part of the approach's error that is due to an infinite pressure at the edge, of first order in the cell width.
    /// The rest is of second order on smooth shapes; where a shape ends between cells, it is of first order too.
    pub singular: f64,
}

/// The share of the force on the rim of a smooth contact is this times (rim cells/2 cells)^(3/2): 2.3 for spheres, 1.6
/// for cones.
const SMOOTH_SHARE: f64 = 2.3;
/// Errors of the approach over (share of the rim)·√(rim cells/2 cells), of smooth edges and of singular ones.
const SMOOTH: f64 = 0.05;
const SINGULAR: f64 = 0.13;
/// Mean pressure of the rim over the mean pressure, above which the edge counts as singular: 1.8 and more under punches.
const RISING: f64 = 1.4;
/// Error of the approach over (share of the cells where the end of contact is unknown)·(rim cells/2 cells).
const UNKNOWN: f64 = 0.1;
/// Errors of approach and area over the force and the area in the outermost cells of a shape. Each straight piece of its
/// edge counts as an independent error.
const SHAPE_IN_APPROACH: f64 = 0.15;
const SHAPE_IN_AREA: f64 = 0.45;
/// Errors of the pressure field over the share of the force on the rim, and of the pressure in a cell of the rim over the greatest one there;
/// and the error of the field over the drops of the pressure from cell to cell within.
const FIELD_OF_RIM: f64 = 0.6;
const CELL_OF_RIM: f64 = 0.7;
/// Error of the end of contact, in cells: where it is unknown, where there is one estimate, and where there are two. Two
/// estimates add their difference times the last factor.
const PLACE_UNKNOWN: f64 = 0.14;
const PLACE_OF_ONE: f64 = 0.07;
const PLACE_OF_TWO: f64 = 0.035;
const PLACE_OF_DIFFERENCE: f64 = 0.28;

/// On periodic bodies errors grow as the share of cells out of contact falls: the error of the approach as the inverse
/// square of the share, the error of the area as this power of the factor of the approach.
const STIFFNESS_IN_AREA: f64 = 0.25;

/// Limits of a resolved contact: greatest share of its cells on the rim (about five cells across), greatest share of its
/// sides that belong to pieces one or two cells wide, and least number of cells of a periodic gap per cell of the rim.
const MOST_RIM: f64 = 0.6;
const MOST_NARROW: f64 = 0.5;
const LEAST_GAP: f64 = 4.0 / 3.0;

/// Limits of a resolved peak: greatest relative drop of the pressure to the neighbours, along x1 and x2 together, and least
/// ratio of the drop to the second neighbours to it: 4 at smooth peaks, 3 where p = c − r^0.8, 1.5 at tips of cones.
const MOST_DROP: f64 = 0.3;
const LEAST_GROWTH: f64 = 3.0;
const SMOOTH_GROWTH: f64 = 4.0;
/// A smaller drop is rounding.
const FLAT: f64 = 1e-12;
/// Error of the peak over the drop on the steeper sides, for wide peaks, and over the square of the mean drop, for narrow peaks.
const PEAK: f64 = 0.11;
const NARROW_PEAK: f64 = 0.5;
/// Other peaks of this share of the greatest pressure may exceed it on a finer mesh.
const OTHER_PEAKS: f64 = 0.85;
/// A pressure at the rim above these shares of the greatest pressure may exceed it on a finer mesh: for pressures that fall
/// towards the rim, and for pressures that do not.
const MOST_AT_RIM: f64 = 0.75;
const MOST_RISING: f64 = 0.5;
/// Safety factor on the estimated error of a peak.
const TRUSTED: f64 = 3.0;

const SIDES: [[isize; 2]; 4] = [[-1, 0], [0, -1], [0, 1], [1, 0]];

impl MeshError {
    /// The maximum of each error; for the greatest pressure, of the known errors.
    pub(crate) fn max(self, other: MeshError) -> MeshError {
        let known = [self.max_pressure, other.max_pressure].into_iter().flatten();
        MeshError {
            approach: self.approach.max(other.approach),
            max_pressure: known.reduce(f64::max),
            pressure_field: self.pressure_field.max(other.pressure_field),
            rim_pressure: self.rim_pressure.max(other.rim_pressure),
            area: self.area.max(other.area),
            singular: self.singular.max(other.singular),
        }
    }
}

/// One line: `approach 1.0e-3, pressure 3.4e-3, area 2.1e-3`.
impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let MeshError { approach, max_pressure, area, .. } = self;
        match max_pressure {
            Some(max_pressure) => write!(f, "approach {approach:.1e}, pressure {max_pressure:.1e}, area {area:.1e}"),
            None => write!(f, "approach {approach:.1e}, pressure not resolved, area {area:.1e}"),
        }
    }
}

/// Sums over the rim: the cells in contact with a neighbour without pressure, and their sides towards such neighbours.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Rim {
    cells: usize,
    pressure: f64,
    /// Sum of the pressures of cells with a side where the end of contact is unknown.
    unknown_pressure: f64,
    /// Number of sides, and number of the sides of pieces one or two cells wide.
    sides: usize,
    narrow_sides: usize,
    /// Sum of the errors of the end of contact, in cells.
    place: f64,
    /// Sums over the straight pieces of the edge of the shape: squared lengths, in cells, and squared sums of pressure.
    shape_lengths: f64,
    shape_pressures: f64,
    /// Greatest pressure, and greatest pressure of the cells from which it does not rise inwards.
    highest: f64,
    rising: f64,
}

/// Whether a cell has a greater pressure than its neighbours.
enum Peak {
    None,
    /// `drop` is the relative fall of the pressure to the neighbours.
    Unresolved {
        drop: f64,
    },
    Resolved {
        error: f64,
    },
}

impl Pressed<'_> {
    /// The maximum errors due to the mesh of the contacts of several bodies, `owner` being that of each cell. `None` if one of them has none.
    pub(crate) fn mesh_error_of_bodies(&self, owner: &[u16], bodies: usize) -> Option<MeshError> {
        let n2 = self.grid.cells()[1];
        let of_body = |body: u16| {
            let pressed = Pressed { body: Some((owner, body)), ..*self };
            let own = || self.extent.into_iter().flat_map(Extent::cells).filter(|[i, j]| pressed.own(i * n2 + j) > 0.0);
            let extent = Extent::hull(own().map(Extent::of))?;
            Some(Pressed { extent: Some(extent), ..pressed }.mesh_error(own().count()))
        };
        let worst = |a: Option<MeshError>, b: Option<MeshError>| {
            a.zip(b).map(|(a, b)| {
                let both_known = a.max_pressure.and(b.max_pressure);
                MeshError { max_pressure: both_known.and(a.max(b).max_pressure), ..a.max(b) }
            })
        };
        (0..bodies as u16).filter_map(of_body).reduce(worst).flatten()
    }

    /// The errors due to the mesh of a contact of `contact_cells` cells. `None` without a rim, and where the cells do not
    /// resolve the contact or the periodic gap.
    pub(crate) fn mesh_error(&self, contact_cells: usize) -> Option<MeshError> {
        let extent @ Extent { low, high } = self.extent?;
        let n2 = self.grid.cells()[1];
        let (total, highest) = if self.body.is_some() {
            let own = |cell: [usize; 2]| self.own(cell[0] * n2 + cell[1]);
            extent.cells().map(own).fold((0.0, 0.0_f64), |(total, highest), p| (total + p, highest.max(p)))
        } else {
            let rows = (low[0]..=high[0]).map(|i| &self.pressure[i * n2..][low[1]..=high[1]]);
            rows.fold((0.0, 0.0_f64), |(total, highest), row| (total + sum(row), highest.max(most(row))))
        };
        let rim = self.rim(extent);
        if total == 0.0 || rim.cells == 0 {
            return None;
        }
        let (cells, rim_cells) = (contact_cells as f64, rim.cells as f64);
        let all = self.grid.len() as f64;
        let bounded_gap = self.periodic == [true; 2];
        if rim_cells > MOST_RIM * cells
            || rim.narrow_sides as f64 >= MOST_NARROW * rim.sides as f64
            || (bounded_gap && LEAST_GAP * rim_cells > all - cells)
        {
            return None;
        }
        let (share, delta) = (rim.pressure / total, rim_cells / (2.0 * cells));
        let smooth = share.min(SMOOTH_SHARE * delta.powf(1.5)) * delta.sqrt();
        // at a singular edge the pressure rises up to the rim; creep raises it towards a growing rim, but it falls at the rim
        let rises = rim.pressure / rim_cells > RISING * total / cells;
        let stiffness = if bounded_gap { (all / (all - cells)).powi(2) } else { 1.0 };
        let singular = if rises { stiffness * SINGULAR * (share * delta.sqrt() - smooth) } else { 0.0 };
        let unknown = UNKNOWN * rim.unknown_pressure / total * delta;
        let shape = SHAPE_IN_APPROACH * rim.shape_pressures.sqrt() / total;
        let approach = stiffness * (SMOOTH * smooth + unknown) + singular + shape;
        // at an edge of the shape the pressure is infinite
        let at_rim =
            rim.shape_lengths > 0.0 || rim.highest > MOST_AT_RIM * highest || rim.rising > MOST_RISING * highest;
        let peak = if at_rim { None } else { self.peak_error(extent, highest) };
        Some(MeshError {
            approach,
            max_pressure: peak.map(|peak| peak + approach),
            pressure_field: FIELD_OF_RIM * share + approach,
            rim_pressure: CELL_OF_RIM * rim.highest / highest,
            area: (stiffness.powf(STIFFNESS_IN_AREA) * rim.place + SHAPE_IN_AREA * rim.shape_lengths.sqrt()) / cells,
            singular,
        })
    }

    /// The error of the greatest pressure: the largest error among the peaks that may be the greatest on a finer mesh, each
    /// from the curvature of the pressure at the peak. `None` if one of these peaks is not resolved.
    fn peak_error(&self, extent: Extent, highest: f64) -> Option<f64> {
        let least = OTHER_PEAKS * highest;
        let mut worst = 0.0_f64;
        for [i, j] in extent.cells() {
            let p = self.own(i * self.grid.cells()[1] + j);
            if p < least {
                continue;
            }
            match self.peak([i as isize, j as isize], p) {
                Peak::Unresolved { drop } if p * (1.0 + drop) >= highest => return None,
                Peak::Resolved { error } if p * (1.0 + TRUSTED * error) >= highest => worst = worst.max(error),
                _ => {}
            }
        }
        Some(worst)
    }

    /// Whether the pressure p in a cell is a peak.
    fn peak(&self, cell: [isize; 2], p: f64) -> Peak {
        let at = |side: [isize; 2]| self.pressure_at([cell[0] + side[0], cell[1] + side[1]]);
        let beside = SIDES.map(at);
        let drop = |beside: [f64; 4]| 2.0 - 0.5 * beside.iter().sum::<f64>() / p;
        let near = drop(beside);
        if beside.iter().any(|&other| other > p) || near < FLAT {
            return Peak::None;
        }
        let growth = drop(SIDES.map(|side| at(side.map(|index| 2 * index)))) / near;
        if beside.contains(&0.0) || near > MOST_DROP || growth < LEAST_GROWTH {
            return Peak::Unresolved { drop: near };
        }
        let [before, left, right, behind] = beside;
        let steep = 2.0 - (before.min(behind) + left.min(right)) / p;
        Peak::Resolved { error: PEAK * steep * (SMOOTH_GROWTH / growth).powi(4) + NARROW_PEAK * near * near }
    }

    fn rim(&self, extent: Extent) -> Rim {
        let [n1, n2] = self.grid.cells();
        let mut rim = Rim::default();
        for [i, j] in extent.cells().filter(|[i, j]| self.own(i * n2 + j) != 0.0) {
            // most cells are inside, which takes few comparisons; beside an end of the grid may be the other end
            let k = i * n2 + j;
            let beside = || [k - n2, k - 1, k + 1, k + n2].iter().all(|&k| self.own(k) != 0.0);
            if !(i > 0 && i + 1 < n1 && j > 0 && j + 1 < n2 && beside()) {
                self.add_cell([i, j], &mut rim);
            }
        }
        rim
    }

    /// Adds a cell in contact, if it is on the rim.
    fn add_cell(&self, cell: [usize; 2], rim: &mut Rim) {
        let p = self.own(cell[0] * self.grid.cells()[1] + cell[1]);
        let from = cell.map(|index| index as isize);
        let (mut on_rim, mut unknown) = (false, false);
        for side in SIDES {
            let away = |k: isize| [from[0] + k * side[0], from[1] + k * side[1]];
            let to = away(1);
            if self.pressure_at(to) != 0.0 {
                continue;
            }
            on_rim = true;
            rim.sides += 1;
            let inwards = self.pressure_at(away(-1));
            rim.narrow_sides += usize::from(inwards == 0.0 || self.pressure_at(away(-2)) == 0.0);
            rim.place += match self.end(from, to) {
                End::OfShape => {
                    self.add_edge(cell, side, rim);
                    continue;
                }
                End::Unknown => {
                    unknown = true;
                    PLACE_UNKNOWN
                }
                End::Line(_) => PLACE_OF_ONE,
                End::LineAndParabola(line, parabola) => PLACE_OF_TWO + PLACE_OF_DIFFERENCE * (parabola - line).abs(),
            };
            if inwards <= p {
                rim.rising = rim.rising.max(p);
            }
        }
        rim.cells += usize::from(on_rim);
        if on_rim {
            rim.pressure += p;
            rim.highest = rim.highest.max(p);
        }
        if unknown {
            rim.unknown_pressure += p;
        }
    }

    /// Adds the straight piece of the edge of the shape that begins at a cell, if one does.
    fn add_edge(&self, cell: [usize; 2], side: [isize; 2], rim: &mut Rim) {
        let along = if side[0] == 0 { 0 } else { 1 };
        let pressure = |index: usize| {
            let mut at = cell.map(|index| index as isize);
            at[along] = index as isize;
            let ends = matches!(self.end(at, [at[0] + side[0], at[1] + side[1]]), End::OfShape);
            if ends { self.pressure_at(at) } else { 0.0 }
        };
        if cell[along] > 0 && pressure(cell[along] - 1) != 0.0 {
            return;
        }
        let edge = (cell[along]..self.grid.cells()[along]).map(pressure).take_while(|&p| p != 0.0);
        let (length, force) = edge.fold((0.0, 0.0), |(length, force), p| (length + 1.0, force + p));
        rim.shape_lengths += length * length;
        rim.shape_pressures += force * force;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    /// Patches of contact of all sizes, at the ends of the grid too, against the definition of the rim.
    #[test]
    fn the_rim_is_the_cells_with_a_neighbour_without_pressure() {
        let mut state = 7_u64;
        let mut below = |n: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % n
        };
        for _ in 0..300 {
            let cells = [1 + below(12), 1 + below(70)];
            let grid = Grid::new(cells, [1.0, 1.0]).unwrap();
            let mut pressure = vec![0.0; grid.len()];
            for _ in 0..=below(3) {
                let [from, to] = [0, 1].map(|_| cells.map(&mut below));
                for i in from[0].min(to[0])..=from[0].max(to[0]) {
                    let columns = from[1].min(to[1])..=from[1].max(to[1]);
                    columns.for_each(|j| pressure[i * cells[1] + j] = (1 + below(9)) as f64);
                }
            }
            let gap = vec![0.0; grid.len()];
            let periodic = [below(2) == 1, below(2) == 1];
            let pressed = Pressed {
                grid: &grid,
                first: None,
                periodic,
                pressure: &pressure,
                gap: &gap,
                extent: None,
                body: None,
            };
            let mut expected = (0, 0.0, 0);
            for k in (0..grid.len()).filter(|&k| pressure[k] != 0.0) {
                let [i, j] = [k / cells[1], k % cells[1]].map(|index| index as isize);
                let neighbours = [[i - 1, j], [i + 1, j], [i, j - 1], [i, j + 1]];
                let free = neighbours.into_iter().filter(|&cell| pressed.pressure_at(cell) == 0.0).count();
                if free > 0 {
                    expected = (expected.0 + 1, expected.1 + pressure[k], expected.2 + free);
                }
            }
            let rim = pressed.rim(Extent { low: [0, 0], high: [cells[0] - 1, cells[1] - 1] });
            assert_eq!((rim.cells, rim.pressure, rim.sides), expected, "{cells:?} {periodic:?}");
        }
    }
}
