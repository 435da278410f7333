//! Contact area, to a fraction of a cell.

use std::ops::Range;

use crate::equilibrium::Held;
use crate::error::Result;
use crate::extent::Extent;
use crate::fields::Fields;
use crate::{Grid, memory};

/// Where a contact ends at the edge of a shape: at the rim of the cell.
const TO_THE_RIM: f64 = 0.5;

/// By so many cells the edge lies beyond the zero of h^⅔: on the mesh the gap of the first cells is too large. The mean
/// over places and directions of the edge of spheres, cones and ellipsoids, elastic and creeping, on 32² to 256² cells;
/// each alone has 0.008 to 0.013.
const BEYOND: f64 = 0.0115;

/// Rows and columns beyond the corners of a square that determine the covered part of the square.
pub(crate) const REACH: usize = 1;

/// A pressure on a grid or on some of its rows, and the gap.
pub(crate) struct PressedCells<'a> {
    pub(crate) grid: &'a Grid,
    /// First row of pressure and gap if they hold some rows of the grid; `None` if they hold all. Rows beyond the
    /// grid belong to the next period, or are empty.
    pub(crate) first: Option<isize>,
    /// Axes along which the bodies are periodic.
    pub(crate) periodic: [bool; 2],
    pub(crate) pressure: &'a [f64],
    /// The gap between the deformed bodies at a cell of these, +∞ where there is nothing to touch; 0 where it is not
    /// known.
    pub(crate) gap: &'a dyn Fn(usize) -> f64,
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
    /// cells: [`BEYOND`] where the line through h^⅔ of this neighbour and the next one is zero. Where the gap does not
    /// rise, as in a channel between two contacts, it is where the line through p² of the last two cells in contact is
    /// zero.
    fn distance_to_end(&self, from: [isize; 2], to: [isize; 2]) -> f64 {
        let on = |cell: [isize; 2], k: isize| [0, 1].map(|axis| cell[axis] + k * (to[axis] - from[axis]));
        let [near, next] = [on(to, 0), on(to, 1)].map(|cell| self.gap_at(cell).max(0.0).cbrt().powi(2));
        if near.is_infinite() {
            return TO_THE_RIM;
        }
        if next > near && next.is_finite() {
            return (1.0 - near / (next - near) + BEYOND).clamp(0.0, 1.0);
        }
        let [last, second] = [on(from, 0), on(from, -1)].map(|cell| self.pressure_at(cell).powi(2));
        if second > last { (last / (second - last)).min(1.0) } else { TO_THE_RIM }
    }

    /// Pressure in a cell, wrapped along periodic axes; zero beyond the grid.
    pub(crate) fn pressure_at(&self, cell: [isize; 2]) -> f64 {
        self.index(cell).map_or(0.0, |k| self.pressure[k])
    }

    /// The gap at a cell; there is nothing to touch beyond the grid.
    fn gap_at(&self, cell: [isize; 2]) -> f64 {
        self.index(cell).map_or(f64::INFINITY, |k| if self.pressure[k] > 0.0 { 0.0 } else { (self.gap)(k) })
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
    /// Beside a smooth contact the gap h rises with the power 3/2 of the distance from the edge (K. L. Johnson, Contact
    /// Mechanics, 1985, section 5.1), however the bodies were loaded before, so that h^⅔ of two cells extrapolates to
    /// the edge within a fraction of a cell. The area is that of the polygons through these points. Where the indenter
    /// has no surface beyond the edge, as at the rim of a punch, the contact ends with the cell. At a sharp rim
    /// above a finite flank the gap rises linearly, and the area is too small by half a cell of radius or less; between
    /// `set_geometries` and the next step the new gap is read over the old displacement. Measured on spheres,
    /// elastic or creeping: 3e-3 of the area at 64² cells and 5e-4 at 256², where counted cells
    /// ([`Fields::contact_cells`]) are off by 1.5e-2 and 3e-3. Where surfaces [attract](crate::adhesion) each other,
    /// contact is where the wall presses; the error is 0.35 % with 6 cells in the zone of the attraction, and 0.05 %
    /// with 12. A call of all [ranks](crate::parallel) that share out the rows.
    pub fn contact_area(&self) -> f64 {
        let Held { region, .. } = self.held;
        if self.contact_cells() == 0 {
            return 0.0;
        }
        // no pressure is above the maximum, not even where the contact is a cell wide
        let least = self.force() / self.max_pressure();
        if region.is_shared() {
            return self.shared_area().max(least);
        }
        let (grid, n2) = (self.grid(), self.grid().cells()[1]);
        let gap = |k: usize| region.find([k / n2, k % n2]).map_or(0.0, |own| self.gap_of(own));
        let periodic = self.kernel().periodic_axes();
        let (pressure, extent) = (self.pressure(), self.extent_of_contact());
        PressedCells { grid, first: None, periodic, pressure, gap: &gap, extent }.area().max(least)
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
}
