//! The memory of bodies that move under the grid.

use crate::hereditary::Exponential;
use crate::rheology::CreepSpectrum;

/// The past kept where it was caused: the field U with u = K U, and its branches, which follow the recursion of u itself, K and
/// the memory of the bodies being linear. U vanishes wherever there never was contact: what enters the grid from beyond its
/// edge is known, and so the grid can follow an indenter over endless bodies, or around periodic ones. The displacement
/// costs one convolution a step, however many relaxation times there are.
///
/// The surface in contact is laid on the rigid body after each step; what that changes no pressure has caused. It follows the same
/// recursion, as a displacement: u = K U + e.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Sources {
    cells: [usize; 2],
    periodic: [bool; 2],
    /// U and e.
    caused: Carried,
    laid: Carried,
    /// How far the bodies move in the step being tried.
    by: [isize; 2],
    scratch: Vec<f64>,
}

/// A field that follows the recursion of the displacement.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Carried {
    history: Exponential,
    now: Vec<f64>,
    /// At the end of the step being tried; between steps before the last one.
    trial: Vec<f64>,
}

impl Sources {
    /// The undisturbed past of a body with contact compliance `creep`, on no cells yet.
    pub(crate) fn new(creep: &CreepSpectrum, periodic: [bool; 2]) -> Sources {
        let caused = Carried { history: Exponential::new(creep, 0), now: Vec::new(), trial: Vec::new() };
        Sources { cells: [0; 2], periodic, laid: caused.clone(), caused, by: [0; 2], scratch: Vec::new() }
    }

    /// An undisturbed past on so many cells.
    pub(crate) fn undisturbed_on(&mut self, cells: [usize; 2]) {
        let count = cells[0] * cells[1];
        (self.cells, self.scratch) = (cells, vec![0.0; count]);
        for field in [&mut self.caused, &mut self.laid] {
            field.history.undisturbed_on(count);
            (field.now, field.trial) = (vec![0.0; count], vec![0.0; count]);
        }
    }

    /// Takes over another's values, in its own memory.
    pub(crate) fn copy_from(&mut self, other: &Sources) {
        for (own, field) in [(&mut self.caused, &other.caused), (&mut self.laid, &other.laid)] {
            own.history.copy_from(&field.history);
            own.now.clone_from(&field.now);
            own.trial.clone_from(&field.trial);
        }
        (self.cells, self.periodic, self.by) = (other.cells, other.periodic, other.by);
        self.scratch.resize(other.scratch.len(), 0.0);
    }

    /// Whether its fields are of such cells.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, cells: [usize; 2]) -> bool {
        let count = cells[0] * cells[1];
        let fields = [&self.caused, &self.laid];
        self.cells == cells
            && self.scratch.len() == count
            && fields
                .iter()
                .all(|field| field.history.fits(count) && [field.now.len(), field.trial.len()] == [count; 2])
    }

    /// Number of relaxation times.
    pub(crate) fn branches(&self) -> usize {
        self.caused.history.branches()
    }

    /// Whether there is a past at all.
    pub(crate) fn remembers(&self) -> bool {
        self.caused.history.remembers()
    }

    /// Finds U_old and e_old at the end of a step in which the cell `[i, j]` comes over what was the cell `[i, j] + by`;
    /// returns c.
    pub(crate) fn predict(&mut self, dt: f64, by: [isize; 2]) -> f64 {
        self.by = by;
        self.laid.predict(dt, self.cells, by, self.periodic);
        self.caused.predict(dt, self.cells, by, self.periodic)
    }

    /// What was predicted, U_old and e_old: u_old = K U_old + e_old.
    pub(crate) fn old(&self) -> [&[f64]; 2] {
        [&self.caused.trial, &self.laid.trial]
    }

    /// U = U_old + c p.
    pub(crate) fn advance(&mut self, c: f64, pressure: &[f64]) {
        self.caused.trial.iter_mut().zip(pressure).for_each(|(strength, &p)| *strength += c * p);
    }

    /// Says from where the surface is about to be laid: e = e_old − (u_old + c v) so far.
    pub(crate) fn lay_from(&mut self, u_old: &[f64], c: f64, potential: &[f64]) {
        let fields = self.laid.trial.iter_mut().zip(u_old.iter().zip(potential));
        fields.for_each(|(e, (&u_old, &v))| *e -= u_old + c * v);
    }

    /// Says to where it was laid.
    pub(crate) fn lay_to(&mut self, u: &[f64]) {
        self.laid.trial.iter_mut().zip(u).for_each(|(e, &u)| *e += u);
    }

    /// Takes the step that was predicted last into the past.
    pub(crate) fn commit(&mut self) {
        for field in [&mut self.caused, &mut self.laid] {
            std::mem::swap(&mut field.now, &mut field.trial);
            if self.by != [0; 2] {
                shift(&mut field.trial, self.cells, self.by, self.periodic);
                for branch in 0..field.history.branches() {
                    field.history.read_branch(branch, &mut self.scratch);
                    shift(&mut self.scratch, self.cells, self.by, self.periodic);
                    field.history.write_branch(branch, &self.scratch);
                }
            }
            field.history.commit();
        }
    }

    /// The same past on other cells, `carry` saying what a field becomes there.
    pub(crate) fn carry(&mut self, cells: [usize; 2], carry: impl Fn(&[f64]) -> Vec<f64>) {
        let to = cells[0] * cells[1];
        for field in [&mut self.caused, &mut self.laid] {
            field.history.settle(&field.trial, &field.now);
            field.history.carry(field.now.len(), to, |_, own| carry(&own));
            (field.now, field.trial) = (carry(&field.now), carry(&field.trial));
        }
        (self.cells, self.scratch) = (cells, vec![0.0; to]);
    }
}

impl Carried {
    fn predict(&mut self, dt: f64, cells: [usize; 2], by: [isize; 2], periodic: [bool; 2]) -> f64 {
        let c = self.history.predict(dt, &self.now, &mut self.trial);
        shift(&mut self.trial, cells, by, periodic);
        c
    }
}

/// Replaces the value of each cell `[i, j]` by that of `[i, j] + by`, which along periodic axes comes round, and is else zero
/// beyond the ends.
fn shift(field: &mut [f64], [n1, n2]: [usize; 2], by: [isize; 2], periodic: [bool; 2]) {
    let line = |line: &mut [f64], by: isize, unit: usize, periodic: bool| {
        let steps = if periodic { by.unsigned_abs() % (line.len() / unit) } else { by.unsigned_abs() };
        let far = steps.saturating_mul(unit).min(line.len());
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
