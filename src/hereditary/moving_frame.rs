//! History of bodies that move under the grid.

use crate::hereditary::exponential_rule::ExponentialRule;
use crate::hereditary::field::{Field, Role};
use crate::hereditary::remembered_field::RememberedField;
use crate::kernel::{LocalKernel, Workspace};
use crate::rheology::CreepSpectrum;

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

    /// How much U would still change if `pressure` stayed on its cells and steps like the last one, of a `stride` of
    /// one cell along an axis, went on for ever. Of elastic bodies nothing.
    ///
    /// The bodies carry U through the cells of a line, one in each step. Where U no longer changed, the rule would
    /// give the pressure that holds it. What the pressure has above that still deforms the bodies, by the steady
    /// response of their creep.
    pub(super) fn outstanding(
        &self,
        rule: &ExponentialRule,
        creep: &CreepSpectrum,
        stride: [isize; 2],
        pressure: &[f64],
    ) -> Vec<f64> {
        let (axis, weights, n2) = (usize::from(stride[0] == 0), &rule.committed, self.cells[1]);
        let (periodic, count) = (self.periodic[axis], self.cells[axis]);
        let mut change = vec![0.0; if rule.has_memory() { pressure.len() } else { 0 }];
        // γ_k of all branches and the dashpot, which has the rest
        let gains = [0, 1, 2].map(|k| (weights.past[k] - weights.past.get(k + 1).unwrap_or(&0.0)) / weights.c);
        let rest = |k: usize| gains[k - 1] - weights.branches.iter().map(|branch| branch[k]).sum::<f64>();
        let dashpot = [0.0, rest(1), rest(2), rest(3)];
        for line in 0..change.len() / count {
            // in the order in which a point of the bodies passes the cells
            let place = |m: usize| if stride[axis] > 0 { count - 1 - m } else { m };
            let cell = |m: usize| if axis == 0 { line + n2 * place(m) } else { line * n2 + place(m) };
            // U so many cells before
            let before = |m: usize, cells: usize| match m.checked_sub(cells) {
                Some(m) => self.source.now[cell(m)],
                None if periodic => self.source.now[cell((m + 3 * count - cells) % count)],
                None => 0.0,
            };
            let mut excess: Vec<f64> =
                (0..count).map(|m| pressure[cell(m)] - rule.equilibrium() * before(m, 0)).collect();
            for &[decay, first, second, third] in weights.branches.iter().chain([&dashpot]) {
                // of the differences of U
                let of = [first + second + third, -first - 2.0 * second - 3.0 * third, second + 3.0 * third, -third];
                let gain = |m: usize| (0..4).map(|cells| of[cells] * before(m, cells)).sum::<f64>();
                let carried = carried((0..count).map(gain), decay, periodic);
                excess.iter_mut().zip(carried).for_each(|(excess, carried)| *excess -= carried);
            }
            let decays = creep.terms().iter().map(|&(compliance, time)| (compliance, -weights.dt / time));
            for (compliance, exponent) in decays.chain([(creep.glassy(), f64::NEG_INFINITY)]) {
                let gains = excess.iter().map(|excess| -compliance * exponent.exp_m1() * excess);
                let carried = carried(gains, exponent.exp(), periodic);
                (0..count).for_each(|m| change[cell(m)] += carried[m]);
            }
        }
        change
    }

    pub(super) fn fields_mut(&mut self) -> [&mut RememberedField; 2] {
        [&mut self.source, &mut self.remainder]
    }
}

/// The sum of all gains so far, each multiplied by `decay` in every step since; along a periodic line they come round
/// for ever.
fn carried(gains: impl ExactSizeIterator<Item = f64> + Clone, decay: f64, periodic: bool) -> Vec<f64> {
    let round = gains.clone().fold(0.0, |sum, gain| decay * sum + gain);
    let before = if periodic { round / (1.0 - decay.powi(gains.len() as i32)) } else { 0.0 };
    let add = |sum: &mut f64, gain: f64| {
        *sum = decay * *sum + gain;
        Some(*sum)
    };
    gains.scan(before, add).collect()
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
