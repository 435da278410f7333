//! The rigid motion of a body: the modes that a load leaves free, and the balance of force and moments of each free
//! mode.

use crate::parallel::Rows;
use crate::{Grid, linalg};

/// The motions ω + α1 ξ1 + α2 ξ2 of one body that a load leaves free, ξ = x − e measured from the point e
/// at which the load acts. Each freedom has its balance: Σ p = `total`, Σ p ξ1 = 0, Σ p ξ2 = 0 (Eq. 4 and
/// Eq. 5 of the paper).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Freedom {
    pub(crate) translation: bool,
    pub(crate) tilt: [bool; 2],
    /// e \[m\].
    pub(crate) point: [f64; 2],
    /// The force divided by the area of a cell \[Pa\]; unused without translation.
    pub(crate) total: f64,
}

impl Freedom {
    pub(crate) fn tilts(&self) -> bool {
        self.tilt != [false; 2]
    }

    /// Whether any motion is free.
    pub(crate) fn moves(&self) -> bool {
        self.translation || self.tilts()
    }
}

/// A motion ω + α1 x1 + α2 x2 of a rigid body, x measured from the origin of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RigidMotion {
    /// ω \[m\].
    pub(crate) approach: f64,
    /// α1 and α2 \[rad\].
    pub(crate) tilt: [f64; 2],
}

impl RigidMotion {
    /// The displacement at x \[m\].
    pub(crate) fn at(self, x: [f64; 2]) -> f64 {
        self.approach + self.tilt[0] * x[0] + self.tilt[1] * x[1]
    }
}

impl std::ops::Sub for RigidMotion {
    type Output = RigidMotion;

    fn sub(self, other: RigidMotion) -> RigidMotion {
        let tilt = [0, 1].map(|axis| self.tilt[axis] - other.tilt[axis]);
        RigidMotion { approach: self.approach - other.approach, tilt }
    }
}

impl std::ops::Add for RigidMotion {
    type Output = RigidMotion;

    fn add(self, other: RigidMotion) -> RigidMotion {
        let tilt = [0, 1].map(|axis| self.tilt[axis] + other.tilt[axis]);
        RigidMotion { approach: self.approach + other.approach, tilt }
    }
}

/// Coefficients of the three [`Modes`] of a body: translation and tilts in units in which every mode is of order one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ModeCoefficients(pub(crate) [f64; 3]);

impl ModeCoefficients {
    /// The sum of this motion and `a` times another one.
    pub(crate) fn plus(self, a: f64, other: ModeCoefficients) -> ModeCoefficients {
        ModeCoefficients([0, 1, 2].map(|m| self.0[m] + a * other.0[m]))
    }
}

/// The free motions of a body as functions on the grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Modes<'a> {
    grid: &'a Grid,
    pub(crate) freedom: Freedom,
    /// Unit lengths of the tilts, half the lengths of the grid.
    scale: [f64; 2],
}

/// The free modes of a body along a row: first + (0, 0, step) j on the j-th cell of a piece.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowModes {
    first: [f64; 3],
    pub(crate) step: f64,
}

/// Σ w B Bᵀ over some cells.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Gram {
    pub(crate) entries: [[f64; 3]; 3],
}

impl<'a> Modes<'a> {
    /// On the local rows of a grid.
    pub(crate) fn new(grid: &'a Grid, rows: &Rows, freedom: Freedom) -> Modes<'a> {
        let scale = [0, 1].map(|axis| 0.5 * (grid.spacing()[axis] * rows.cells()[axis] as f64));
        Modes { grid, freedom, scale }
    }

    /// The values of the free modes on cell `k`, zero for modes that are not free.
    pub(crate) fn at(&self, k: usize) -> [f64; 3] {
        let Freedom { translation, tilt, point, .. } = self.freedom;
        let n2 = self.grid.cells()[1];
        let mode = |axis: usize, index: usize| {
            if tilt[axis] { (self.grid.coordinate(axis, index) - point[axis]) / self.scale[axis] } else { 0.0 }
        };
        [if translation { 1.0 } else { 0.0 }, mode(0, k / n2), mode(1, k % n2)]
    }

    /// The free modes along the row of cell `k`, from there on. A body that does not tilt has the mode 1, even if it
    /// is held.
    pub(crate) fn line(&self, k: usize) -> RowModes {
        if !self.freedom.tilts() {
            return RowModes::UPRIGHT;
        }
        let step = if self.freedom.tilt[1] { self.grid.spacing()[1] / self.scale[1] } else { 0.0 };
        RowModes { first: self.at(k), step }
    }

    /// Which of ω, α1 and α2 are free.
    pub(crate) fn free(&self) -> [bool; 3] {
        [self.freedom.translation, self.freedom.tilt[0], self.freedom.tilt[1]]
    }

    /// Force and moments of a unit load.
    pub(crate) fn load(&self) -> [f64; 3] {
        [if self.freedom.translation { 1.0 } else { 0.0 }, 0.0, 0.0]
    }

    /// The displacement of cell `k` in a motion.
    pub(crate) fn displacement(&self, motion: ModeCoefficients, k: usize) -> f64 {
        if self.freedom.tilts() { dot(self.at(k), motion.0) } else { motion.0[0] }
    }

    /// The motion with these coefficients, ω at the origin of the grid.
    pub(crate) fn physical(&self, ModeCoefficients(a): ModeCoefficients) -> RigidMotion {
        let tilt = [a[1] / self.scale[0], a[2] / self.scale[1]];
        let approach = a[0] - tilt[0] * self.freedom.point[0] - tilt[1] * self.freedom.point[1];
        RigidMotion { approach, tilt }
    }

    /// The coefficients of a motion, as far as it is free: the inverse of [`Modes::physical`].
    pub(crate) fn coefficients(&self, motion: RigidMotion) -> ModeCoefficients {
        let Freedom { translation, tilt, point, .. } = self.freedom;
        let alpha = [0, 1].map(|axis| if tilt[axis] { motion.tilt[axis] } else { 0.0 });
        let held = motion.approach + alpha[0] * point[0] + alpha[1] * point[1];
        ModeCoefficients([if translation { held } else { 0.0 }, alpha[0] * self.scale[0], alpha[1] * self.scale[1]])
    }
}

impl RowModes {
    /// The line of a body that does not tilt.
    pub(crate) const UPRIGHT: RowModes = RowModes { first: [1.0, 0.0, 0.0], step: 0.0 };

    /// The same modes, with j counted from elsewhere.
    pub(super) fn from(self, j: f64) -> RowModes {
        let [mode0, mode1, mode2] = self.first;
        RowModes { first: [mode0, mode1, mode2 + self.step * j], step: self.step }
    }

    /// A motion on the first cell, and its increase from cell to cell.
    #[inline]
    pub(crate) fn of(&self, motion: ModeCoefficients) -> [f64; 2] {
        [dot(self.first, motion.0), self.step * motion.0[2]]
    }

    /// Σ B f, from Σ f and Σ j f.
    pub(crate) fn sums(&self, sum: f64, moment: f64) -> [f64; 3] {
        let [mode0, mode1, mode2] = self.first;
        [mode0 * sum, mode1 * sum, mode2 * sum + self.step * moment]
    }
}

impl Gram {
    /// Adds Σ w B Bᵀ of a line, from Σ w, Σ w j and Σ w j².
    pub(super) fn add(&mut self, line: &RowModes, weight: f64, moment: f64, square: f64) {
        let modes = line.first;
        for (m, row) in self.entries.iter_mut().enumerate() {
            let part = line.sums(weight, moment).map(|sum| modes[m] * sum);
            row.iter_mut().zip(part).for_each(|(entry, part)| *entry += part);
        }
        // the third mode is modes[2] + step j
        let others = line.step * moment;
        self.entries[2][0] += modes[0] * others;
        self.entries[2][1] += modes[1] * others;
        self.entries[2][2] += modes[2] * others + line.step * line.step * square;
    }

    /// Adds B Bᵀ of the first cells of a line.
    pub(crate) fn add_cells(&mut self, line: &RowModes, cells: usize) {
        let count = cells as f64;
        // about their middle Σ j vanishes
        self.add(&line.from(0.5 * (count - 1.0)), count, 0.0, count * (count * count - 1.0) / 12.0);
    }

    /// Solves Gram x = `right`; x is zero for a mode that depends on the others.
    pub(crate) fn solve(&self, right: [f64; 3]) -> [f64; 3] {
        linalg::solve_normal_equations(&self.entries, right, linalg::DEPENDENT)
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_and_motions_convert_into_each_other() {
        let grid = Grid::new([7, 4], [2.0, 3.0]).unwrap();
        let rows = Rows::all(grid.cells());
        let motion = RigidMotion { approach: 0.3, tilt: [-0.2, 0.7] };
        for point in [[0.0; 2], [0.4, -1.1]] {
            let modes = Modes::new(&grid, &rows, Freedom { translation: true, tilt: [true; 2], point, total: 1.0 });
            let coefficients = modes.coefficients(motion);
            let back = modes.physical(coefficients);
            assert!((back.approach - motion.approach).abs() < 1e-15);
            for k in 0..grid.len() {
                let displacement = modes.displacement(coefficients, k);
                assert!((displacement - motion.at(grid.center(k / 4, k % 4))).abs() < 1e-14, "{k}: {displacement}");
            }
        }
        let upright =
            Modes::new(&grid, &rows, Freedom { translation: true, tilt: [false; 2], point: [1.0; 2], total: 1.0 });
        let motion = RigidMotion { tilt: [0.0; 2], ..motion };
        assert_eq!(upright.physical(upright.coefficients(motion)), motion);
    }
}
