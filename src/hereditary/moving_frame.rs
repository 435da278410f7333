//! History of bodies that move under the grid.

use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::field::{Field, Role};
use crate::hereditary::remembered_field::RememberedField;
use crate::kernel::{LocalKernel, Workspace};

/// The past kept as the field U with u = K U, and its branches, which follow the recursion of u itself, K and the
/// bodies being linear. U vanishes wherever there never was contact: what enters the grid across its edge is known,
/// and so the grid can follow an indenter over endless bodies, or around periodic ones. The displacement costs one
/// convolution per step, however many relaxation times there are.
///
/// The surface in contact is laid on the rigid body after each step. What that changes no pressure has caused; it
/// follows the same recursion, as a displacement e: u = K U + e.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MovingFrame {
    cells: [usize; 2],
    periodic: [bool; 2],
    /// U.
    source: RememberedField,
    /// e.
    remainder: RememberedField,
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    scratch: Vec<f64>,
}

clone_by_fields! { MovingFrame { cells, periodic, source, remainder, scratch } }

impl MovingFrame {
    /// Whether the sources have reached the edge behind a motion along an axis.
    pub(super) fn has_left(&self, axis: usize, is_forward: bool) -> bool {
        let [n1, n2] = self.cells;
        let (count, unit) = if axis == 0 { (n1, n2) } else { (n2, 1) };
        let edge = if is_forward { 0 } else { count - 1 };
        let is_behind = |k: &usize| k / unit % count == edge;
        (0..self.source.now.len()).filter(is_behind).any(|k| self.source.now[k] != 0.0)
    }

    /// The undisturbed past, on no cells yet; both of its fields are like `field`.
    pub(crate) fn new(field: RememberedField, periodic: [bool; 2]) -> MovingFrame {
        MovingFrame { cells: [0; 2], periodic, remainder: field.clone(), source: field, scratch: Vec::new() }
    }

    /// A copy on other cells; `map` gives its fields, one for each field here.
    pub(super) fn map(&self, cells: [usize; 2], map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> MovingFrame {
        let [source, remainder] = [&self.source, &self.remainder].map(|field| field.map(None, map));
        let scratch = map(Field::single(&self.scratch, Role::Work));
        MovingFrame { cells, periodic: self.periodic, source, remainder, scratch }
    }

    /// Whether it is like another on these cells.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &MovingFrame, kept: usize, cells: [usize; 2]) -> bool {
        self.cells == cells
            && self.periodic == other.periodic
            && self.source.fits(&other.source, kept)
            && self.remainder.fits(&other.remainder, kept)
    }

    /// Finds U_old and e_old at the end of a step in which the cell `[i, j]` comes over what was the cell `[i,
    /// j] + stride`, and u_old = K U_old + e_old as the trial of the displacement. Returns the number of convolutions
    /// taken.
    pub(crate) fn predict(
        &mut self,
        rule: &mut ExponentialRule,
        stride: [isize; 2],
        side: f64,
        displacement: &mut RememberedField,
        (kernel, work): (&LocalKernel, &mut Workspace),
    ) -> usize {
        displacement.apply_pending_step(rule);
        let (cells, periodic) = (self.cells, self.periodic);
        let mut convolutions = 0;
        loop {
            for field in [&mut self.remainder, &mut self.source] {
                field.predict(rule);
                shift(&mut field.trial, cells, stride, periodic);
            }
            let u_old = &mut displacement.trial;
            if !rule.has_memory() {
                u_old.fill(0.0);
                return convolutions;
            }
            kernel.apply(&self.source.trial, u_old, work);
            u_old.iter_mut().zip(&self.remainder.trial).for_each(|(u_old, &e)| *u_old += e);
            convolutions += 1;
            let falls_below_zero = rule.has_less() && displacement.falls_below_zero(rule, side, kernel.rows());
            if !falls_below_zero || kernel.whole.raises() {
                return convolutions;
            }
            rule.reduce_order();
        }
    }

    /// U = U_old + c p, and e less u_old + c v. The displacement is still to be added to e.
    pub(crate) fn respond(&mut self, c: f64, pressure: &[f64], u_old: &[f64], potential: &[f64]) {
        self.source.add(c, pressure);
        let fields = self.remainder.trial.iter_mut().zip(u_old.iter().zip(potential));
        fields.for_each(|(e, (&u_old, &v))| *e -= u_old + c * v);
    }

    /// Adds the displacement to e.
    pub(crate) fn add_displacement(&mut self, u: &[f64]) {
        self.remainder.add(1.0, u);
    }

    /// Shifts all fields at the start of the step predicted last, and the displacement: the bodies have moved.
    pub(crate) fn shift_start(&mut self, stride: [isize; 2], displacement: &mut RememberedField) {
        for field in [displacement, &mut self.source, &mut self.remainder] {
            field.change_start(&mut self.scratch, |own| shift(own, self.cells, stride, self.periodic));
        }
    }

    pub(super) fn fields_mut(&mut self) -> [&mut RememberedField; 2] {
        [&mut self.source, &mut self.remainder]
    }
}

/// Replaces the value of each cell `[i, j]` by the value of `[i, j] + by`, which along periodic axes comes round, and
/// is else zero beyond the ends.
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
        let mut remembered = RememberedField::new(0, 20);
        remembered.now.clone_from(&field);
        for periodic in [[false, false], [true, false], [false, true], [true, true]] {
            for by1 in -6..=6 {
                for by2 in -6..=6 {
                    let (mut displacement, of_frame) = (remembered.clone(), remembered.clone());
                    let mut frame = MovingFrame { cells: [n1, n2], ..MovingFrame::new(of_frame, periodic) };
                    frame.shift_start([by1, by2], &mut displacement);
                    let [source, remainder] = frame.fields_mut().map(|field| field.now.clone());
                    assert!(source == displacement.now && remainder == displacement.now);
                    for (k, &value) in displacement.now.iter().enumerate() {
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
