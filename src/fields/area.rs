//! Contact area, to a fraction of a cell.

use std::ops::Range;

use crate::equilibrium::Held;
use crate::error::Result;
use crate::extent::Extent;
use crate::fields::Fields;
use crate::{Grid, memory};

/// Weights of the two estimates of the end of contact between a cell in contact and a cell out of contact: the straight
/// line through p² of the last two cells, which the coarse pressure of the last cell pulls inwards, and the parabola
/// through the three cells before the last, which overshoots. On a sphere the errors cancel with these weights.
const LAST_TWO: f64 = 0.6;
const THREE_BEFORE: f64 = 0.4;

/// The contact ends less than a cell beyond the centre of the last cell; estimates farther out than this are discarded.
const TOO_FAR: f64 = 1.3;

/// Least ratio of a rise in pressure: mirrored pressures differ by rounding and do not count as a rise.
const RISES: f64 = 1.0 + 1e-6;

/// Rows and columns beyond the corners of a square whose pressure determines the covered part of the square.
pub(crate) const REACH: usize = 3;

/// A pressure on a grid or on some of its rows, and the gap.
pub(crate) struct PressedCells<'a> {
    pub(crate) grid: &'a Grid,
    /// First row of pressure and gap if they hold some rows of the grid; `None` if they hold all. Rows beyond the
    /// grid belong to the next period, or are empty.
    pub(crate) first: Option<isize>,
    /// Axes along which the bodies are periodic.
    pub(crate) periodic: [bool; 2],
    pub(crate) pressure: &'a [f64],
    /// The initial gap above its datum, +∞ where there is nothing to touch.
    pub(crate) gap: &'a [f64],
    /// A rectangle of cells that contains the contact; `None` without contact.
    pub(crate) extent: Option<Extent>,
}

impl PressedCells<'_> {
    /// The contact area \[m²\].
    pub(crate) fn area(&self) -> f64 {
        self.squares(0).map(|row| self.covered_in_row(row)).sum::<f64>() * self.grid.cell_area()
    }

    /// Squares of four cell centres: their lower corners are a row and a column back, beyond the grid or, at n,
    /// across the seam of a period.
    fn squares(&self, axis: usize) -> Range<usize> {
        match self.extent {
            None => 0..0,
            Some(Extent { low, .. }) if self.periodic[axis] && low[axis] == 0 => 1..self.grid.cells()[axis] + 1,
            Some(Extent { low, high }) => low[axis]..high[axis] + 2,
        }
    }

    /// Covered area of a row of squares, in cells.
    pub(crate) fn covered_in_row(&self, i: usize) -> f64 {
        let (n, mut cells) = (self.grid.cells(), 0.0);
        if !self.squares(0).contains(&i) {
            return cells;
        }
        let row = ((i as isize - self.first.unwrap_or(0)) as usize).wrapping_mul(n[1]);
        for j in self.squares(1) {
            if i > 0 && i < n[0] && j > 0 && j < n[1] {
                let k = row + j;
                let corners = [k - n[1] - 1, k - n[1], k - 1, k];
                let inside = corners.into_iter().filter(|&k| self.pressure[k] > 0.0).count();
                if inside.is_multiple_of(4) {
                    cells += (inside / 4) as f64;
                    continue;
                }
            }
            let corners =
                [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[i, j]| [i as isize - 1, j as isize - 1]);
            cells += self.covered(corners);
        }
        cells
    }

    /// The covered part of the square between four cell centres, in counter-clockwise order.
    fn covered(&self, corners: [[isize; 2]; 4]) -> f64 {
        const UNIT: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let inside = corners.map(|corner| self.pressure_at(corner) > 0.0);
        match inside {
            [true, true, true, true] => return 1.0,
            [false, false, false, false] => return 0.0,
            _ => {}
        }
        // corners of the polygon: touched cell centres, and ends of contact
        let (mut polygon, mut count) = ([[0.0; 2]; 8], 0);
        let mut add = |corner: [f64; 2]| {
            polygon[count] = corner;
            count += 1;
        };
        for k in 0..4 {
            let next = (k + 1) % 4;
            if inside[k] {
                add(UNIT[k]);
            }
            if inside[k] != inside[next] {
                let (from, to) = if inside[k] { (k, next) } else { (next, k) };
                let end = self.distance_to_end(corners[from], corners[to]);
                add([0, 1].map(|axis| UNIT[from][axis] + end * (UNIT[to][axis] - UNIT[from][axis])));
            }
        }
        let sides = polygon[..count].windows(2).map(|side| side[0][0] * side[1][1] - side[0][1] * side[1][0]);
        let ([x1, x2], [y1, y2]) = (polygon[count - 1], polygon[0]);
        0.5 * (sides.sum::<f64>() + x1 * y2 - x2 * y1)
    }

    /// Distance of the end of contact from the centre of a cell in contact towards its neighbour out of contact, in
    /// cells. At the edge of a shape it is the rim of the cell, and so it is where p² has no zero near it, as under a
    /// fast growing contact, whose pressure drops to zero within a cell.
    fn distance_to_end(&self, from: [isize; 2], to: [isize; 2]) -> f64 {
        const TO_THE_RIM: f64 = 0.5;
        if !self.touchable(to) {
            return TO_THE_RIM;
        }
        let back = |k: isize| {
            let p = self.pressure_at([0, 1].map(|axis| from[axis] + k * (from[axis] - to[axis])));
            p * p
        };
        let [last, second, third, fourth] = [back(0), back(1), back(2), back(3)];
        let line = if second > last { last / (second - last) } else { f64::INFINITY };
        if line > TOO_FAR {
            return TO_THE_RIM;
        }
        let line = line.min(1.0);
        if !(third > RISES * second && fourth > RISES * third) {
            return line;
        }
        // f(x) = second + slope x + bend x² at x = 0, −1, −2; its zero, one cell further out
        let slope = 0.5 * (3.0 * second - 4.0 * third + fourth);
        let bend = 0.5 * (second - 2.0 * third + fourth);
        let discriminant = slope * slope - 4.0 * bend * second;
        let zero =
            if discriminant >= 0.0 { -2.0 * second / (slope - discriminant.sqrt()) } else { second / (third - second) };
        LAST_TWO * line + THREE_BEFORE * (zero - 1.0).clamp(0.0, 1.0)
    }

    /// Pressure in a cell, wrapped along periodic axes; zero beyond the grid.
    pub(crate) fn pressure_at(&self, cell: [isize; 2]) -> f64 {
        self.index(cell).map_or(0.0, |k| self.pressure[k])
    }

    /// Whether there is something to touch in a cell; nothing beyond the grid.
    fn touchable(&self, cell: [isize; 2]) -> bool {
        self.index(cell).is_some_and(|k| self.gap[k].is_finite())
    }

    fn index(&self, cell: [isize; 2]) -> Option<usize> {
        let [n1, n2] = self.grid.cells();
        let wrap =
            |axis: usize, n: usize| if self.periodic[axis] { cell[axis].rem_euclid(n as isize) } else { cell[axis] };
        let (rows, i) = match self.first {
            None => (n1, wrap(0, n1)),
            Some(first) => (self.pressure.len() / n2, cell[0] - first),
        };
        let (i, j) = (usize::try_from(i).ok()?, usize::try_from(wrap(1, n2)).ok()?);
        (i < rows && j < n2).then_some(i * n2 + j)
    }
}

impl Fields<'_> {
    /// Area of contact \[m²\].
    ///
    /// Near the edge of a smooth contact the pressure rises with the root of the distance, so that p² extrapolates to
    /// the edge within a fraction of a cell. The area is the area of the polygons through these points. Where the
    /// pressure does not fall towards the edge, or the indenter has no surface beyond it, as at the rim of a punch,
    /// the contact ends with the cell. Measured on spheres: 2e-3 of the area at 64² cells and 5e-4 at 256², where
    /// counting cells ([`Fields::contact_cells`]) errs by 1.5e-2 and 4e-3. Where contact grows by creep, the newest
    /// cells are stiffer than older ones, and the pressure follows the root only within them: then the area errs by
    /// up to a few per cent at 128² cells. Where surfaces [attract](crate::adhesion) each other, contact is where the
    /// wall presses; its pressure follows the root within the zone of the attraction, and the area errs by 1.5 % with
    /// 6 cells in the zone, and by 0.5 % with 12. A call of all [ranks](crate::parallel) that share out the rows.
    pub fn contact_area(&self) -> f64 {
        let Held { region, .. } = self.held;
        if self.contact_cells() == 0 {
            return 0.0;
        }
        if region.is_shared() { self.shared_area() } else { self.pressed().area() }
    }

    /// Mean pressure over the contact \[Pa\]: force over [`contact_area`](Fields::contact_area); 0 without
    /// contact. The force includes the [attraction](crate::adhesion), also beyond the contact.
    pub fn mean_pressure(&self) -> f64 {
        let area = self.contact_area();
        if area > 0.0 { self.force() / area } else { 0.0 }
    }

    /// Maximum pressure of any cell \[Pa\]; 0 without contact.
    pub fn max_pressure(&self) -> f64 {
        let Held { region, current, .. } = self.held;
        region.rows().greatest(crate::sum::greatest(&current.solution.pressure))
    }

    /// The gap of every cell \[m\].
    pub(crate) fn gap(&self) -> Result<Vec<f64>> {
        let mut gap = memory::field("the gap", self.pressure().len(), 0.0)?;
        self.gap_into(&mut gap)?;
        Ok(gap)
    }

    fn pressed(&self) -> PressedCells<'_> {
        PressedCells {
            grid: self.grid(),
            first: None,
            periodic: self.kernel().periodic_axes(),
            pressure: self.pressure(),
            gap: &self.held.indenter.gap().above,
            extent: self.extent_of_contact(),
        }
    }
}
