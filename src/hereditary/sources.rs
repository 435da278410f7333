//! The memory of bodies that move under the grid.

use crate::error::Result;
use crate::hereditary::Exponential;
use crate::rheology::CreepSpectrum;

/// The past kept where it was caused: the field U with u = K U, and its branches, which follow the recursion of u itself, K and
/// the memory of the bodies being linear. U vanishes wherever there never was contact: what enters the grid from beyond its
/// edge is known, and so the grid can follow an indenter over endless bodies, or around periodic ones. The displacement
/// costs one convolution a step, however many relaxation times there are.
#[derive(Debug, Clone)]
pub(crate) struct Sources {
    history: Exponential,
    cells: [usize; 2],
    periodic: [bool; 2],
    /// U.
    strength: Vec<f64>,
    /// U of the step being tried; between steps that before the last one.
    trial: Vec<f64>,
    /// How far the bodies move in the step being tried.
    by: [isize; 2],
    scratch: Vec<f64>,
}

impl Sources {
    /// The undisturbed past of a body with contact compliance `creep`, on no cells yet.
    pub(crate) fn new(creep: &CreepSpectrum, periodic: [bool; 2]) -> Sources {
        let history = Exponential::new(creep, 0);
        let (strength, trial, scratch) = (Vec::new(), Vec::new(), Vec::new());
        Sources { history, cells: [0; 2], periodic, strength, trial, by: [0; 2], scratch }
    }

    /// An undisturbed past on so many cells.
    pub(crate) fn undisturbed_on(&mut self, cells: [usize; 2]) {
        let count = cells[0] * cells[1];
        self.history.undisturbed_on(count);
        self.cells = cells;
        (self.strength, self.trial, self.scratch) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    }

    /// Whether there is a past at all.
    pub(crate) fn remembers(&self) -> bool {
        self.history.remembers()
    }

    /// Finds U_old at the end of a step in which the cell `[i, j]` comes over what was the cell `[i, j] + by`; returns c.
    pub(crate) fn predict(&mut self, time: f64, dt: f64, by: [isize; 2]) -> Result<f64> {
        let c = self.history.predict(time, dt, &self.strength, &mut self.trial)?;
        shift(&mut self.trial, self.cells, by, self.periodic);
        self.by = by;
        Ok(c)
    }

    /// What was predicted: u_old = K U_old.
    pub(crate) fn old(&self) -> &[f64] {
        &self.trial
    }

    /// U = U_old + c p.
    pub(crate) fn advance(&mut self, c: f64, pressure: &[f64]) {
        self.trial.iter_mut().zip(pressure).for_each(|(strength, &p)| *strength += c * p);
    }

    /// Takes the step that was predicted last into the past.
    pub(crate) fn commit(&mut self) {
        std::mem::swap(&mut self.strength, &mut self.trial);
        if self.by != [0; 2] {
            shift(&mut self.trial, self.cells, self.by, self.periodic);
            for branch in 0..self.history.branches() {
                self.history.read_branch(branch, &mut self.scratch);
                shift(&mut self.scratch, self.cells, self.by, self.periodic);
                self.history.write_branch(branch, &self.scratch);
            }
        }
        self.history.commit();
    }

    /// The same past on other cells, `carry` saying what a field becomes there.
    pub(crate) fn carry(&mut self, cells: [usize; 2], carry: impl Fn(&[f64]) -> Vec<f64>) {
        self.history.settle(&self.trial, &self.strength);
        let (from, to) = (self.strength.len(), cells[0] * cells[1]);
        self.history.carry(from, to, |_, own| carry(&own));
        (self.strength, self.trial) = (carry(&self.strength), carry(&self.trial));
        (self.cells, self.scratch) = (cells, vec![0.0; to]);
    }
}

/// Replaces the value of each cell `[i, j]` by that of `[i, j] + by`, which along periodic axes comes round, and is else zero
/// beyond the ends.
fn shift(field: &mut [f64], [n1, n2]: [usize; 2], by: [isize; 2], periodic: [bool; 2]) {
    let line = |line: &mut [f64], by: isize, unit: usize, periodic: bool| {
        let steps = if periodic { by.unsigned_abs() % (line.len() / unit) } else { by.unsigned_abs() };
        let far = (steps * unit).min(line.len());
        let end = line.len() - far;
        match (periodic, by > 0) {
            (true, true) => line.rotate_left(far),
            (true, false) => line.rotate_right(far),
            (false, true) => {
                line.copy_within(far.., 0);
                line[end..].fill(0.0);
            }
            (false, false) => {
                line.copy_within(..end, far);
                line[..far].fill(0.0);
            }
        }
    };
    debug_assert_eq!(field.len(), n1 * n2);
    if by[0] != 0 {
        line(field, by[0], n2, periodic[0]);
    }
    if by[1] != 0 {
        field.chunks_exact_mut(n2).for_each(|row| line(row, by[1], 1, periodic[1]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_shift_by_whole_cells() {
        let (n1, n2) = (5, 4);
        let field: Vec<f64> = (1..=20).map(f64::from).collect();
        for periodic in [[false, false], [true, false], [false, true], [true, true]] {
            for by1 in -6..=6 {
                for by2 in -6..=6 {
                    let mut shifted = field.clone();
                    shift(&mut shifted, [n1, n2], [by1, by2], periodic);
                    for (k, &value) in shifted.iter().enumerate() {
                        let from = |own: usize, by: isize, n: usize, periodic: bool| {
                            let index = own as isize + by;
                            let index = if periodic { index.rem_euclid(n as isize) } else { index };
                            usize::try_from(index).ok().filter(|&index| index < n)
                        };
                        let from = (from(k / n2, by1, n1, periodic[0]), from(k % n2, by2, n2, periodic[1]));
                        let exact = if let (Some(i), Some(j)) = from { field[i * n2 + j] } else { 0.0 };
                        assert_eq!(value, exact, "{k} by {by1} {by2} {periodic:?}");
                    }
                }
            }
        }
    }
}
